"""What a recogniser that answers at once could reach on the hard set at best.

    python tests/benchmarks/bound.py [half-space|solid]

It is given the truth of each slice, without any noise. It still differs from the labels: the label
of a slice is that of the frame before it [NT, "Creation of the Gesture Detection Dataset"], up to
40 ms old; and while fingers only press, nothing tells what they are going to do. Last it is given
when a gesture is on and how each finger moves, and has to tell the type from that.
"""

import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import numpy as np

from neurotouch_hid.evaluation.accuracy.label_track import LabelTrack
from neurotouch_hid.gesture.elastic.fingers import FingerConfig
from neurotouch_hid.gesture.elastic.kernels.motion import measure_motion, subtract_landing
from neurotouch_hid.gesture.elastic.kind_rules import KindRules
from neurotouch_hid.messages import GestureKind
from neurotouch_hid.source.simulator.dataset import plan_dataset, simulate_recipe

USERS, MINUTES, SEED = 5, 2.5, 77
SLICE_US, FRAME_US, FIRST_FRAME_US = 10_000, 40_000, 5_000
DRAGGED_MM = 0.3  # by less a finger only presses, and trembles


class Caller:
    """Tells types from the true motions of all fingers, as the recogniser does from fitted ones."""

    def __init__(self, stroke):
        self._stroke = stroke
        self._centres = np.array([finger.contact_mm for finger in stroke.fingers])
        self._radii = np.array([finger.radius_mm for finger in stroke.fingers])
        self._landed = np.zeros((len(stroke.fingers), 3))
        self._landed_us = np.zeros(len(stroke.fingers), np.int64)
        self._evidence = np.zeros(len(GestureKind))
        self._keep = math.exp(-SLICE_US / KindRules().memory_us)

    def call(self, t_us):
        motions = self._stroke.move(t_us)[:, :3]
        motions[:, 2] = np.sin(motions[:, 2])
        if np.hypot(*motions[:, :2].T).max() < FingerConfig().least_mm:
            self._landed_us[:] = 0  # nobody has been found yet
        since, parts = np.empty(motions.shape), np.empty(len(GestureKind))
        subtract_landing(motions, SLICE_US, self._landed, self._landed_us, since)
        measure_motion(self._centres, self._radii, since, parts)
        self._evidence = self._keep * self._evidence + (1.0 - self._keep) * parts
        return GestureKind(int(self._evidence.argmax()))


def watch(recipe):
    """(label, truth, a finger has been dragged, type called) of each slice."""
    simulator, dragged, stroke, called = simulate_recipe(recipe), False, None, GestureKind.NONE
    frames = range(FIRST_FRAME_US, recipe.duration_us, FRAME_US)
    labels = LabelTrack([simulator.truth(t_us) for t_us in frames])
    for t_us in range(SLICE_US, recipe.duration_us, SLICE_US):
        found = simulator._motion._script.find(t_us)
        if found is None or found[0] is not stroke:
            stroke, dragged = found and found[0], False
            caller = stroke and Caller(stroke)
        if stroke is not None:
            called = caller.call(t_us)
            dragged |= bool(np.hypot(*stroke.move(t_us)[:, :2].T).max() >= DRAGGED_MM)
        label = labels.at(t_us)
        if label is not None:
            yield label, simulator.truth(t_us), dragged, called


def main():
    gel = sys.argv[1] if len(sys.argv) > 1 else "half-space"
    n, knows, waits, calls = 0, np.zeros(2), np.zeros(2), 0
    gels = ("half-space", "solid")  # the length of a recording depends on both
    for recipe in plan_dataset(USERS, MINUTES, SEED, gels):
        if recipe.gel != gel:
            continue
        for label, truth, dragged, called in watch(recipe):
            same = label.kind is truth.kind, len(label.contacts_px) == len(truth.contacts_px)
            rest = label.kind is GestureKind.NONE
            n += 1
            knows += same
            calls += label.kind is (truth.kind if truth.kind is GestureKind.NONE else called)
            waits += same if dragged or truth.kind is GestureKind.NONE else (rest, rest)
    for name, right in (("what is labelled", knows), ("it once a finger drags", waits)):
        print(f"knows {name}: type {100 * right[0] / n:.1f} %, count {100 * right[1] / n:.1f} %")
    print(f"knows when, and every finger's motion: type {100 * calls / n:.1f} %")


if __name__ == "__main__":
    main()

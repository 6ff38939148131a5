"""How well a webcam's frames are recognised: type, count, intensity, and when the gel is found.

    python tests/benchmarks/video_rows.py half-space|solid SEED MINUTES [ROW]...
    python tests/benchmarks/video_rows.py base SEED 1 [ROW]...

Four people make all gestures, as ``simulate --users 4 --elasticity both`` draws them, before a
simulated webcam of 640x480 pixels. ``base`` is the scene of ``make room``: six gestures of 2.6 to
9 mm on the gel of finite elements, with rests of 1.1 s. Each slice of 10 ms is compared as
``evaluate`` does: with the label of the picture before it. ``at best`` is what a recogniser would
reach that knew the truth of each slice from the moment on when a finger has gone 0.3 mm along the
gel: a touch that only presses is labelled, but nothing tells its type yet. ``from 1 mm`` leaves out
smaller gestures.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from neurotouch_hid.evaluation.accuracy.label_track import LabelTrack
from neurotouch_hid.geometry import PAPER_GEL
from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.messages import no_gesture
from neurotouch_hid.profile import load_profile
from neurotouch_hid.runtime import Pipeline
from neurotouch_hid.source.simulator import uvc
from neurotouch_hid.source.simulator.dataset import plan_dataset, simulate_recipe
from neurotouch_hid.source.video.source import PictureSlicer
from neurotouch_hid.tracker import GelFinder
from tests.layouts import HEX, RINGS
from tests.room.matrix import Condition, simulate

SLICE_US, DRAGGED_MM, FIRM_MM = 10_000, 0.3, 1.0
ROWS = {
    "125": (PAPER_GEL, {"uvc": 125.0}),
    "60-mjpeg": (PAPER_GEL, {"uvc": 60.0, "gamma": 2.2, "mjpeg": 70.0}),
    "60-rolling": (PAPER_GEL, {"uvc": 60.0, "rolling": 12.0, "doubled": 10.0}),
    "hex": (HEX, {"uvc": 125.0}),
    "rings": (RINGS, {"uvc": 125.0}),
    "missing": (PAPER_GEL, {"uvc": 125.0, "missing": 10.0}),
}


def play(simulator, gel, labels):
    """Yields the step of each slice; adds the labels of its pictures first."""
    slicer = PictureSlicer(GelFinder(gel), SLICE_US)
    pipeline = Pipeline.build(load_profile("spacecraft"), GestureConfig(), gel=gel)
    for packet in simulator:
        labels += [simulator.truth(t_us) for t_us in simulator.find_labelled_times(packet)]
        for frame in packet.frames:
            pixels = uvc.enlarge(frame.pixels)
            for piece in slicer.push(pixels, frame.exposure_begin_us, frame.exposure_end_us):
                step = pipeline.advance(piece)
                pipeline.finish(step)
                yield step
    pipeline.close()


class Touch:
    """Knows whether a finger of the present stroke has already been dragged."""

    def __init__(self, script):
        self._script, self._stroke, self._dragged = script, None, False

    def has_dragged(self, t_us):
        found = self._script.find(t_us)
        if found is None or found[0] is not self._stroke:
            self._stroke, self._dragged = found and found[0], False
        if self._stroke is not None:
            drags = self._stroke.move(t_us)[:, :2]
            self._dragged |= bool(np.hypot(*drags.T).max() >= DRAGGED_MM)
        return self._dragged


def simulate_all(model, seed, minutes, row):
    """Yields the simulators of a row."""
    gel, nuisances = ROWS[row]
    if model == "base":
        told = tuple(f"{name}={strength:g}" for name, strength in nuisances.items())
        yield simulate(Condition("", row, "base", told), seed, gel)
        return
    for recipe in plan_dataset(4, minutes, seed, ("half-space", "solid"), nuisances):
        if recipe.gel == model:
            yield simulate_recipe(recipe, gel)


def compare(simulator, gel):
    """Returns (n, 6) of the slices of a recording, the errors, mm, and when the gel was found, s.

    The columns: type and count are right; both at best; firm, and its type is right.
    """
    labels, rows, errors_mm, gestures, found_s = [], [], [], [], np.inf
    with simulator:
        for step in play(simulator, gel, labels):
            gestures.append((step.gesture, simulator.truth(step.gesture.t_us)))
            if found_s == np.inf and np.isfinite(step.markers.rest_px).any():
                found_s = (step.packet.t_end_us - labels[0].t_us) / 1e6
        touch, track = Touch(simulator._motion._script), LabelTrack(labels)
    for gesture, truth in gestures:
        label, dragged = track.at(gesture.t_us), touch.has_dragged(gesture.t_us)
        if label is None:
            continue
        known = truth if dragged or not truth.kind else no_gesture(truth.t_us)
        n_seen, n_known, n = (len(of.contacts_px) for of in (gesture, known, label))
        is_right, is_firm = gesture.kind is label.kind, label.intensity_mm >= FIRM_MM
        at_best = known.kind is label.kind, n_known == n
        rows.append((is_right, n_seen == n, *at_best, is_firm, is_firm and is_right))
        if label.kind:
            errors_mm.append(abs(gesture.intensity_mm - label.intensity_mm))
    return np.array(rows, float), errors_mm, found_s


def main():
    model, seed, minutes = sys.argv[1], int(sys.argv[2]), float(sys.argv[3])
    for name in sys.argv[4:] or ROWS:
        gel = ROWS[name][0]
        played = [compare(each, gel) for each in simulate_all(model, seed, minutes, name)]
        rows = np.concatenate([rows for rows, _, _ in played])
        right, count, best, best_count, firm, firm_right = rows.mean(axis=0)
        errors_mm = np.concatenate([errors for _, errors, _ in played])
        print(
            f"{name} {model}: type {right:.1%} (at best {best:.1%}; from 1 mm"
            f" {firm_right / firm:.1%}), count {count:.1%} (at best {best_count:.1%}), intensity"
            f" {errors_mm.mean():.2f} mm, found within {max(s for _, _, s in played):.2f} s,"
            f" {len(rows)} slices",
            flush=True,
        )


if __name__ == "__main__":
    main()

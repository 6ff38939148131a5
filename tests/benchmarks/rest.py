"""False gestures of a gel at rest on a shaken table, and under a hand that rests and trembles.

    python tests/benchmarks/rest.py [SECONDS] [METHOD] [SEED]

Whole simulations, frames and events, of five people with a set-up each, half of them on either
gel. The table is bumped twenty times a minute (up to 1 mm, 0.01 rad, ringing at 4-15 Hz) and always
trembles (0.1 mm, 8-12 Hz). Resting hands tremble and wander as these people do.
"""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from neurotouch_hid.gesture import GestureConfig, GestureRecognizer
from neurotouch_hid.messages import GestureKind
from neurotouch_hid.runtime.worker import InlineRest
from neurotouch_hid.source.simulator import Finger, Script, Simulator, Stroke
from neurotouch_hid.source.simulator.gel import KNOT_US
from neurotouch_hid.source.simulator.simulated_people import meet_person
from neurotouch_hid.tracker import BlobFinder, MarkerTracker, RestDetector

PEOPLE = 5
BEGIN_US = 4_000_000  # what is before is not counted: the hand is laid down, and found to rest


class Table:
    """Moves a simulated picture of the markers as a whole: wraps ``Motion``."""

    def __init__(self, motion, rig, seconds, rng):
        self._motion, self._rig = motion, rig
        t = np.arange(int(seconds * 1e6) // KNOT_US + 4) * KNOT_US * 1e-6
        self._shift = np.zeros((len(t), 2))
        self._turn = np.zeros(len(t))
        for begin in rng.uniform(1.0, seconds, int(seconds / 3)):
            s = np.clip(t - begin, 0.0, None)
            ring = np.exp(-s / rng.uniform(0.05, 0.25)) * np.sin(2 * np.pi * rng.uniform(4, 15) * s)
            way = rng.uniform(0, 2 * np.pi)
            size = rng.uniform(0.1, 1.0)
            self._shift += size * ring[:, None] * [np.cos(way), np.sin(way)]
            self._turn += rng.uniform(-0.01, 0.01) * ring
        hz, phase = rng.uniform(8, 12, 2), rng.uniform(0, 2 * np.pi, 2)
        self._shift += 0.1 * np.sin(2 * np.pi * hz * t[:, None] + phase)

    def knot(self, index):
        knot = self._motion.knot(index)
        i = min(max(index, 0), len(self._turn) - 1)
        outline, centre = knot.outline.copy(), np.array(self._rig.centre_px)
        c, s = np.cos(self._turn[i]), np.sin(self._turn[i])
        turned = (outline[:, :2] - centre) @ np.array([[c, s], [-s, c]])
        outline[:, :2] = centre + turned + self._shift[i] * self._rig.px_per_mm
        return replace(knot, outline=outline)


def shake(person, config, seconds, rng):
    simulator = Simulator(Script("rest", (), int(seconds * 1e6)), config)
    simulator._motion = Table(simulator._motion, config.camera.rig, seconds, rng)
    return simulator, GestureConfig()


def lay_hand(person, config, seconds, rng):
    fingers = tuple(
        Finger(
            (12.0 * np.cos(a), 12.0 * np.sin(a)), press_mm=person.press_mm,
            radius_mm=person.radius_mm, tremor_mm=person.tremor_mm, drift_mm=person.drift_mm,
            seed=int(rng.integers(1 << 31)),
        )
        for a in (0.3, 2.4, 4.5)
    )  # fmt: skip
    stroke = Stroke(GestureKind.PUSH, fingers, 600_000, 200_000, int(seconds * 1e6), 200_000)
    return Simulator(Script("hand", (stroke,), int(seconds * 1e6)), config), GestureConfig(
        neutral="resting"
    )


def count(simulator, config):
    """False gestures, and slices with one, of those that count."""
    finder = BlobFinder()
    rest, tracker = InlineRest(RestDetector(finder=finder)), MarkerTracker(finder=finder)
    recognizer, before = GestureRecognizer(config), GestureKind.NONE
    n_gestures = n_slices = n_all = 0
    for packet in simulator:
        sight = rest.exchange(packet)
        if sight is not None and sight.rest is not None:
            tracker.anchor(sight.rest)
        kind = recognizer.update(tracker.update(packet)).kind
        if packet.t_end_us > BEGIN_US:
            n_all += 1
            n_slices += kind is not GestureKind.NONE
            n_gestures += kind is not GestureKind.NONE and before is GestureKind.NONE
        before = kind
    return n_gestures, n_slices, n_all


def main():
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 60.0
    method = sys.argv[2] if len(sys.argv) > 2 else "neurotouch"
    seed = int(sys.argv[3]) if len(sys.argv) > 3 else 7
    for name, scene in (("table bumped, nobody there", shake), ("hand resting", lay_hand)):
        total = np.zeros(3, int)
        for user in range(PEOPLE):
            person, config = meet_person(1000 * seed + user)
            elasticity = ("half-space", "solid")[user % 2]
            config = replace(config, gel=replace(config.gel, elasticity=elasticity))
            simulator, gesture = scene(person, config, seconds, np.random.default_rng((seed, user)))
            total += count(simulator, replace(gesture, method=method))
        minutes = total[2] / 6000
        print(
            f"{name}: {total[0]} false gestures in {minutes:.1f} min, "
            f"{10 * total[0] / minutes:.1f} in 10 min, {100 * total[1] / total[2]:.2f} % of slices",
            flush=True,
        )


if __name__ == "__main__":
    main()

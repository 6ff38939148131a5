"""Gestures of a hand that stays on the gel: found, called rightly, invented; anchors meanwhile.

    python tests/benchmarks/resting.py [SECONDS]

Whole simulations, frames and events, of five people with a set-up each, half of them on either gel.
Two fingers rest, press, tremble and wander all the time; a third pushes, or two more pinch, spread
and turn (``neutral: resting``). A gesture counts as
found if it is shown while its fingers have dragged by 1 mm or more; slices count from 2.5 mm.
"""

import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from neurotouch_hid.gesture import GestureConfig, GestureRecognizer
from neurotouch_hid.messages import GestureKind
from neurotouch_hid.runtime.worker import InlineRest
from neurotouch_hid.source.simulator import Finger, Script, Simulator, Stroke
from neurotouch_hid.source.simulator.simulated_people import draw_stroke, meet_person
from neurotouch_hid.tracker import BlobFinder, MarkerTracker, RestDetector

PEOPLE = 5
LAID_US, BEGIN_US = 600_000, 2_500_000
PLACES_MM = ((-16.0, 13.0), (16.0, 13.0))
PAUSE_US = 500_000
FOUND_MM, FIRM_MM = 1.0, 2.5


@dataclass(frozen=True, eq=False)
class Both:
    """A resting hand and what other fingers do beside it."""

    hand: Stroke
    stroke: Stroke | None

    @property
    def kind(self):
        return self.hand.kind if self.stroke is None else self.stroke.kind

    @property
    def fingers(self):
        return self.hand.fingers + (() if self.stroke is None else self.stroke.fingers)

    def move(self, t_us):
        rest = self.hand.move(t_us)
        return rest if self.stroke is None else np.vstack([rest, self.stroke.move(t_us)])


class Laid:
    """A play: the hand is laid down once; strokes come and go beside it."""

    endless = False

    def __init__(self, hand, strokes, duration_us):
        self.name, self.duration_us = "resting", duration_us
        self.script = Script("strokes", strokes, duration_us)
        self._grasps = {stroke: Both(hand, stroke) for stroke in (None, *strokes)}

    def find(self, t_us):
        if t_us < LAID_US:
            return None
        found = self.script.find(t_us)
        return self._grasps[found and found[0]], t_us


def lay(person, rng, seconds):
    duration_us = int(seconds * 1e6)
    own = {"press_mm": person.press_mm, "radius_mm": person.radius_mm,
           "tremor_mm": person.tremor_mm, "drift_mm": person.drift_mm}  # fmt: skip
    fingers = tuple(Finger(at, seed=int(rng.integers(1 << 31)), **own) for at in PLACES_MM)
    hand = Stroke(GestureKind.PUSH, fingers, LAID_US, 200_000, duration_us, 200_000)
    strokes, t_us = [], BEGIN_US + PAUSE_US
    away = replace(person, bias_mm=(0.0, -9.0))
    while True:
        stroke = draw_stroke(GestureKind(int(rng.integers(1, 6))), rng, away)
        middle = np.mean([finger.contact_mm for finger in stroke.fingers], axis=0)
        at = [np.array(f.contact_mm) for f in stroke.fingers]
        apart = min(np.hypot(*(a - p)) for a in at for p in np.array(PLACES_MM))
        if apart < 2.2 * person.radius_mm or middle[1] > 0.0:
            continue  # there is a finger already
        stroke = replace(stroke, start_us=t_us)
        if stroke.end_us + PAUSE_US > duration_us:
            return Laid(hand, tuple(strokes), duration_us)
        strokes.append(stroke)
        t_us = stroke.end_us + PAUSE_US


def watch(play, config):
    """Gestures done and found, firm slices and the right ones, invented gestures, quiet slices,
    anchors taken under the hand."""
    finder = BlobFinder()
    rest, tracker = InlineRest(RestDetector(finder=finder)), MarkerTracker(finder=finder)
    recognizer = GestureRecognizer(GestureConfig(neutral="resting"))
    found, before = set(), GestureKind.NONE
    n_firm = n_right = n_invented = n_quiet = n_anchors = 0
    for packet in Simulator(play, config):
        t_us = packet.t_end_us
        sight = rest.exchange(packet)
        if sight is not None and sight.rest is not None:
            tracker.anchor(sight.rest)
            n_anchors += t_us > LAID_US + 200_000
        kind = recognizer.update(tracker.update(packet)).kind
        if t_us < BEGIN_US:
            continue
        doing = play.script.find(t_us)
        begins = kind is not GestureKind.NONE and before is GestureKind.NONE
        before = kind
        if doing is None:
            n_quiet += 1
            n_invented += begins
            continue
        stroke = doing[0]
        mm = np.hypot(*stroke.move(t_us)[:, :2].T).max()
        if mm >= FOUND_MM and kind is not GestureKind.NONE:
            found.add(stroke)
        if mm >= FIRM_MM:
            n_firm += 1
            n_right += kind is stroke.kind
    return len(play.script.strokes), len(found), n_firm, n_right, n_invented, n_quiet, n_anchors


def main():
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 30.0
    total = np.zeros(7, int)
    for user in range(PEOPLE):
        person, config = meet_person(5000 + user)
        elasticity = ("half-space", "solid")[user % 2]
        config = replace(config, gel=replace(config.gel, elasticity=elasticity))
        play = lay(person, np.random.default_rng((5, user)), seconds)
        total += watch(play, config)
        done, found, n_firm, n_right, invented, n_quiet, n_anchors = total.tolist()
        print(
            f"{user + 1} people: {found} of {done} gestures found, type right in "
            f"{100 * n_right / max(n_firm, 1):.1f} % of slices from {FIRM_MM} mm; "
            f"{invented} invented in {n_quiet / 6000:.2f} min between them; "
            f"{n_anchors} anchors under the hand",
            flush=True,
        )


if __name__ == "__main__":
    main()

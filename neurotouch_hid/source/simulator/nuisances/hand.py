"""Hands that differ from the usual one: small or gloved fingertips, a palm, taps, slow pushes."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.messages import GestureKind
from neurotouch_hid.source.simulator.script import Finger, Grasp, Script, Stroke, rise
from neurotouch_hid.source.simulator.setup import Setup

TAP_MM = 5.0  # of a tap, so that it reaches 310 mm/s in 60 ms
PALM_MM = (3.0, 22.0)  # where a palm rests
PALM_RADIUS_MM = 7.5
PALM_LANDS_US = 1_500_000  # when it comes; the gel has been found before
PALM_MOVES_US = 400_000  # how long it takes to come, and to go before the end
PALM_DRAG_MM = 1.0


def tips(setup: Setup, mm: float) -> Setup:
    """Sets the radius of each fingertip's contact: children's are small, a nail's smaller."""
    return _shape(setup, lambda finger: replace(finger, radius_mm=mm))


def gloves(setup: Setup, mm: float) -> Setup:
    """Makes each fingertip's contact wider by ``mm`` mm, and lets it drift twice as far."""
    return _shape(
        setup,
        lambda finger: replace(
            finger, radius_mm=finger.radius_mm + mm, drift_mm=2.0 * finger.drift_mm
        ),
    )


def taps(setup: Setup, ms: float) -> Setup:
    """Turns each gesture into one of at most 5 mm that comes and goes in so many ms."""
    half_us = round(500 * ms)

    def tap(stroke: Stroke) -> Stroke:
        share = min(TAP_MM / max(_size_mm(stroke), 1e-9), 1.0)
        fingers = tuple(_scale(finger, share) for finger in stroke.fingers)
        return replace(
            stroke, fingers=fingers, attack_us=half_us, hold_us=0, release_us=half_us, creep=0.0
        )

    return _replay(setup, tap)


def slow(setup: Setup, mm_per_s: float) -> Setup:
    """Lets each gesture come and go so slowly."""

    def drag(stroke: Stroke) -> Stroke:
        length_us = round(1e6 * _size_mm(stroke) / mm_per_s)
        return replace(stroke, attack_us=length_us, release_us=length_us)

    return _replay(setup, drag)


def palm(setup: Setup, mm: float) -> Setup:
    """Rests a palm on the gel, pressed in by ``mm`` mm, from 1.5 s on; it is not in the labels."""
    return replace(setup, script=PalmedScript(setup.written, mm))


class PalmedGrasp:
    """The fingers of one gesture, or none, beside a palm.

    Args:
        stroke: the gesture.
        palm: the palm.
        script: when the palm comes and goes.
    """

    def __init__(self, stroke: Stroke | None, palm: Finger, script: Script) -> None:
        self._stroke, self._palm = stroke, palm
        self._lifts_us = script.duration_us - 2 * PALM_MOVES_US
        self.kind = GestureKind.NONE if stroke is None else stroke.kind
        self.fingers = (palm,) if stroke is None else (*stroke.fingers, palm)

    def move(self, t_us: int) -> NDArray[np.float64]:
        """Returns the fingers' places, then the palm's, (k, 4) float64, see ``Grasp``."""
        touch = rise(t_us - PALM_LANDS_US, PALM_MOVES_US)
        touch -= rise(t_us - self._lifts_us, PALM_MOVES_US)
        drag = touch * np.array(self._palm.drag_mm)
        palm = np.array([[*drag, 0.0, touch * self._palm.press_mm]])
        return palm if self._stroke is None else np.vstack([self._stroke.move(t_us), palm])


class PalmedScript:
    """A script over which a palm rests on the gel.

    Args:
        script: the gestures.
        press_mm: how deep the palm presses.
    """

    def __init__(self, script: Script, press_mm: float) -> None:
        palm = Finger(PALM_MM, (0.0, PALM_DRAG_MM), 0.0, press_mm=press_mm, labelled=False)
        palm = replace(palm, radius_mm=PALM_RADIUS_MM)
        self.name, self.strokes = script.name, script.strokes
        self.duration_us, self.endless = script.duration_us, script.endless
        self._script = script
        self._alone = PalmedGrasp(None, palm, script)
        self._grasps = {
            stroke.start_us: PalmedGrasp(stroke, palm, script) for stroke in script.strokes
        }

    def find(self, t_us: int) -> tuple[Grasp, int] | None:
        """Returns the fingers on the gel, with the palm, and the time within the script."""
        found = self._script.find(t_us)
        within_us = t_us % self.duration_us if self.endless else t_us
        if not PALM_LANDS_US < within_us < self.duration_us - PALM_MOVES_US:
            return found
        grasp = self._alone if found is None else self._grasps[found[0].start_us]
        return grasp, within_us


def _shape(setup: Setup, change: Callable[[Finger], Finger]) -> Setup:
    script = setup.written
    strokes = tuple(
        replace(stroke, fingers=tuple(change(finger) for finger in stroke.fingers))
        for stroke in script.strokes
    )
    return replace(setup, script=replace(script, strokes=strokes))


def _replay(setup: Setup, change: Callable[[Stroke], Stroke]) -> Setup:
    """Changes each gesture, and keeps the time between them."""
    script = setup.written
    strokes, before_us, end_us = list[Stroke](), 0, 0
    for stroke in script.strokes:
        changed = replace(change(stroke), start_us=end_us + stroke.start_us - before_us)
        strokes.append(changed)
        before_us, end_us = stroke.end_us, changed.end_us
    duration_us = end_us + script.duration_us - before_us
    return replace(setup, script=replace(script, strokes=tuple(strokes), duration_us=duration_us))


def _size_mm(stroke: Stroke) -> float:
    """Returns how far the finger goes that goes furthest."""
    sizes = []
    for finger in stroke.fingers:
        arm_mm = math.dist(finger.contact_mm, finger.pivot_mm)
        sizes.append(math.hypot(*finger.drag_mm) + abs(finger.turn_rad) * arm_mm)
    return max(sizes)


def _scale(finger: Finger, share: float) -> Finger:
    drag = (share * finger.drag_mm[0], share * finger.drag_mm[1])
    return replace(finger, drag_mm=drag, turn_rad=share * finger.turn_rad, delay_us=0)

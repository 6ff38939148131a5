"""Gestures as strokes: push, pinch, zoom, twist and press."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.messages import GestureKind
from neurotouch_hid.source.simulator.script import Finger, Stroke

SPREAD_MM = 13.0  # of two or three fingers around their middle


@dataclass(frozen=True, slots=True)
class StrokeTiming:
    """Lengths of the phases of a stroke."""

    attack_us: int = 300_000
    hold_us: int = 600_000
    release_us: int = 300_000


@dataclass(frozen=True, slots=True)
class Fingertips:
    """Places of the fingers before they move.

    Attributes:
        middle_mm: (x, y) between them.
        n_fingers: 2 or 3.
        spread_mm: distance of each finger from the middle.
        turn_rad: direction of the first finger from the middle.
    """

    middle_mm: tuple[float, float] = (0.0, 0.0)
    n_fingers: int = 2
    spread_mm: float = SPREAD_MM
    turn_rad: float = 0.3

    def contacts_mm(self) -> NDArray[np.float64]:
        """Returns the contacts, (n_fingers, 2) float64 mm."""
        angles = self.turn_rad + 2.0 * math.pi * np.arange(self.n_fingers) / self.n_fingers
        return self.middle_mm + self.spread_mm * np.column_stack([np.cos(angles), np.sin(angles)])


def push(
    direction_rad: float,
    size_mm: float,
    at_mm: tuple[float, float] = (0.0, 0.0),
    timing: StrokeTiming = StrokeTiming(),
) -> Stroke:
    """Returns a finger that drags the gel by ``size_mm``; 0 rad is right, π/2 is down."""
    drag = (size_mm * math.cos(direction_rad), size_mm * math.sin(direction_rad))
    return _stroke(GestureKind.PUSH, (Finger(at_mm, drag),), timing)


def press(
    depth_mm: float, at_mm: tuple[float, float] = (6.0, 4.0), timing: StrokeTiming = StrokeTiming()
) -> Stroke:
    """Returns a finger that presses straight down, which hardly moves markers sideways."""
    return _stroke(GestureKind.PUSH, (Finger(at_mm, press_mm=depth_mm),), timing)


def pinch(
    size_mm: float, hand: Fingertips = Fingertips(), timing: StrokeTiming = StrokeTiming()
) -> Stroke:
    """Returns fingers that drag the gel towards their middle by ``size_mm`` each."""
    return _stroke(GestureKind.PINCH, _radial(hand, -size_mm), timing)


def zoom(
    size_mm: float,
    hand: Fingertips = Fingertips(spread_mm=8.0),
    timing: StrokeTiming = StrokeTiming(),
) -> Stroke:
    """Returns fingers that drag the gel away from their middle by ``size_mm`` each."""
    return _stroke(GestureKind.ZOOM, _radial(hand, size_mm), timing)


def twist(
    angle_rad: float, hand: Fingertips = Fingertips(), timing: StrokeTiming = StrokeTiming()
) -> Stroke:
    """Returns fingers that turn the gel about their middle; clockwise for the user is positive."""
    kind = GestureKind.TWIST_CW if angle_rad > 0 else GestureKind.TWIST_CCW
    fingers = tuple(
        Finger((float(x), float(y)), turn_rad=angle_rad, pivot_mm=hand.middle_mm)
        for x, y in hand.contacts_mm()
    )
    return _stroke(kind, fingers, timing)


def _stroke(kind: GestureKind, fingers: tuple[Finger, ...], timing: StrokeTiming) -> Stroke:
    return Stroke(kind, fingers, 0, timing.attack_us, timing.hold_us, timing.release_us)


def _radial(hand: Fingertips, size_mm: float) -> tuple[Finger, ...]:
    outward = (hand.contacts_mm() - hand.middle_mm) / hand.spread_mm
    return tuple(
        Finger((float(x), float(y)), (float(size_mm * ox), float(size_mm * oy)))
        for (x, y), (ox, oy) in zip(hand.contacts_mm(), outward, strict=True)
    )

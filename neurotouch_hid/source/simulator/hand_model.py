"""A hand on the simulated gel that is led from outside, as a mouse leads a pointer."""

import json
import math
from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.messages import GestureKind
from neurotouch_hid.source.simulator.gel.motion import KNOT_US
from neurotouch_hid.source.simulator.script import Finger

PUSH_MM: Final = 18.0  # the largest displacement in the paper's recordings
REACH_MM: Final = 22.0  # from the middle of the gel to where fingers are laid
SPREAD_MM: Final = 10.0  # how far fingers close or open at most
TWIST_RAD: Final = 1.0
CLOSED_MM, OPEN_MM = (
    8.0,
    13.0,
)  # from the middle of a hand to its fingers, before they open or close
PRESS_MM: Final = 1.5
TOUCH_S: Final = 0.04
SPEED_MM_S: Final = 210.0  # the quickest motion in the paper's recordings
SPEED_RAD_S: Final = 10.0
NEW_PLACE_MM: Final = 2.0  # a hand laid down further away is another one
RESTING_MM: Final = ((-15.0, 11.0), (15.0, 11.0))  # where the other fingers of a resting hand lie
RESTING_DRAG_MM: Final = 1.2
SILENCE_KNOTS: Final = 250  # a second; then whoever led the hand has gone and it lets go

_STEP_S: Final = KNOT_US * 1e-6
_STILL: Final = 1e-3


@dataclass(frozen=True, slots=True)
class HandCommand:
    """What the hand shall do.

    Attributes:
        at_ms: when it was wished, in ms of the wishing program's clock.
        down: it touches the gel.
        x_mm, y_mm: the middle of the hand.
        push_x_mm, push_y_mm: how far it drags the gel.
        spread_mm: how far two fingers open; closing is negative.
        twist_rad: how far they turn, clockwise is positive.
        tremor_mm, tremor_hz: how it trembles.
        weak_zoom: share of an opening that gets lost, 0 to 1.
        resting: other fingers lie on the gel all the time.
    """

    at_ms: float = 0.0
    down: bool = False
    x_mm: float = 0.0
    y_mm: float = 0.0
    push_x_mm: float = 0.0
    push_y_mm: float = 0.0
    spread_mm: float = 0.0
    twist_rad: float = 0.0
    tremor_mm: float = 0.0
    tremor_hz: float = 5.0
    weak_zoom: float = 0.0
    resting: bool = False

    @property
    def has_two_fingers(self) -> bool:
        """True if one finger cannot do it."""
        return self.spread_mm != 0.0 or self.twist_rad != 0.0


_MOST: Final = {
    "at_ms": (0.0, 1e14),
    "push_x_mm": (-PUSH_MM, PUSH_MM),
    "push_y_mm": (-PUSH_MM, PUSH_MM),
    "x_mm": (-REACH_MM, REACH_MM),
    "y_mm": (-REACH_MM, REACH_MM),
    "spread_mm": (-SPREAD_MM, SPREAD_MM),
    "twist_rad": (-TWIST_RAD, TWIST_RAD),
    "tremor_mm": (0.0, 4.0),
    "tremor_hz": (3.0, 12.0),
    "weak_zoom": (0.0, 0.9),
}


def read_hand_command(text: bytes) -> HandCommand | None:
    """The wish in a message; what goes too far is cut, None if it is no wish at all."""
    try:
        said = json.loads(text)
    except (ValueError, RecursionError):
        return None
    if not isinstance(said, dict):
        return None
    values: dict[str, Any] = {}
    for field in fields(HandCommand):
        value = said.get(field.name, field.default)
        if field.name not in _MOST:
            values[field.name] = value is True
            continue
        if isinstance(value, bool) or not isinstance(value, int | float):
            return None
        if not math.isfinite(value):
            return None
        low, high = _MOST[field.name]
        values[field.name] = min(max(float(value), low), high)
    return HandCommand(**values)


class Hold:
    """Fingers on the gel from touch to release; a grasp of a play.

    Attributes:
        kind: what they do.
        fingers: where they were laid.
        wish: what they were laid down for.
        lie: how much the other fingers of a resting hand lie on the gel, 0 to 1.
    """

    def __init__(self, wish: HandCommand, lie: float = 0.0) -> None:
        self.wish = wish
        self.kind = _find_kind(wish)
        self._middle = np.array([wish.x_mm, wish.y_mm])
        self._own = _lay_fingers(wish) if wish.down else np.empty((0, 2))
        laid = [*map(tuple, self._own.tolist()), *(RESTING_MM if wish.resting or lie else ())]
        self.fingers = tuple(Finger((x, y), press_mm=PRESS_MM) for x, y in laid)
        self._n_resting = len(laid) - len(self._own)
        self._push = np.zeros(2)
        self._spread = self._twist = self._touch = 0.0
        self.lie = lie
        self._state = np.zeros((len(laid), 4))

    @property
    def is_lifted(self) -> bool:
        """True once the fingers that do something are off the gel."""
        still = self._touch < _STILL and abs(self._spread) < _STILL and abs(self._twist) < _STILL
        return bool(still and np.hypot(*self._push) < _STILL)

    @property
    def is_over(self) -> bool:
        """True once the gel is as it was."""
        return self.is_lifted and self.lie < _STILL

    def fits(self, wish: HandCommand) -> bool:
        """True if these fingers can do what is wished; else they must be lifted first."""
        if wish.resting != self.wish.resting:
            return False
        if not wish.down:
            return not self.wish.down
        if not self.wish.down:
            return False
        near = math.dist((wish.x_mm, wish.y_mm), self._middle) <= NEW_PLACE_MM
        enough = len(self._own) > 1 or not wish.has_two_fingers
        return near and enough

    def follow(self, wish: HandCommand, t_us: int) -> None:
        """Goes on for a knot, as far as a hand can in that time."""
        down = wish.down and self.fits(wish)
        mm, rad = SPEED_MM_S * _STEP_S, SPEED_RAD_S * _STEP_S
        push = np.array([wish.push_x_mm, wish.push_y_mm]) if down else np.zeros(2)
        way = push - self._push
        length = float(np.hypot(*way))
        self._push = push if length <= mm else self._push + way * (mm / length)
        spread = wish.spread_mm if down else 0.0
        if spread > 0.0:
            spread *= 1.0 - wish.weak_zoom
        self._spread = _approach(self._spread, spread, mm)
        self._twist = _approach(self._twist, wish.twist_rad if down else 0.0, rad)
        self._touch = _approach(self._touch, 1.0 if down else 0.0, _STEP_S / TOUCH_S)
        self.lie = _approach(self.lie, 1.0 if wish.resting else 0.0, _STEP_S / TOUCH_S)
        self._state = self._compute(wish, t_us)

    def move(self, _t_us: int) -> NDArray[np.float64]:
        """Where the fingers are at the knot they have followed to."""
        return self._state

    def _compute(self, wish: HandCommand, t_us: int) -> NDArray[np.float64]:
        turn = 2e-6 * math.pi * wish.tremor_hz * t_us
        tremor = wish.tremor_mm * np.array([math.sin(turn), 0.6 * math.cos(turn)])
        state = np.zeros((len(self.fingers), 4))
        n = len(self._own)
        if n:
            away = self._own - self._middle
            lengths = np.hypot(*away.T)[:, None]
            outward = away / np.maximum(lengths, _STILL) if n > 1 else 0.0 * away
            c, s = math.cos(self._twist), math.sin(self._twist)
            turned = away @ np.array([[c, s], [-s, c]])
            state[:n, :2] = turned - away + self._spread * outward + self._push
            state[:n, :2] += self._touch * tremor
            state[:n, 2] = self._twist if n > 1 else 0.0
        if self._n_resting:
            state[n:, :2] = self.lie * (np.array([0.0, RESTING_DRAG_MM]) + 0.5 * tremor)
        state[:n, 3] = PRESS_MM * self._touch
        state[n:, 3] = PRESS_MM * self.lie
        return state


class GuidedHand:
    """A play without an end that does what it is asked for.

    Args:
        ask: the newest wish, or None if there is no new one; called once a knot, must not wait.
        notice: told of each wish taken, and at which sensor time the gel has it.
    """

    name = "mouse"
    duration_us = KNOT_US
    endless = True

    def __init__(
        self, ask: Callable[[], HandCommand | None], notice: Callable[[HandCommand, int], None]
    ) -> None:
        self._ask, self._notice = ask, notice
        self._wish = HandCommand()
        self._silent = 0
        self._hold: Hold | None = None

    def find(self, t_us: int) -> tuple[Hold, int] | None:
        """The fingers on the gel at this knot, or None."""
        wish = self._ask()
        if wish is not None:
            self._wish, self._silent = wish, 0
            self._notice(wish, t_us)
        else:
            self._silent += 1
            if self._silent > SILENCE_KNOTS:
                self._wish = HandCommand()
        hold = self._hold
        if hold is None:
            if self._wish.down or self._wish.resting:
                hold = Hold(self._wish)
        elif hold.is_lifted and not hold.fits(self._wish):
            hold = Hold(self._wish, hold.lie)
        if hold is not None:
            hold.follow(self._wish, t_us)
            if hold.is_over and not self._wish.down:
                hold = None
        self._hold = hold
        return None if hold is None else (hold, t_us)


def _find_kind(wish: HandCommand) -> GestureKind:
    if not wish.down:
        return GestureKind.NONE
    if wish.spread_mm:
        return GestureKind.ZOOM if wish.spread_mm > 0.0 else GestureKind.PINCH
    if wish.twist_rad:
        return GestureKind.TWIST_CW if wish.twist_rad > 0.0 else GestureKind.TWIST_CCW
    return GestureKind.PUSH


def _lay_fingers(wish: HandCommand) -> NDArray[np.float64]:
    """Where the fingers touch, (k, 2) mm."""
    middle = np.array([[wish.x_mm, wish.y_mm]])
    if not wish.has_two_fingers:
        return middle
    away = CLOSED_MM if wish.spread_mm > 0.0 else OPEN_MM
    way = np.array([math.cos(0.3), math.sin(0.3)])
    return middle + away * np.array([way, -way])


def _approach(value: float, wanted: float, most: float) -> float:
    return value + min(max(wanted - value, -most), most)

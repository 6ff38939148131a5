"""A simulated hand on the gel that follows commands, as a pointer follows a mouse."""

import math
from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import PAPER_GEL, Gel
from neurotouch_hid.ipc import read_object
from neurotouch_hid.messages import GestureKind
from neurotouch_hid.source.simulator.gel.motion import KNOT_US
from neurotouch_hid.source.simulator.script import FINGERTIP_RADIUS_MM, Finger

PUSH_MM: Final = 18.0  # the largest displacement in the paper's recordings
REACH_MM: Final = 22.0  # from the middle of the gel to where fingers are laid
SPREAD_MM: Final = 10.0  # how far fingers close or open at most
TWIST_RAD: Final = 1.0
CLOSED_MM, OPEN_MM = (
    8.0,
    13.0,
)  # from the middle of a hand to its fingers, before they open or close
CLOSEST_MM: Final = 3.0  # fingers that close stay so far from the middle of the hand
PRESS_MM: Final = 1.5
TOUCH_S: Final = 0.04
SPEED_MM_S: Final = 210.0  # the quickest motion in the paper's recordings
SPEED_RAD_S: Final = 10.0
NEW_PLACE_MM: Final = 2.0  # a hand laid down further away is another one
RESTING_MM: Final = ((-15.0, 11.0), (15.0, 11.0))  # where the other fingers of a resting hand are
RESTING_DRAG_MM: Final = 1.2
SILENCE_KNOTS: Final = 250  # a second without a command; then the hand releases the gel

_STEP_S: Final = KNOT_US * 1e-6
_STILL: Final = 1e-3


@dataclass(frozen=True, slots=True)
class HandCommand:
    """Command for the simulated hand.

    Attributes:
        at_ms: when it was sent, in ms of the clock of the sending program.
        down: it touches the gel.
        x_mm, y_mm: the middle of the hand.
        push_x_mm, push_y_mm: how far it drags the gel.
        spread_mm: how far two fingers open; closing is negative.
        twist_rad: how far they turn, clockwise is positive.
        tremor_mm, tremor_hz: how it trembles.
        weak_zoom: share of an opening that gets lost, 0 to 1.
        resting: other fingers rest on the gel all the time.
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
    """Returns the command in a message, its values limited, or None if it is invalid."""
    said = read_object(text)
    if said is None:
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


class GuidedGrasp:
    """Moves simulated fingers as the commands ask, from touch to release.

    Args:
        command: the command that lays them down.
        reach_mm: fingers are laid no farther from the middle of the gel.
        lie: see the attribute.

    Attributes:
        kind: their gesture.
        fingers: the fingers, with their contacts at touch-down.
        command: the command that laid them down.
        lie: how much the other fingers of a resting hand rest on the gel, 0 to 1.
    """

    def __init__(self, command: HandCommand, reach_mm: float, lie: float = 0.0) -> None:
        self.command = command
        self.kind = _find_kind(command)
        self._middle, self._own = _lay_fingers(command, reach_mm)
        resting = RESTING_MM if command.resting or lie else ()
        laid = [*self._own.tolist(), *(_pull_in(np.array(at), reach_mm).tolist() for at in resting)]
        self.fingers = tuple(Finger((x, y), press_mm=PRESS_MM) for x, y in laid)
        self._n_resting = len(laid) - len(self._own)
        self._push = np.zeros(2)
        self._spread = self._twist = self._touch = 0.0
        self.lie = lie
        self._state = np.zeros((len(laid), 4))

    @property
    def is_lifted(self) -> bool:
        """Returns True once the commanded fingers are off the gel."""
        still = self._touch < _STILL and abs(self._spread) < _STILL and abs(self._twist) < _STILL
        return bool(still and np.hypot(*self._push) < _STILL)

    @property
    def is_over(self) -> bool:
        """Returns True once no finger touches the gel."""
        return self.is_lifted and self.lie < _STILL

    def fits(self, command: HandCommand) -> bool:
        """Returns True if these fingers can carry out the command without being lifted first."""
        if command.resting != self.command.resting:
            return False
        if not command.down:
            return not self.command.down
        if not self.command.down:
            return False
        before = self.command
        way_mm = math.hypot(command.x_mm - before.x_mm, command.y_mm - before.y_mm)
        near = way_mm <= NEW_PLACE_MM
        enough = len(self._own) > 1 or not command.has_two_fingers
        return near and enough

    def follow(self, command: HandCommand, t_us: int) -> None:
        """Moves the fingers for one knot, no faster than a hand."""
        down = command.down and self.fits(command)
        mm, rad = SPEED_MM_S * _STEP_S, SPEED_RAD_S * _STEP_S
        push = np.array([command.push_x_mm, command.push_y_mm]) if down else np.zeros(2)
        way = push - self._push
        length = float(np.hypot(*way))
        self._push = push if length <= mm else self._push + way * (mm / length)
        spread = command.spread_mm if down else 0.0
        if spread > 0.0:
            spread *= 1.0 - command.weak_zoom
        elif len(self._own) > 1:
            away = float(np.hypot(*(self._own[0] - self._middle)))
            spread = max(spread, min(CLOSEST_MM - away, 0.0))
        self._spread = _approach(self._spread, spread, mm)
        self._twist = _approach(self._twist, command.twist_rad if down else 0.0, rad)
        self._touch = _approach(self._touch, 1.0 if down else 0.0, _STEP_S / TOUCH_S)
        self.lie = _approach(self.lie, 1.0 if command.resting else 0.0, _STEP_S / TOUCH_S)
        self._state = self._compute(command, t_us)

    def move(self, _t_us: int) -> NDArray[np.float64]:
        """Returns fingers at the last knot, (k, 4) float64: drag x, y mm, turn rad, press mm."""
        return self._state

    def _compute(self, command: HandCommand, t_us: int) -> NDArray[np.float64]:
        turn = 2e-6 * math.pi * command.tremor_hz * t_us
        tremor = command.tremor_mm * np.array([math.sin(turn), 0.6 * math.cos(turn)])
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
    """Carries out the newest command, without an end.

    Args:
        ask: returns a new command, or None; called once a knot, must not wait.
        notice: called with each command, and the sensor time at which it reaches the gel.
        gel: what it presses; whole fingertips are laid on it.
    """

    name = "mouse"
    duration_us = KNOT_US
    endless = True

    def __init__(
        self,
        ask: Callable[[], HandCommand | None],
        notice: Callable[[HandCommand, int], None],
        gel: Gel = PAPER_GEL,
    ) -> None:
        self._ask, self._notice = ask, notice
        self._reach_mm = max(gel.rim_mm - FINGERTIP_RADIUS_MM, 0.0)
        self._command = HandCommand()
        self._silent = 0
        self._grasp: GuidedGrasp | None = None

    def find(self, t_us: int) -> tuple[GuidedGrasp, int] | None:
        """Returns the fingers on the gel at this knot, or None."""
        command = self._ask()
        if command is not None:
            self._command, self._silent = command, 0
            self._notice(command, t_us)
        else:
            self._silent += 1
            if self._silent > SILENCE_KNOTS:
                self._command = HandCommand()
        grasp = self._grasp
        if grasp is None:
            if self._command.down or self._command.resting:
                grasp = GuidedGrasp(self._command, self._reach_mm)
        elif grasp.is_lifted and not grasp.fits(self._command):
            grasp = GuidedGrasp(self._command, self._reach_mm, grasp.lie)
        if grasp is not None:
            grasp.follow(self._command, t_us)
            if grasp.is_over and not self._command.down:
                grasp = None
        self._grasp = grasp
        return None if grasp is None else (grasp, t_us)


def _find_kind(command: HandCommand) -> GestureKind:
    if not command.down:
        return GestureKind.NONE
    if command.spread_mm:
        return GestureKind.ZOOM if command.spread_mm > 0.0 else GestureKind.PINCH
    if command.twist_rad:
        return GestureKind.TWIST_CW if command.twist_rad > 0.0 else GestureKind.TWIST_CCW
    return GestureKind.PUSH


def _lay_fingers(
    command: HandCommand, reach_mm: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns the middle of the hand (2,) and where its fingers touch (k, 2), mm."""
    at = np.array([command.x_mm, command.y_mm])
    if not command.down:
        return at, np.empty((0, 2))
    if not command.has_two_fingers:
        middle = _pull_in(at, reach_mm)
        return middle, middle[None]
    away = min(CLOSED_MM if command.spread_mm > 0.0 else OPEN_MM, reach_mm)
    way = np.array([math.cos(0.3), math.sin(0.3)])
    middle = _pull_in(at, reach_mm - away)
    return middle, middle + away * np.array([way, -way])


def _pull_in(at_mm: NDArray[np.float64], reach_mm: float) -> NDArray[np.float64]:
    """Returns a place (2,) mm, moved to the middle of the gel as far as it is out of reach."""
    far_mm = float(np.hypot(*at_mm))
    return at_mm if far_mm <= reach_mm else at_mm * (reach_mm / far_mm)


def _approach(value: float, wanted: float, most: float) -> float:
    return value + min(max(wanted - value, -most), most)

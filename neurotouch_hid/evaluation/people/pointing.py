"""The multidirectional tapping test of ISO 9241-411, played with the gel on sensor time."""

import math
from itertools import pairwise
from typing import Final

from neurotouch_hid.evaluation.people.throughput import Point, Trial
from neurotouch_hid.messages import Axis, GamepadState

DISTANCE_PX: Final = 400.0
WIDTHS_PX: Final = (80.0, 40.0)
"""Large targets, then small ones: 2.6 and 3.5 bit."""

TARGETS: Final = 9
"""Targets on a circle for each width; odd, so that going back and forth reaches each once."""

SPEED_PX_S: Final = 900.0
"""Speed of the pointer at full deflection of the left stick, as in the profile ``mouse``."""

DWELL_US: Final = 500_000
STILL_SHARE: Final = 0.1
"""The pointer rests if it stays within this share of the target's width."""

_LONGEST_US: Final = 50_000
_WAYS: Final = ("right", "down right", "down", "down left", "left", "up left", "up", "up right")


def lay_targets(n: int = TARGETS, distance_px: float = DISTANCE_PX) -> list[Point]:
    """Returns the middles of ``n`` targets on a circle, in the order they are reached.

    The first comes again at the end.
    """
    order = [(k * ((n + 1) // 2)) % n for k in range(n + 1)]
    angles = [2.0 * math.pi * k / n - 0.5 * math.pi for k in order]
    radius_px = 0.5 * distance_px
    return [(radius_px * math.cos(angle), radius_px * math.sin(angle)) for angle in angles]


def name_way(begin: Point, end: Point) -> str:
    """Returns the direction from one point to another in words, one of eight."""
    angle = math.atan2(end[1] - begin[1], end[0] - begin[0])
    return _WAYS[round(angle / (0.25 * math.pi)) % 8]


class Pointing:
    """The test: one trial after the other; ``begin`` starts each when the person is ready.

    The left stick, and a mouse where the profile moves one, drives the pointer. A trial's time
    begins with the first motion after the hand was at rest, so neither waiting nor reading counts.

    Attributes:
        trials: the finished ones.
        pointer_px: place of the pointer, (x, y), right and down positive.

    Args:
        dwell: select by resting for 0.5 s; otherwise by any button.
        targets: number of targets for each width; odd.
    """

    def __init__(self, *, dwell: bool = True, targets: int = TARGETS) -> None:
        middles = lay_targets(targets)
        self._plan = [
            (width, begin, end) for width in WIDTHS_PX for begin, end in pairwise(middles)
        ]
        self._dwell = dwell
        self.trials: list[Trial] = []
        self.pointer_px: Point = self._plan[0][1]
        self._running = self._armed = False
        self._t_us: int | None = None
        self._moved_us: int | None = None
        self._rest: tuple[Point, int] = (self.pointer_px, 0)
        self._down: frozenset[str] = frozenset()

    @property
    def total(self) -> int:
        """The number of trials."""
        return len(self._plan)

    @property
    def is_over(self) -> bool:
        """True once all are finished."""
        return len(self.trials) == self.total

    @property
    def is_running(self) -> bool:
        """True from ``begin`` to the selection."""
        return self._running

    @property
    def target(self) -> tuple[float, Point]:
        """The width and middle of the target, in px; only while the test is not over."""
        width_px, _, end = self._plan[len(self.trials)]
        return width_px, end

    @property
    def start_px(self) -> Point:
        """The start of the trial; only while the test is not over."""
        return self._plan[len(self.trials)][1]

    def begin(self) -> None:
        """Puts the pointer at the start of the next trial; it moves after the hand was at rest."""
        self._running, self._armed = True, False
        self._moved_us = None
        self.pointer_px = self.start_px

    def update(self, pad: GamepadState) -> Trial | None:
        """Takes one state of the outputs; returns the trial that it ends, if any."""
        step_us = 0 if self._t_us is None else min(max(pad.t_us - self._t_us, 0), _LONGEST_US)
        self._t_us = pad.t_us
        down = frozenset(pad.buttons) | pad.mouse_buttons | pad.keys
        pressed = bool(down - self._down)
        self._down = down
        x_px_s = pad.pointer[0] + SPEED_PX_S * pad.axes.get(Axis.LEFT_X, 0.0)
        y_px_s = pad.pointer[1] + SPEED_PX_S * pad.axes.get(Axis.LEFT_Y, 0.0)
        moves = x_px_s != 0.0 or y_px_s != 0.0
        if not self._running:
            return None
        if not self._armed:
            self._armed = not moves
            return None
        if self._moved_us is None:
            if not moves:
                return None
            self._moved_us = pad.t_us - step_us
            self._rest = (self.pointer_px, pad.t_us)
        x, y = self.pointer_px
        self.pointer_px = x + x_px_s * step_us * 1e-6, y + y_px_s * step_us * 1e-6
        selected_us = self._find_rest(pad.t_us) if self._dwell else (pad.t_us if pressed else None)
        return self._finish(selected_us - self._moved_us) if selected_us is not None else None

    def _find_rest(self, t_us: int) -> int | None:
        """Returns the time at which the pointer came to rest; None if it rests too briefly."""
        width_px, begin, _ = self._plan[len(self.trials)]
        where, since_us = self._rest
        if math.dist(self.pointer_px, where) > STILL_SHARE * width_px:
            self._rest = (self.pointer_px, t_us)
            return None
        left = math.dist(self.pointer_px, begin) > width_px  # else it has hardly begun
        return since_us if left and t_us - since_us >= DWELL_US else None

    def _finish(self, took_us: int) -> Trial:
        width_px, begin, end = self._plan[len(self.trials)]
        trial = Trial(width_px, begin, end, self.pointer_px, max(took_us, 1) * 1e-6)
        self.trials.append(trial)
        self._running = False
        return trial

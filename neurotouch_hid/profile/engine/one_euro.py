"""The One Euro filter: calm while the hand is slow, quick while it is fast.

[1EUR] Casiez, Roussel, Vogel: "1 € Filter", CHI 2012. Times are integer µs.
"""

import math
from typing import Final

from neurotouch_hid.profile.schema.timing import FilterName

FILTERS: Final[dict[FilterName, tuple[float, float, float]]] = {
    "light": (3.0, 0.30, 1.0),
    "medium": (1.0, 0.05, 1.0),
    "strong": (0.5, 0.05, 0.5),
}
"""Least cutoff in Hz, its growth in Hz per mm/s, cutoff of the derivative in Hz. With 5 mm and a
tremor of 1 mm at 5 Hz they leave 72, 28 and 14 % of it and delay a press of 300 ms by 13, 40 and
55 ms (simulated at 100 Hz). A lower cutoff of the derivative keeps a tremor from opening it."""

MIN_STEP_US: Final = 1_000
MAX_STEP_US: Final = 50_000
_TURN: Final = 2.0 * math.pi
"""A low-pass of first order that turns by this angle in a step takes angle / (angle + 1) of a new
value."""


class OneEuro:
    """Smooths one quantity, in mm.

    Differs from the authors' code: ``reset`` forgets the derivative too, so that a new zero does
    not open the filter, and steps of time are held within 1 to 50 ms.
    """

    __slots__ = (
        "_beta",
        "_derivative_cutoff_hz",
        "_min_cutoff_hz",
        "_speed",
        "_speed_share",
        "_step_s",
        "_step_us",
        "_value",
    )

    def __init__(self, min_cutoff_hz: float, beta: float, derivative_cutoff_hz: float) -> None:
        self._min_cutoff_hz = min_cutoff_hz
        self._beta = beta
        self._derivative_cutoff_hz = derivative_cutoff_hz
        self._value: float | None = None
        self._speed = 0.0
        self._set_step(MIN_STEP_US)

    def reset(self, to: float | None = None) -> None:
        """Starts again, at ``to`` or at the next value."""
        self._value = to
        self._speed = 0.0

    def update(self, value: float, step_us: int) -> float:
        """Returns the smoothed value, ``step_us`` after the one before."""
        if self._value is None:
            self._value = value
            return value
        if step_us != self._step_us:
            self._set_step(step_us)
        step_s, change, speed = self._step_s, value - self._value, self._speed
        self._speed = speed = speed + self._speed_share * (change / step_s - speed)
        turn = _TURN * (self._min_cutoff_hz + self._beta * abs(speed)) * step_s
        self._value = value = self._value + turn / (turn + 1.0) * change
        return value

    def _set_step(self, step_us: int) -> None:
        self._step_us = step_us
        self._step_s = min(max(step_us, MIN_STEP_US), MAX_STEP_US) * 1e-6
        turn = _TURN * self._derivative_cutoff_hz * self._step_s
        self._speed_share = turn / (turn + 1.0)

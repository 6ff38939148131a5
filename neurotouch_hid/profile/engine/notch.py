"""Takes out the frequency at which one person's hand trembles, and follows it as it drifts."""

import math
from collections import deque
from typing import Final

import numpy as np

from neurotouch_hid.profile.engine.one_euro import MAX_STEP_US, MIN_STEP_US
from neurotouch_hid.profile.engine.spectrum import DRIFT_HZ, find_tremor

QUALITY: Final = 0.7
"""Wide enough for a tremor that drifts by 1.5 Hz: with the filter medium, 8 % of 4 Hz and 4 % of
6 Hz are left around 5 Hz. It costs about 45 ms."""

WINDOW_US: Final = 3_000_000
"""The tremor is looked for again in each 3 s of a hold."""


class Notch:
    """A notch filter of second order for one quantity; a constant passes unchanged.

    The coefficients are those of R. Bristow-Johnson's "Cookbook formulae for audio EQ biquad filter
    coefficients"; they follow the length of the steps.

    Attributes:
        hz: what it takes out.
    """

    __slots__ = ("_a1", "_a2", "_b0", "_b1", "_first", "_second", "_started", "_step_us", "hz")

    def __init__(self, hz: float) -> None:
        self.hz = hz
        self._step_us = 0
        self.reset()

    def reset(self) -> None:
        """Starts again, at whatever comes next."""
        self._started = False
        self._first = self._second = 0.0

    def tune(self, hz: float) -> None:
        """Takes out another frequency from now on."""
        self.hz = hz
        self._step_us = 0

    def update(self, value: float, step_us: int) -> float:
        """Returns the value without its part near the frequency.

        Args:
            value: finite.
            step_us: the time since the value before.
        """
        step_us = min(max(step_us, MIN_STEP_US), MAX_STEP_US)
        if step_us != self._step_us:
            self._set_step(step_us)
        b0, b1, a1, a2 = self._b0, self._b1, self._a1, self._a2
        if not self._started:
            self._started = True
            self._second = (b0 - a2) * value
            self._first = (b1 - a1) * value + self._second
        smooth = b0 * value + self._first
        self._first = b1 * value - a1 * smooth + self._second
        self._second = b0 * value - a2 * smooth
        return smooth

    def _set_step(self, step_us: int) -> None:
        self._step_us = step_us
        turn = 2.0 * math.pi * min(self.hz * step_us * 1e-6, 0.45)
        alpha = math.sin(turn) / (2.0 * QUALITY)
        self._b0 = 1.0 / (1.0 + alpha)
        self._b1 = self._a1 = -2.0 * math.cos(turn) / (1.0 + alpha)
        self._a2 = (1.0 - alpha) / (1.0 + alpha)


class TremorWatch:
    """Finds where a tremor has drifted to, from the intensity of what is held.

    Args:
        hz: the person's own frequency; what is found is within 1.5 Hz of it.
    """

    def __init__(self, hz: float) -> None:
        self._own_hz = hz
        self._held_mm: deque[float] = deque()
        self._held_us = 0

    def reset(self) -> None:
        """Ends the hold."""
        self._held_mm.clear()
        self._held_us = 0

    def update(self, mm: float, step_us: int) -> float | None:
        """Returns the frequency at the end of each window with a tremor, otherwise None.

        Args:
            mm: how far the hand is, unfiltered.
            step_us: the time since the value before.
        """
        self._held_mm.append(mm)
        self._held_us += max(step_us, 0)
        if self._held_us < WINDOW_US:
            return None
        tremor = find_tremor(np.array(self._held_mm), self._held_us // len(self._held_mm))
        self.reset()
        if tremor is None or abs(tremor.frequency_hz - self._own_hz) > DRIFT_HZ:
            return None
        return tremor.frequency_hz

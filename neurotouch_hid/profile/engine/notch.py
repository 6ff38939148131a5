"""Takes out the frequency at which one person's hand trembles, and follows it as it drifts."""

import math
from typing import Final

import numpy as np

from neurotouch_hid.profile.engine.even_readings import READING_US, ReadingClock
from neurotouch_hid.profile.engine.one_euro import MAX_STEP_US
from neurotouch_hid.profile.engine.spectrum import DRIFT_HZ, find_tremor

QUALITY: Final = 0.7
"""Wide enough for a tremor that drifts by 1.5 Hz: with the filter medium, 8 % of 4 Hz and 4 % of
6 Hz are left around 5 Hz. It costs about 45 ms."""

_WINDOW_READINGS: Final = 300
"""The tremor is looked for again in each 3 s of a hold."""


class Notch:
    """A notch filter of second order for one quantity; a constant passes unchanged.

    It is a state-variable filter, as in A. Simper's "Solving the continuous SVF equations using
    trapezoidal integration". Its states are quantities of the hand, not earlier samples, so steps
    of any lengths may follow each other. With equal steps it is the usual bilinear notch.

    Attributes:
        hz: what it takes out.
    """

    __slots__ = ("_before", "_gain", "_is_started", "_slow", "_step_us", "_swing", "hz")

    def __init__(self, hz: float) -> None:
        self.hz = hz
        self._step_us = -1  # none
        self.reset()

    def reset(self) -> None:
        """Starts again, at whatever comes next."""
        self._is_started = False

    def tune(self, hz: float) -> None:
        """Takes out another frequency from now on."""
        self.hz = hz
        self._step_us = -1  # none

    def update(self, value: float, step_us: int) -> float:
        """Returns the value without its part near the frequency.

        Args:
            value: finite.
            step_us: the time since the value before.
        """
        step_us = min(max(step_us, 0), MAX_STEP_US)
        if step_us != self._step_us:
            self._step_us = step_us
            self._gain = math.tan(math.pi * min(self.hz * step_us * 1e-6, 0.45))
        if not self._is_started:
            self._is_started = True
            self._before = self._slow = value
            self._swing = 0.0
        gain, swing = self._gain, self._swing
        rest = self._before - self._slow - swing / QUALITY
        slow = self._slow + gain * swing
        self._swing = (swing + gain * (rest + value - slow)) / (1.0 + gain * (gain + 1.0 / QUALITY))
        self._slow = slow + gain * self._swing
        self._before = value
        return value - self._swing / QUALITY


class TremorWatch:
    """Finds where a tremor has drifted to, from the intensity of what is held.

    Args:
        hz: the person's own frequency; what is found is within 1.5 Hz of it.
    """

    def __init__(self, hz: float) -> None:
        self._own_hz = hz
        self.reset()

    def reset(self) -> None:
        """Ends the hold."""
        self._held_mm: list[float] = []
        self._clock = ReadingClock()

    def update(self, mm: float, step_us: int) -> float | None:
        """Returns the frequency at the end of each window with a tremor, otherwise None.

        Args:
            mm: how far the hand is, unfiltered.
            step_us: the time since the value before.
        """
        n = self._clock.count(step_us)
        if n is None:  # readings were lost
            self.reset()
            return None
        self._held_mm += [mm] * n
        if len(self._held_mm) < _WINDOW_READINGS:
            return None
        tremor = find_tremor(np.array(self._held_mm), READING_US)
        self.reset()
        if tremor is None or abs(tremor.frequency_hz - self._own_hz) > DRIFT_HZ:
            return None
        return tremor.frequency_hz

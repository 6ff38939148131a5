"""Converts sensor time to the clock that the kernel stamps input with."""

import time
from collections.abc import Callable
from typing import Final

_WINDOW_NS: Final = 2_000_000_000
"""Time over which the least delay is searched: a crystal of 50 ppm drifts 0.1 ms in it."""

_OLDEST_NS: Final = 1_000_000_000
"""Older stamps are a bug of this program. The kernel itself accepts stamps of up to 10 s ago."""


class SensorClock:
    """Maps sensor time to CLOCK_MONOTONIC.

    The host delays each state by a varying time. The least delay of the last seconds is the offset
    between the clocks, so the stamps are as regular as the sensor's time.
    Stamps never go back and are never in the future.

    Args:
        now_ns: CLOCK_MONOTONIC, in ns.
    """

    def __init__(self, now_ns: Callable[[], int] = time.monotonic_ns) -> None:
        self._now_ns = now_ns
        self._t_us: int | None = None
        self._last_ns = 0
        self._windows: list[tuple[int, int]] = []  # begin and least offset; the newest two

    def stamp(self, t_us: int) -> int:
        """Returns the moment of a state in ns; now if it brings no newer sensor time."""
        now = self._now_ns()
        before_us, self._t_us = self._t_us, t_us
        stamp = now
        if before_us is not None and t_us <= before_us:
            if t_us < before_us:
                self._windows.clear()  # another recording, another camera
        else:
            stamp = t_us * 1_000 + self._find_offset(now, now - t_us * 1_000)
            if now - stamp > _OLDEST_NS:
                self._windows.clear()
                stamp = now
        self._last_ns = min(max(stamp, self._last_ns), now)
        return self._last_ns

    def now(self) -> int:
        """Returns the present time in ns, for states that do not come from a sensor."""
        self._last_ns = self._now_ns()
        return self._last_ns

    def _find_offset(self, now: int, offset: int) -> int:
        if not self._windows or now - self._windows[-1][0] > _WINDOW_NS:
            self._windows = [*self._windows[-1:], (now, offset)]
        begin, least = self._windows[-1]
        self._windows[-1] = begin, min(least, offset)
        return min(least for _, least in self._windows)

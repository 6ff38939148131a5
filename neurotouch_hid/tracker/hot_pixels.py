"""Finds pixels that never stop firing, and removes their events.

Beside a dot, such a pixel draws the dot's track towards itself. What moves is seen by neighbours
too, a hot pixel fires alone.
"""

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.messages import EVENT_DTYPE, SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX
from neurotouch_hid.process.kernel_cache import load
from neurotouch_hid.tracker.kernels import hot_pixels as kernels

WINDOW_US = 250_000  # of slices that are counted
BUSY_HZ = 2e6  # with more events a second, counting costs time, and a hot pixel does no harm


class HotPixelFilter:
    """Counts the events of each pixel, and removes those of hot pixels while there are some.

    Args:
        looks_late: leave it to the caller to call ``look`` after each slice, when there is time.
    """

    def __init__(self, *, looks_late: bool = False) -> None:
        self._looks_late = looks_late
        n = SENSOR_HEIGHT_PX * SENSOR_WIDTH_PX
        self._counts, self._streaks = np.zeros(n, np.uint16), np.zeros(n, np.uint8)
        self._out = np.empty(0, EVENT_DTYPE)
        self._n_hot = 0
        self._counted_us = 0
        load(kernels.judge_window, self._counts, self._streaks)
        load(kernels.remove_hot, self._out, self._streaks, self._out)

    def update(self, events: NDArray[np.void], begin_us: int, end_us: int) -> NDArray[np.void]:
        """Returns the events of a slice without those of hot pixels.

        Args:
            events: (n,) EVENT_DTYPE of the slice.
            begin_us: start of the slice.
            end_us: its end.

        Returns:
            (m,) EVENT_DTYPE: the same array if no pixel is hot, else one that is valid until the
            next call.
        """
        if 1e6 * len(events) > BUSY_HZ * (end_us - begin_us):
            return events
        kernels.count_events(events, self._counts)
        self._counted_us += end_us - begin_us
        if not self._looks_late:
            self.look()
        if not self._n_hot:
            return events
        if len(self._out) < len(events):
            self._out = np.empty(2 * len(events), EVENT_DTYPE)
        return self._out[: kernels.remove_hot(events, self._streaks, self._out)]

    def look(self) -> None:
        """Finds the hot pixels, if it is time; in play that takes a tenth of a millisecond."""
        if self._counted_us >= WINDOW_US:
            self._n_hot = kernels.judge_window(self._counts, self._streaks)
            self._counted_us = 0

"""Compiled loops that count the events of each pixel, and remove those of hot pixels."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX
from neurotouch_hid.process.kernel_cache import kernel

LEAST: Final = 12
"""A pixel that fires less often in a window does no harm."""
N_WINDOWS: Final = 4
"""So many windows in a row tell that a pixel is hot."""
MOST_ALIKE: Final = 1
"""So many of its eight neighbours may fire half as often. At the edge of a dot more of them do."""

BLOCK: Final = 128
"""Pixels that are looked at together."""


@kernel
def count_events(events: NDArray[np.void], counts: NDArray[np.uint16]) -> None:
    """Adds the events to the counts of their pixels.

    Args:
        events: (m,) EVENT_DTYPE.
        counts: (260 * 346,) uint16, updated.
    """
    for k in range(len(events)):
        e = events[np.uint64(k)]
        counts[np.uint64(e.y) * np.uint64(SENSOR_WIDTH_PX) + np.uint64(e.x)] += np.uint16(1)


@kernel
def judge_window(counts: NDArray[np.uint16], streaks: NDArray[np.uint8]) -> int:
    """Ends a window: updates for how many windows in a row each pixel has fired alone.

    A hot pixel remains one until it no longer fires.

    Args:
        counts: (260 * 346,) uint16, the events of the window; set to 0.
        streaks: (260 * 346,) uint8, windows, at most ``N_WINDOWS``; updated.

    Returns:
        The number of hot pixels, whose streaks are ``N_WINDOWS``.
    """
    n_hot = 0
    for begin in range(0, len(counts), BLOCK):
        block, most = counts[begin : begin + BLOCK], np.uint16(0)
        for k in range(len(block)):  # many at once, which ``max`` would not be
            most = block[k] if block[k] > most else most
        if most < LEAST:  # nearly always
            streaks[begin : begin + BLOCK] = 0
            continue
        for at in range(begin, begin + len(block)):
            if counts[at] < LEAST:
                streaks[at] = 0
                continue
            if streaks[at] == N_WINDOWS:  # also while a dot moves beside it
                n_hot += 1
                continue
            y, x = at // SENSOR_WIDTH_PX, at % SENSOR_WIDTH_PX
            n_alike = -1  # itself
            for near_y in range(max(y - 1, 0), min(y + 2, SENSOR_HEIGHT_PX)):
                for near_x in range(max(x - 1, 0), min(x + 2, SENSOR_WIDTH_PX)):
                    n_alike += 2 * counts[near_y * SENSOR_WIDTH_PX + near_x] >= counts[at]
            streaks[at] = streaks[at] + 1 if n_alike <= MOST_ALIKE else 0
            n_hot += streaks[at] == N_WINDOWS
    counts[:] = 0
    return n_hot


@kernel
def remove_hot(events: NDArray[np.void], streaks: NDArray[np.uint8], out: NDArray[np.void]) -> int:
    """Copies the events of all pixels that are not hot.

    Args:
        events: (m,) EVENT_DTYPE.
        streaks: (260 * 346,) uint8, see ``judge_window``.
        out: (m or more,) EVENT_DTYPE, written.

    Returns:
        The number of events written.
    """
    n = np.uint64(0)
    for k in range(len(events)):
        e = events[np.uint64(k)]
        out[n] = e
        at = np.uint64(e.y) * np.uint64(SENSOR_WIDTH_PX) + np.uint64(e.x)
        n += np.uint64(streaks[at] < N_WINDOWS)
    return int(n)

"""Compiled loop that checks the events of a file."""

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.process.kernel_cache import kernel


@kernel
def check_events(
    words: NDArray[np.int64], width: int, height: int, reached_us: int, tolerated_us: int
) -> tuple[bool, int, int, int, int, int]:
    """Makes events ascend in time, and their polarity and padding what ours are.

    Args:
        words: (2 n,) int64, n > 0 events of ``EVENT_DTYPE``, in two words each; updated. An event
            that steps back keeps the latest stamp before it.
        width: number of columns of the sensor.
        height: number of its rows.
        reached_us: the stamp of the event before.
        tolerated_us: larger steps back are reported.

    Returns:
        True if an event lies outside of the sensor; the least and the largest stamp; the latest
        stamp before the first reported step back, and the one after it, both 0 without one; the
        last stamp. If an event is outside or a step back is reported, only that has a meaning.
    """
    is_outside = False
    least_us = most_us = words[0]
    before_us = after_us = 0
    for k in range(0, len(words), 2):
        t_us, place = words[k], words[k + 1]
        is_outside |= (place & 0xFFFF >= width) | (place >> 16 & 0xFFFF >= height)
        words[k + 1] = place & 0xFFFFFFFF | ((place >> 32 & 0xFF) != 0) << 32
        least_us, most_us = min(least_us, t_us), max(most_us, t_us)
        if t_us >= reached_us:
            reached_us = t_us
            continue
        if reached_us - t_us > tolerated_us and before_us == after_us:
            before_us, after_us = reached_us, t_us
        words[k] = reached_us
    return is_outside, least_us, most_us, before_us, after_us, reached_us

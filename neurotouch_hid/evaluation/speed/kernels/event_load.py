"""Compiled loop that adds events near markers to those of a scene."""

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.process.kernel_cache import kernel


@kernel
def fill_slice(
    own: NDArray[np.void],
    shift_us: int,
    begin_us: int,
    length_us: int,
    markers_px: NDArray[np.float32],
    marker: NDArray[np.int32],
    off_px: NDArray[np.float32],
    is_on: NDArray[np.bool_],
    first: int,
    events: NDArray[np.void],
) -> None:
    """Fills a slice with evenly spaced events; the slice's own events replace some of them.

    Args:
        own: (m,) EVENT_DTYPE, kept in their order; evenly chosen ones if they are too many.
        shift_us: added to their stamps.
        begin_us: of the slice.
        length_us: of the slice.
        markers_px: (k, 2) float32, places of markers; no nearer to the sensor's rim than the
            largest of ``off_px``.
        marker: (p,) int32, markers drawn at random.
        off_px: (p, 2) float32, how far the event is from the marker, and half a pixel.
        is_on: (p,) bool, its polarity.
        first: index of the first number to use; the numbers are used cyclically.
        events: (n,) EVENT_DTYPE, written.
    """
    n, m, size = len(events), len(own), len(marker)
    taken = 0  # of its own
    k, step_us = first % size, length_us / n  # no division in the loop
    for i in range(n):
        event = events[i]
        event["t"] = begin_us + int(i * step_us)
        is_full = m - taken >= n - i
        if m >= n:
            source = own[i * m // n]
            event["x"], event["y"], event["p"] = source["x"], source["y"], source["p"]
        elif taken < m and (is_full or own[taken]["t"] + shift_us <= event["t"]):
            source = own[taken]
            event["x"], event["y"], event["p"] = source["x"], source["y"], source["p"]
            taken += 1
        else:
            event["x"] = int(markers_px[marker[k], 0] + off_px[k, 0])
            event["y"] = int(markers_px[marker[k], 1] + off_px[k, 1])
            event["p"] = is_on[k]
            k = k + 1 if k + 1 < size else 0

"""Compiled loops that map a sensor's picture to the canonical one."""

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.process.kernel_cache import kernel

ONE = 256
"""Weight of a whole pixel."""


@kernel(error_model="numpy")
def average_boxes(
    pixels: NDArray[np.uint8], n: int, row: NDArray[np.uint16], boxed: NDArray[np.uint8]
) -> None:
    """Writes the mean of every box of n x n pixels.

    Args:
        pixels: (h, w) uint8.
        n: side of a box, 2 to 64 px.
        row: (w,) uint16 scratch.
        boxed: (h // n, w // n) uint8, written.
    """
    width = boxed.shape[1] * n
    half, area = n * n // 2, n * n
    for y in range(boxed.shape[0]):
        for x in range(width):
            row[x] = pixels[y * n, x]
        for k in range(1, n):
            line = pixels[y * n + k]
            for x in range(width):
                row[x] += line[x]
        for x in range(boxed.shape[1]):
            total = half
            for k in range(n):
                total += row[x * n + k]
            boxed[y, x] = total // area


@kernel(error_model="numpy")
def interpolate(
    pixels: NDArray[np.uint8],
    left: NDArray[np.int16],
    top: NDArray[np.int16],
    share: NDArray[np.uint16],
    out: NDArray[np.uint8],
) -> None:
    """Writes a picture whose pixels lie between those of another.

    Args:
        pixels: (h, w) uint8.
        left: (height, width) int16, the pixel column left of each point, at most w - 2.
        top: (height, width) int16, the row above each point, at most h - 2.
        share: (2, height, width) uint16, weight of the pixel right of it and below it, 0 to
            ``ONE``.
        out: (height, width) uint8, written.
    """
    for y in range(out.shape[0]):
        for x in range(out.shape[1]):
            i, j = top[y, x], left[y, x]
            right, below = np.int32(share[0, y, x]), np.int32(share[1, y, x])
            upper = pixels[i, j] * (ONE - right) + pixels[i, j + 1] * right
            lower = pixels[i + 1, j] * (ONE - right) + pixels[i + 1, j + 1] * right
            total = upper * (ONE - below) + lower * below
            out[y, x] = (total + ONE * ONE // 2) // (ONE * ONE)


NOWHERE = -1
"""In a table of places: the pixel has none in the canonical picture."""


@kernel
def map_events(events: NDArray[np.void], places: NDArray[np.int32], out: NDArray[np.void]) -> int:
    """Brings events to the canonical picture; those that have no place there are left out.

    Args:
        events: (n,) records with ``t``, ``x``, ``y`` and ``p``, such as EVENT_DTYPE.
        places: (h, w) int32 of each pixel of the sensor: x + 65,536 y, or ``NOWHERE``.
        out: (n,) EVENT_DTYPE or longer, written; its first events may be those of ``events``.

    Returns:
        The number of events written.
    """
    n = 0
    for i in range(len(events)):
        event = events[i]
        place = places[event.y, event.x]
        if place != NOWHERE:
            mapped = out[n]
            mapped.t = event.t
            mapped.x = place & 0xFFFF
            mapped.y = place >> 16
            mapped.p = event.p
            n += 1
    return n

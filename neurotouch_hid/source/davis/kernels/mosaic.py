"""Compiled loops over the four kinds of pixels behind a colour filter."""

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.process.kernel_cache import kernel

ONE = 256
"""Gain of the brightest kind of pixels."""
WHITE = 255


@kernel
def add_kinds(pixels: NDArray[np.uint8], totals: NDArray[np.int64]) -> int:
    """Adds the pixels of each kind, over all squares of 2 x 2 in which none is white.

    Args:
        pixels: (h, w) uint8.
        totals: (4,) int64, written: top left, top right, bottom left, bottom right.

    Returns:
        The number of squares.
    """
    totals[:] = 0
    n = 0
    for y in range(0, pixels.shape[0] - 1, 2):
        for x in range(0, pixels.shape[1] - 1, 2):
            a, b = np.int64(pixels[y, x]), np.int64(pixels[y, x + 1])
            c, d = np.int64(pixels[y + 1, x]), np.int64(pixels[y + 1, x + 1])
            if max(a, b, c, d) < WHITE:
                totals[0] += a
                totals[1] += b
                totals[2] += c
                totals[3] += d
                n += 1
    return n


@kernel
def level(pixels: NDArray[np.uint8], gains: NDArray[np.int64]) -> None:
    """Multiplies the pixels of each kind, in place.

    Args:
        pixels: (h, w) uint8.
        gains: (4,) int64, in parts of ``ONE``, in the order of ``add_kinds``.
    """
    for y in range(pixels.shape[0]):
        left, right = gains[2 * (y & 1)], gains[2 * (y & 1) + 1]
        for x in range(pixels.shape[1]):
            gain = right if x & 1 else left
            pixels[y, x] = min(WHITE, (pixels[y, x] * gain + ONE // 2) // ONE)

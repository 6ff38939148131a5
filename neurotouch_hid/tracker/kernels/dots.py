"""Compiled loops that measure single dots of a frame: how wide and how bright they are."""

import math

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.process.kernel_cache import kernel


@kernel
def draw_usual(
    pixels: NDArray[np.uint8],
    x: NDArray[np.intp],
    y: NDArray[np.intp],
    reach: int,
) -> NDArray[np.float64]:
    """Returns how some dots look: of each pixel around them, the mean of the middle half of them.

    Of one dot the noise would be too large, and some dots are reflections, which are sharp.

    Args:
        pixels: (h, w) uint8.
        x: (m,) columns of the dots; no closer to the border than ``reach``.
        y: (m,) their rows.
        reach: radius of the picture of a dot, px.

    Returns:
        (k,) float64, grey levels of the pixels of a disc.
    """
    cut = len(x) // 4
    end = len(x) - cut
    size = 2 * reach + 1
    out, k = np.empty(size * size), 0
    counts = np.empty(256, np.int64)
    for dy in range(-reach, reach + 1):
        for dx in range(-reach, reach + 1):
            if dx * dx + dy * dy > reach * reach:
                continue
            counts[:] = 0
            for i in range(len(x)):
                counts[pixels[y[i] + dy, x[i] + dx]] += 1
            total, n_below = 0, 0
            for level in range(256):  # only dots from number ``cut`` to ``end`` count
                n = counts[level]
                total += level * max(min(n_below + n, end) - max(n_below, cut), 0)
                n_below += n
            out[k] = total / (end - cut)
            k += 1
    return out[:k]


@kernel
def find_peaks(pixels: NDArray[np.uint8], dots_px: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns the brightest of 3 x 3 pixels around each dot, (m,) float64 grey levels."""
    h, w = pixels.shape
    peak = np.empty(len(dots_px))
    for j in range(len(dots_px)):
        x = min(max(int(np.rint(dots_px[j, 0])), 1), w - 2)
        y = min(max(int(np.rint(dots_px[j, 1])), 1), h - 2)
        most = pixels[y, x]
        for v in range(y - 1, y + 2):
            for u in range(x - 1, x + 2):
                most = max(most, pixels[v, u])
        peak[j] = most
    return peak


@kernel
def find_usual_peaks(
    peak: NDArray[np.float64],
    blob: NDArray[np.integer],
    neighbours: NDArray[np.intp],
    share: float,
) -> NDArray[np.float64]:
    """Returns how bright the brighter markers around each marker are, (n,) float64 grey levels.

    Args:
        peak: (m,) float64 grey levels, of each dot.
        blob: (n,), the dot of each marker; negative without one.
        neighbours: (n, 8) intp, -1 where there is none.
        share: of the neighbours, that are no brighter; NaN without neighbours.
    """
    usual, around = np.full(len(blob), np.nan), np.empty(8)
    for i in range(len(blob)):
        n = 0
        for k in range(8):
            j = neighbours[i, k]
            if j >= 0 and blob[j] >= 0:
                level, at = peak[blob[j]], n
                while at > 0 and around[at - 1] > level:  # in order, the darkest first
                    around[at] = around[at - 1]
                    at -= 1
                around[at] = level
                n += 1
        if n:
            usual[i] = around[int(share * (n - 1))]
    return usual


@kernel
def find_markers(dots_px: NDArray[np.float64], blob: NDArray[np.integer]) -> NDArray[np.intp]:
    """Returns the marker that each dot is or is beside, (m,) intp; negative off the gel.

    Args:
        dots_px: (m, 2) float64 px.
        blob: (n,), the dot of each marker; negative without one.
    """
    marker = np.full(len(dots_px), -1, np.intp)
    x = y = 0.0
    seen = np.flatnonzero(blob >= 0)
    for i in seen:
        marker[blob[i]] = i
        x, y = x + dots_px[blob[i], 0] / len(seen), y + dots_px[blob[i], 1] / len(seen)
    most_px2 = 0.0
    for i in seen:
        dx, dy = dots_px[blob[i], 0] - x, dots_px[blob[i], 1] - y
        most_px2 = max(most_px2, dx * dx + dy * dy)
    pitch_px2 = math.pi * most_px2 / len(blob)  # the area of the disc around the markers, shared
    for j in range(len(dots_px)):
        if marker[j] >= 0:
            continue
        near_px2 = pitch_px2
        for i in seen:
            dx, dy = dots_px[j, 0] - dots_px[blob[i], 0], dots_px[j, 1] - dots_px[blob[i], 1]
            px2 = dx * dx + dy * dy
            if px2 < near_px2:
                marker[j], near_px2 = i, px2
    return marker

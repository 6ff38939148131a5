"""Compiled loops that find bright blobs in a frame, and their centroids."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.kernels.order_statistics import median
from neurotouch_hid.process.kernel_cache import kernel

BLOCK_PX = 8  # brightness is measured in windows of 3 x 3 blocks, two to three markers wide
SHIFT = 3  # log2(BLOCK_PX)
GAIN = 3  # of a smoothed picture, so that rounding is no noise
MIDDLE_DN = 64.0  # grey level between its dots
WINDOW_PX = 3  # a dot lies within so many pixels of its middle
WINDOW_ROUNDS = 3  # of a centroid in a window that follows it
WINDOW_GAIN = 2.0  # the window hides a half of how far a dot is off, if it is as wide as the dot
NOISE_LEFT = 70.0 / 256.0  # of the noise: 1, 4, 6, 4, 1 squared, over 16 squared


class Buffers(NamedTuple):
    """Arrays that the search for blobs writes; m is the largest number of blobs.

    Attributes:
        threshold: (rows, columns) float64, the threshold of every block, grey levels.
        background: (rows, columns) float64, the level between the markers.
        bright: (h + 2, v) uint8 scratch, all 0 before and after the search. v is a multiple of 8
            and larger than w, so that no region has to look for the picture's border: there is
            nothing left of the first column, which follows the last column of the row before.
        centroid_px: (m, 2) float64, weighted by intensity, columns x, y.
        begin: (m + 1,) int32: the pixels of blob i are members[begin[i]:begin[i + 1]].
        members: (h * w,) int32, y * w + x.
        smoothed: (h, w) uint8, the smoothed picture, if there is need of one.
    """

    threshold: NDArray[np.float64]
    background: NDArray[np.float64]
    bright: NDArray[np.uint8]
    centroid_px: NDArray[np.float64]
    begin: NDArray[np.int32]
    members: NDArray[np.int32]
    smoothed: NDArray[np.uint8]


class Limits(NamedTuple):
    """Limits of a blob; ``BlobConfig`` explains the first five.

    Attributes:
        most_blobs: of more, most are noise, which also joins some to dots.
        window_px: standard deviation of the window in which a dot is centred.
    """

    n_sigma: float
    min_contrast: float
    min_clear: int
    min_area_px: int
    max_area_px: int
    most_blobs: int
    window_px: float


@kernel(error_model="numpy")
def threshold_blocks(
    pixels: NDArray[np.uint8],
    n_sigma: float,
    min_contrast: float,
    threshold: NDArray[np.float64],
    background: NDArray[np.float64],
) -> int:
    """Writes threshold and background of every block, from the blocks around it.

    Mean and standard deviation come from every second row, which halves the time.

    Args:
        pixels: (h, w) uint8.
        n_sigma: threshold above the mean, in standard deviations of the window.
        min_contrast: least threshold above the mean, grey levels.
        threshold: (rows, columns) float64, written, grey levels.
        background: (rows, columns) float64, written: the level between the markers.

    Returns:
        The number of blocks whose threshold is above the least one: dots stand out there.
    """
    h, w = pixels.shape
    rows, columns = threshold.shape
    n_clear = 0
    # Sums of each block, with a border of empty blocks: pixels, grey level, its square.
    sums = np.zeros((rows + 2, 3, columns + 2), np.int32)
    padded = columns * BLOCK_PX
    total, square = np.empty(padded, np.int32), np.empty(padded, np.int32)  # of 8 rows, by column
    for i in range(rows):
        total[:], square[:] = 0, 0
        top, bottom = i * BLOCK_PX, min(h, (i + 1) * BLOCK_PX)
        for y in range(top, bottom, 2):
            row = pixels[y]
            for x in range(w):
                v = np.int32(row[x])
                total[x] += v
                square[x] += v * v
        for j in range(columns):
            s, q = np.int32(0), np.int32(0)
            for k in range(BLOCK_PX):
                x = j * BLOCK_PX + k
                s += total[x]
                q += square[x]
            width = min(w - j * BLOCK_PX, BLOCK_PX)
            sums[i + 1, 0, j + 1] = (bottom - top + 1) // 2 * width
            sums[i + 1, 1, j + 1], sums[i + 1, 2, j + 1] = s, q
    tall = np.empty((3, columns + 2), np.int32)
    for i in range(rows):
        above, here, below = sums[i], sums[i + 1], sums[i + 2]
        for k in range(3):
            for j in range(columns + 2):
                tall[k, j] = above[k, j] + here[k, j] + below[k, j]
        for j in range(columns):
            n = tall[0, j] + tall[0, j + 1] + tall[0, j + 2]
            mean = (tall[1, j] + tall[1, j + 1] + tall[1, j + 2]) / n
            power = (tall[2, j] + tall[2, j + 1] + tall[2, j + 2]) / n
            sigma = math.sqrt(max(power - mean * mean, 0.0))
            threshold[i, j] = mean + max(n_sigma * sigma, min_contrast)
            background[i, j] = mean - 0.25 * sigma  # markers cover some 5 % of a window
            n_clear += n_sigma * sigma > min_contrast
    return n_clear


@kernel
def smooth(pixels: NDArray[np.uint8], gain: int, middle_dn: float, out: NDArray[np.uint8]) -> None:
    """Writes a picture smoothed by binomials of five pixels, with ``gain`` times the contrast.

    Noise that differs from pixel to pixel shrinks to ``NOISE_LEFT`` of it, before ``gain``.

    Args:
        pixels: (h, w) uint8.
        gain: 1 or more.
        middle_dn: grey level that becomes ``MIDDLE_DN``.
        out: (h, w) uint8, written.
    """
    h, w = pixels.shape
    column = np.zeros(w + 4, np.int32)
    shift = np.int32(256.0 * (MIDDLE_DN - gain * middle_dn)) + 128
    for y in range(h):
        a, b = pixels[max(y - 2, 0)], pixels[max(y - 1, 0)]
        c, d = pixels[min(y + 1, h - 1)], pixels[min(y + 2, h - 1)]
        row = pixels[y]
        for x in range(w):
            ends, near = np.int32(a[x]) + d[x], np.int32(b[x]) + c[x]
            column[x + 2] = ends + 4 * near + 6 * np.int32(row[x])
        column[0] = column[1] = column[2]
        column[w + 2] = column[w + 3] = column[w + 1]
        for x in range(w):
            ends, near = column[x] + column[x + 4], column[x + 1] + column[x + 3]
            level = (gain * (ends + 4 * near + 6 * column[x + 2]) + shift) >> 8
            out[y, x] = min(max(level, 0), 255)


@kernel
def _mark(
    pixels: NDArray[np.uint8], threshold: NDArray[np.float64], out: NDArray[np.uint8]
) -> None:
    """Sets pixels above the threshold of their block in ``out``, one row further down."""
    h, w = pixels.shape
    rows, columns = threshold.shape
    level = np.empty((columns, BLOCK_PX), np.uint8)
    levels = level.ravel()
    for i in range(rows):
        for j in range(columns):
            # Grey levels are integers: above 37.4 is above 37.
            level[j, :] = np.uint8(min(threshold[i, j], 255.0))
        for y in range(i * BLOCK_PX, min(h, (i + 1) * BLOCK_PX)):
            row, marked = pixels[y], out[y + 1]
            for x in range(w):
                marked[x] = row[x] > levels[x]


@kernel
def _fill(
    start: int, stride: int, bright: NDArray[np.uint8], members: NDArray[np.int32]
) -> np.int64:
    """Appends the region around the member ``start`` and clears it in ``bright``.

    Args:
        start: the first member; it is cleared already.
        stride: pixels in a row of ``bright``.
        bright: flat.
        members: indices into ``bright``.

    Returns:
        The new end of the members.
    """
    # Unsigned: an index that may be negative would cost a test for each use.
    head, tail, one, row = np.uint64(start), np.uint64(start + 1), np.uint64(1), np.uint64(stride)
    while head < tail:
        at = np.uint64(members[head])
        head += one
        for near in (at - row, at - one, at + one, at + row):
            if bright[near]:
                bright[near] = 0
                members[tail] = near
                tail += one
    return np.int64(tail)


@kernel(error_model="numpy")
def _measure_blobs(n: int, pixels: NDArray[np.uint8], buffers: Buffers) -> None:
    """Writes the centroids of the first ``n`` blobs, and makes their members indices of pixels."""
    background, begin, members = buffers.background, buffers.begin, buffers.members
    w, stride = np.uint32(pixels.shape[1]), np.uint32(buffers.bright.shape[1])
    shift = np.uint32(SHIFT)
    for i in range(n):
        mass, mx, my = 0.0, 0.0, 0.0
        for k in range(begin[i], begin[i + 1]):
            at = np.uint32(members[np.uint64(k)])
            row = np.uint32(at // stride)  # unsigned integers divide faster
            x, y = np.uint32(at - row * stride), np.uint32(row - np.uint32(1))
            members[np.uint64(k)] = y * w + x
            weight = pixels[y, x] - background[y >> shift, x >> shift]
            mass += weight
            mx += weight * x
            my += weight * y
        buffers.centroid_px[i, 0], buffers.centroid_px[i, 1] = mx / mass, my / mass


@kernel
def find_blobs(
    pixels: NDArray[np.uint8], min_area_px: int, max_area_px: int, buffers: Buffers
) -> int:
    """Finds the connected regions above the threshold, with centroids weighted by intensity.

    Args:
        pixels: (h, w) uint8.
        min_area_px: smaller regions are noise.
        max_area_px: larger regions are no markers.
        buffers: ``threshold`` and ``background`` are read, all else is written.

    Returns:
        The number of blobs, at most m.
    """
    begin, members, stride = buffers.begin, buffers.members, buffers.bright.shape[1]
    bright, words = buffers.bright.ravel(), buffers.bright.view(np.uint64).ravel()
    _mark(pixels, buffers.threshold, buffers.bright)
    n, used = 0, np.int64(0)
    begin[0] = 0
    for j in range(len(words)):
        if not words[j]:  # most are 0
            continue
        for at in range(8 * j, 8 * j + 8):
            if not bright[at]:
                continue
            if n == len(begin) - 1:
                bright[:] = 0
                break
            bright[at] = 0
            members[used] = at
            end = _fill(used, stride, bright, members)
            if min_area_px <= end - used <= max_area_px:
                used = end
                n += 1
                begin[n] = used
    _measure_blobs(n, pixels, buffers)
    return n


@kernel(error_model="numpy")
def centre_blobs(
    pixels: NDArray[np.uint8],
    sigma_px: float,
    background: NDArray[np.float64],
    centroid_px: NDArray[np.float64],
) -> None:
    """Moves centroids to the middle of their dots in a Gaussian window (SExtractor's XWIN).

    Which pixels exceed a threshold jumps while a dot goes a part of a pixel, so the middle of those
    that do is up to 0.2 px off. Noise decides it, too, and whether a dot has joined specks beside
    it. Such a window asks for no threshold, and pixels far from the dot hardly count.

    Args:
        pixels: (h, w) uint8.
        sigma_px: standard deviation of the window, half of a dot's diameter.
        background: (rows, columns) float64, the level between the dots in each block.
        centroid_px: (n, 2) float64 px, updated.
    """
    h, w = pixels.shape
    falling = -0.5 / (sigma_px * sigma_px)
    across = np.empty(2 * WINDOW_PX + 1)
    for i in range(len(centroid_px)):
        x, y = centroid_px[i, 0], centroid_px[i, 1]
        for _ in range(WINDOW_ROUNDS):
            x0, y0 = int(x + 0.5), int(y + 0.5)
            if not (WINDOW_PX <= x0 < w - WINDOW_PX and WINDOW_PX <= y0 < h - WINDOW_PX):
                break
            level = background[y0 >> SHIFT, x0 >> SHIFT]
            for k in range(len(across)):
                across[k] = math.exp(falling * (x0 - WINDOW_PX + k - x) ** 2)
            mass, mx, my = 0.0, 0.0, 0.0
            for v in range(y0 - WINDOW_PX, y0 + WINDOW_PX + 1):
                row_mass, row_x = 0.0, 0.0
                for k in range(len(across)):
                    u = x0 - WINDOW_PX + k
                    weight = max(pixels[v, u] - level, 0.0) * across[k]
                    row_mass += weight
                    row_x += weight * (u - x)
                row = math.exp(falling * (v - y) ** 2)
                mass += row * row_mass
                mx += row * row_x
                my += row * row_mass * (v - y)
            if mass <= 0.0:
                break
            x += WINDOW_GAIN * mx / mass
            y += WINDOW_GAIN * my / mass
        if abs(x - centroid_px[i, 0]) < WINDOW_PX and abs(y - centroid_px[i, 1]) < WINDOW_PX:
            centroid_px[i, 0], centroid_px[i, 1] = x, y


@kernel
def search(buffers: Buffers, limits: Limits, pixels: NDArray[np.uint8], is_fine: bool) -> int:
    """Finds the blobs of a frame; one that is weak or noisy is smoothed first.

    Args:
        buffers: written.
        limits: what is a blob.
        pixels: (h, w) uint8.
        is_fine: centre dots in a window also where there is little noise.

    Returns:
        The number of blobs.
    """
    b, c, least = buffers, limits, limits.min_contrast
    n_clear = threshold_blocks(pixels, c.n_sigma, least, b.threshold, b.background)
    if n_clear < c.min_clear:
        smooth(pixels, GAIN, median(b.background.ravel()), b.smoothed)
        least *= GAIN * NOISE_LEFT
        threshold_blocks(b.smoothed, c.n_sigma, least, b.threshold, b.background)
        return int(find_blobs(b.smoothed, c.min_area_px, c.max_area_px, b))
    n = int(find_blobs(pixels, c.min_area_px, c.max_area_px, b))
    is_noisy = n > c.most_blobs
    if is_noisy:
        smooth(pixels, 1, MIDDLE_DN, b.smoothed)
        threshold_blocks(b.smoothed, c.n_sigma, least, b.threshold, b.background)
        n = int(find_blobs(b.smoothed, c.min_area_px, c.max_area_px, b))
    if is_noisy or is_fine:
        centre_blobs(pixels, c.window_px, b.background, b.centroid_px[:n])
    return n

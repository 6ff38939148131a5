"""The compiled loops on frames: bright blobs, their centroids, distances between sets of pixels."""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

BLOCK_PX = 8  # light is measured in windows of 3 x 3 blocks: two to three markers wide


@njit(cache=True, nogil=True)
def threshold_blocks(
    pixels: NDArray[np.uint8],
    n_sigma: float,
    min_contrast: float,
    threshold: NDArray[np.float64],
    background: NDArray[np.float64],
    peak: NDArray[np.int32],
) -> None:
    """Threshold and background of every block, from mean and deviation of the blocks around it.

    Args:
        pixels: (h, w) uint8.
        n_sigma: threshold above the mean, in standard deviations of the window.
        min_contrast: least threshold above the mean, grey levels.
        threshold: (rows, columns) float64, filled in.
        background: (rows, columns) float64, filled in: the level between the markers.
        peak: (rows, columns) int32, filled in: the brightest pixel of the block itself.
    """
    h, w = pixels.shape
    rows, columns = threshold.shape
    # Sums of each block, with a border of empty blocks: intensity, its square, pixels.
    sums = np.zeros((3, rows + 2, columns + 2), np.int32)
    total, square = np.empty(w, np.int32), np.empty(w, np.int32)  # of 8 rows, column by column
    brightest = np.empty(w, np.uint8)
    for i in range(rows):
        total[:], square[:], brightest[:] = 0, 0, 0
        top, bottom = i * BLOCK_PX, min(h, (i + 1) * BLOCK_PX)
        for y in range(top, bottom):
            row = pixels[y]
            for x in range(w):
                v = np.int32(row[x])
                total[x] += v
                square[x] += v * v
            for x in range(w):
                brightest[x] = max(brightest[x], row[x])
        for j in range(columns):
            left, right = j * BLOCK_PX, min(w, (j + 1) * BLOCK_PX)
            s, q, p = 0, 0, np.uint8(0)
            for x in range(left, right):
                s += total[x]
                q += square[x]
                p = max(p, brightest[x])
            sums[0, i + 1, j + 1], sums[1, i + 1, j + 1] = s, q
            sums[2, i + 1, j + 1] = (bottom - top) * (right - left)
            peak[i, j] = p
    tall = sums[:, :-2] + sums[:, 1:-1] + sums[:, 2:]
    wide = tall[:, :, :-2] + tall[:, :, 1:-1] + tall[:, :, 2:]
    for i in range(rows):
        for j in range(columns):
            n = wide[2, i, j]
            mean = wide[0, i, j] / n
            sigma = math.sqrt(max(wide[1, i, j] / n - mean * mean, 0.0))
            threshold[i, j] = mean + max(n_sigma * sigma, min_contrast)
            background[i, j] = mean - 0.25 * sigma  # markers cover some 5 % of a window


@njit(cache=True, nogil=True)
def _flood(
    y0: int,
    x0: int,
    begin: int,
    pixels: NDArray[np.uint8],
    threshold: NDArray[np.float64],
    background: NDArray[np.float64],
    seen: NDArray[np.uint8],
    members: NDArray[np.int32],
) -> tuple[int, float, float, float]:
    """Append the region around (x0, y0); its new end, mass and first moments in x and y."""
    h, w = pixels.shape
    seen[y0, x0] = 1
    members[begin] = y0 * w + x0
    head, tail = begin, begin + 1
    mass, mx, my = 0.0, 0.0, 0.0
    while head < tail:
        y, x = members[head] // w, members[head] % w
        head += 1
        weight = pixels[y, x] - background[y // BLOCK_PX, x // BLOCK_PX]
        mass += weight
        mx += weight * x
        my += weight * y
        for dy, dx in ((-1, 0), (0, -1), (0, 1), (1, 0)):
            v, u = y + dy, x + dx
            if (
                0 <= v < h
                and 0 <= u < w
                and not seen[v, u]
                and pixels[v, u] > threshold[v // BLOCK_PX, u // BLOCK_PX]
            ):
                seen[v, u] = 1
                members[tail] = v * w + u
                tail += 1
    return tail, mass, mx, my


@njit(cache=True, nogil=True)
def find_blobs(
    pixels: NDArray[np.uint8],
    threshold: NDArray[np.float64],
    background: NDArray[np.float64],
    peak: NDArray[np.int32],
    min_area_px: int,
    max_area_px: int,
    seen: NDArray[np.uint8],
    centroid_px: NDArray[np.float64],
    begin: NDArray[np.int32],
    members: NDArray[np.int32],
) -> int:
    """Connected regions above the threshold, with centroids weighted by intensity.

    Args:
        pixels: (h, w) uint8.
        threshold: (rows, columns) float64, of every block.
        background: (rows, columns) float64, of every block.
        peak: (rows, columns) int32, of every block.
        min_area_px: smaller regions are noise.
        max_area_px: larger regions are no markers.
        seen: (h, w) uint8 scratch.
        centroid_px: (m, 2) float64, filled in, columns x, y.
        begin: (m + 1,) int32, filled in: pixels of blob i are members[begin[i]:begin[i + 1]].
        members: (h * w,) int32, filled in: y * w + x.

    Returns:
        The number of blobs, at most m.
    """
    h, w = pixels.shape
    seen[:] = 0
    n, used = 0, 0
    begin[0] = 0
    for i in range(threshold.shape[0]):
        for j in range(threshold.shape[1]):
            if peak[i, j] <= threshold[i, j]:
                continue
            for y0 in range(i * BLOCK_PX, min(h, (i + 1) * BLOCK_PX)):
                for x0 in range(j * BLOCK_PX, min(w, (j + 1) * BLOCK_PX)):
                    if pixels[y0, x0] <= threshold[i, j] or seen[y0, x0]:
                        continue
                    if n == len(centroid_px):
                        return n
                    end, mass, mx, my = _flood(
                        y0, x0, used, pixels, threshold, background, seen, members
                    )
                    if min_area_px <= end - used <= max_area_px:
                        centroid_px[n, 0], centroid_px[n, 1] = mx / mass, my / mass
                        used = end
                        n += 1
                        begin[n] = used
    return n


@njit(cache=True, nogil=True)
def distance_map(mask: NDArray[np.uint8], out: NDArray[np.int32]) -> None:
    """The exact squared distance (px²) of every pixel to the nearest one set in ``mask``."""
    h, w = mask.shape
    far = h + w
    column = np.empty((h, w), np.int64)
    for x in range(w):
        d = far
        for y in range(h):
            d = 0 if mask[y, x] else min(d + 1, far)
            column[y, x] = d
        for y in range(h - 1, -1, -1):
            d = 0 if mask[y, x] else min(d + 1, far)
            column[y, x] = min(column[y, x], d)
    for y in range(h):
        for x in range(w):
            best = column[y, x] ** 2
            k = 1
            while k * k < best and k < w:
                if x - k >= 0:
                    best = min(best, k * k + column[y, x - k] ** 2)
                if x + k < w:
                    best = min(best, k * k + column[y, x + k] ** 2)
                k += 1
            out[y, x] = best


@njit(cache=True, nogil=True)
def ring_distance(index: int, mask: NDArray[np.uint8]) -> int:
    """The exact squared distance (px²) of one pixel to the nearest one set in ``mask``.

    Looks at square rings of growing size around the pixel; -1 if the mask is empty.
    """
    h, w = mask.shape
    y, x = index // w, index % w
    if mask[y, x]:
        return 0
    best = h * h + w * w
    k = 1
    while k * k < best and k < h + w:
        for j in range(-k, k + 1):
            d = k * k + j * j
            if d < best:
                left, right, top, bottom = x - k, x + k, y - k, y + k
                v, u = y + j, x + j
                if (
                    0 <= v < h and ((left >= 0 and mask[v, left]) or (right < w and mask[v, right]))
                ) or (
                    0 <= u < w and ((top >= 0 and mask[top, u]) or (bottom < h and mask[bottom, u]))
                ):
                    best = d
        k += 1
    return best if k < h + w else -1


@njit(cache=True, nogil=True)
def chamfer(
    now: NDArray[np.int32],
    now_mask: NDArray[np.uint8],
    reference: NDArray[np.int32],
    reference_px2: NDArray[np.int32],
) -> float:
    """Sum of the two mean squared distances between sets of pixels (px²) [NT, Eq. Chamfer].

    Args:
        now: (n,) int32 pixel indices, n > 0.
        now_mask: (h, w) uint8, the same pixels as a mask.
        reference: (m,) int32 pixel indices, m > 0.
        reference_px2: (h, w) int32, the distance map of the reference.
    """
    w = now_mask.shape[1]
    forward = 0
    for index in now:
        forward += reference_px2[index // w, index % w]
    backward = 0
    for index in reference:
        backward += ring_distance(index, now_mask)
    return forward / len(now) + backward / len(reference)


@njit(cache=True, nogil=True)
def match_points(
    targets_px: NDArray[np.float64],
    points_px: NDArray[np.float64],
    gate_px: float,
    out: NDArray[np.int32],
) -> int:
    """For each target the index of its point, -1 where there is none, -2 where there is any doubt.

    The two choose each other as the nearest, and the target's second choice is twice as far.

    Args:
        targets_px: (n, 2) float64, columns x, y.
        points_px: (m, 2) float64.
        gate_px: distance limit.
        out: (n,) int32, filled in.

    Returns:
        The number of pairs.
    """
    n, m = len(targets_px), len(points_px)
    gate_px2, reach_px = gate_px * gate_px, 2.0 * gate_px
    near = np.full(m, -1, np.int32)
    near_px2 = np.full(m, gate_px2)
    n_pairs = 0
    for i in range(n):
        best, best_px2, second_px2 = -1, gate_px2, 4.0 * gate_px2
        x, y = targets_px[i, 0], targets_px[i, 1]
        for j in range(m):
            dy = points_px[j, 1] - y
            if dy > reach_px or dy < -reach_px:
                continue
            dx = points_px[j, 0] - x
            px2 = dx * dx + dy * dy
            if px2 < best_px2:
                if best >= 0:
                    second_px2 = min(second_px2, best_px2)
                best, best_px2 = j, px2
            elif px2 < second_px2:
                second_px2 = px2
            if px2 < near_px2[j]:
                near[j], near_px2[j] = i, px2
        out[i] = best if best < 0 or 4.0 * best_px2 <= second_px2 else -2
    for i in range(n):
        if out[i] >= 0 and near[out[i]] != i:
            out[i] = -2
        n_pairs += out[i] >= 0
    return n_pairs

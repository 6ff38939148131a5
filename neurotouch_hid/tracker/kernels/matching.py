"""Compiled loops that pair points and measure how far pairs have moved."""

import math

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.kernels.order_statistics import select
from neurotouch_hid.process.kernel_cache import kernel


@kernel
def sort_by_row(
    points_px: NDArray[np.float64],
) -> tuple[NDArray[np.int32], NDArray[np.int32], float]:
    """Returns the points in order of rows of 1 px.

    A counting sort: comparisons would cost mispredicted branches.

    Returns:
        (m,) int32 order and (rows + 1,) int32 begin: row i contains order[begin[i]:begin[i + 1]];
        the top of row 0, px.
    """
    m = len(points_px)
    top = points_px[:, 1].min() if m else 0.0
    n_rows = int(points_px[:, 1].max() - top) + 1 if m else 1
    begin, order = np.zeros(n_rows + 1, np.int32), np.empty(m, np.int32)
    filled = np.empty(n_rows, np.int32)
    for j in range(m):
        begin[int(points_px[j, 1] - top) + 1] += 1
    for row in range(n_rows):
        begin[row + 1] += begin[row]
        filled[row] = begin[row]
    for j in range(m):
        row = int(points_px[j, 1] - top)
        order[filled[row]] = j
        filled[row] += 1
    return order, begin, top


@kernel
def find_rows(above_px: float, below_px: float, begin: NDArray[np.int32]) -> tuple[int, int]:
    """Returns which part of the order lies in some rows, see ``sort_by_row``: first, and end.

    Args:
        above_px: of the first row, from the top of row 0.
        below_px: of the last row, likewise.
        begin: (rows + 1,) int32.
    """
    n_rows = len(begin) - 1
    if below_px >= 0.0 and above_px < n_rows:
        return begin[int(max(above_px, 0.0))], begin[int(min(below_px, n_rows - 1.0)) + 1]
    return 0, 0  # also where a point has no place


@kernel
def match_points(
    targets_px: NDArray[np.float64],
    points_px: NDArray[np.float64],
    gate_px: float,
    out: NDArray[np.int32],
) -> int:
    """Writes the index of each target's point, -1 if there is none, -2 if there is any doubt.

    In a pair each is the nearest to the other, and the target's second choice is twice as far.

    Args:
        targets_px: (n, 2) float64 px, columns x, y.
        points_px: (m, 2) float64 px.
        gate_px: distance limit.
        out: (n,) int32, written.

    Returns:
        The number of pairs.
    """
    n, m = len(targets_px), len(points_px)
    gate_px2, reach_px = gate_px * gate_px, 2.0 * gate_px
    near_px2 = np.full(m, gate_px2)
    nearest_px2 = np.empty(n)
    by_row, begin, top = sort_by_row(points_px)
    for i in range(n):
        best, best_px2, second_px2 = -1, np.inf, 4.0 * gate_px2
        x, y = targets_px[i, 0], targets_px[i, 1]
        first, last = find_rows(y - reach_px - top, y + reach_px - top, begin)
        for k in range(first, last):
            j = by_row[k]
            dx, dy = points_px[j, 0] - x, points_px[j, 1] - y
            px2 = dx * dx + dy * dy
            # Without branches: a processor cannot predict which point is nearer.
            closer = px2 < best_px2
            second_px2 = min(second_px2, best_px2 if closer else px2)
            best = j if closer else best
            best_px2 = px2 if closer else best_px2
            near_px2[j] = min(near_px2[j], px2)
        nearest_px2[i] = best_px2
        clear = 4.0 * best_px2 <= second_px2
        out[i] = -1 if best_px2 >= gate_px2 else best if clear else -2
    n_pairs = 0
    for i in range(n):
        if out[i] >= 0 and nearest_px2[i] > near_px2[out[i]]:
            out[i] = -2
        n_pairs += out[i] >= 0
    return n_pairs


@kernel
def pair_nearest(
    sites_px: NDArray[np.float64],
    points_px: NDArray[np.float64],
    gate_px: float,
    out: NDArray[np.intp],
) -> None:
    """Writes the index of each site's point, -1 if there is none.

    In a pair each is the nearest to the other; of equally near ones it is the first.

    Args:
        sites_px: (n, 2) float64 px, columns x, y.
        points_px: (m, 2) float64 px.
        gate_px: distance limit.
        out: (n,) intp, written.
    """
    n, m = len(sites_px), len(points_px)
    site, site_px = np.full(m, -1, np.intp), np.full(m, np.inf)  # the nearest of each point
    by_row, begin, top = sort_by_row(points_px)
    for i in range(n):
        best, best_px = -1, np.inf
        x, y = sites_px[i, 0], sites_px[i, 1]
        first, last = find_rows(y - gate_px - top, y + gate_px - top, begin)
        for k in range(first, last):
            j = by_row[k]
            px = math.hypot(points_px[j, 0] - x, points_px[j, 1] - y)
            if px < best_px or (px == best_px and j < best):
                best, best_px = j, px
            if px < site_px[j]:
                site[j], site_px[j] = i, px
        out[i] = best if best_px < gate_px else -1
    for i in range(n):
        if out[i] >= 0 and site[out[i]] != i:
            out[i] = -1


@kernel
def measure_sizes(
    before_px: NDArray[np.float64],
    now_px: NDArray[np.float64],
    match: NDArray[np.int32],
    n_pairs: int,
) -> NDArray[np.float64]:
    """Returns how far each paired point has moved, (n_pairs,) float64 px; see ``match_points``."""
    moved_px = np.empty(n_pairs)
    k = 0
    for i in range(len(before_px)):
        j = match[i]
        if j >= 0:
            dx, dy = now_px[j, 0] - before_px[i, 0], now_px[j, 1] - before_px[i, 1]
            moved_px[k] = math.sqrt(dx * dx + dy * dy)
            k += 1
    return moved_px


@kernel
def measure_largest(
    before_px: NDArray[np.float64],
    now_px: NDArray[np.float64],
    gate_px: float,
    n_left_out: int,
    match: NDArray[np.int32],
) -> tuple[int, float]:
    """Returns the number of pairs, and the largest motion of all but a few of them, px.

    Args:
        before_px: (n, 2) float64 px, columns x, y.
        now_px: (m, 2) float64 px.
        gate_px: distance limit of a pair; returned as the motion if there is no pair.
        n_left_out: the number of pairs that may have moved farther.
        match: (n,) int32, written, see ``match_points``.
    """
    n = match_points(before_px, now_px, gate_px, match)
    if not n:
        return 0, gate_px
    moved_px = measure_sizes(before_px, now_px, match, n)
    return n, select(moved_px, max(n - 1 - n_left_out, 0))


@kernel(error_model="numpy")
def measure_shared(
    before_px: NDArray[np.float64],
    now_px: NDArray[np.float64],
    gate_px: float,
    reach_px: float,
    least: float,
    most_px: float,
    match: NDArray[np.int32],
) -> tuple[int, float, float]:
    """Returns the number of pairs, and how far they have moved together, px.

    Noise moves each dot on its own, so the products of two neighbours' motions cancel in the mean.
    A gel moves neighbours alike, so the mean of these products is the square of that motion.

    Args:
        before_px: (n, 2) float64 px, columns x, y.
        now_px: (m, 2) float64 px.
        gate_px: distance limit of a pair.
        reach_px: dots up to this distance are neighbours.
        least: with fewer pairs, it does not matter what neighbours share.
        most_px: nor does it if all have moved farther together.
        match: (n,) int32, written, see ``match_points``.

    Returns:
        The number of pairs; the mean motion of all; the root mean square of what neighbours share
        beyond that, infinite where it does not matter. Both are ``gate_px`` if there is no pair.
    """
    n = match_points(before_px, now_px, gate_px, match)
    if not n:
        return 0, gate_px, gate_px
    place, moved, k = np.empty((n, 2)), np.empty((n, 2)), 0
    mean_x = mean_y = 0.0
    for i in range(len(before_px)):
        j = match[i]
        if j >= 0:
            for axis in range(2):
                place[k, axis] = before_px[i, axis]
                moved[k, axis] = now_px[j, axis] - before_px[i, axis]
            mean_x += moved[k, 0] / n
            mean_y += moved[k, 1] / n
            k += 1
    all_px = math.hypot(mean_x, mean_y)
    if n < least or all_px > most_px:
        return n, all_px, np.inf
    # Blobs come row by row: those before ``first`` are all too far up, ``lowest`` tells how far.
    lowest = place[:, 1].copy()
    for i in range(1, n):
        lowest[i] = max(lowest[i - 1], lowest[i])
    total, n_pairs, first = 0.0, 0, 0
    for i in range(n):
        while first > 0 and place[i, 1] - lowest[first - 1] < reach_px:
            first -= 1
        while place[i, 1] - lowest[first] >= reach_px:
            first += 1
        for j in range(first, i):
            dx, dy = place[i, 0] - place[j, 0], place[i, 1] - place[j, 1]
            if dx * dx + dy * dy < reach_px * reach_px:
                total += (moved[i, 0] - mean_x) * (moved[j, 0] - mean_x)
                total += (moved[i, 1] - mean_y) * (moved[j, 1] - mean_y)
                n_pairs += 1
    return n, all_px, math.sqrt(max(total / max(n_pairs, 1), 0.0))

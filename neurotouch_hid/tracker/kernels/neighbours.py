"""Compiled loops that compare markers with their neighbours."""

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.process.kernel_cache import kernel

CLOSEST_PX = 1.5  # two markers, each 2.5 px wide, are never so close: one follows the wrong events
LEFT_SHARE = 0.2  # beside a finger the gel moves at least half as much as under it [Mindlin]
LEFT_BEHIND = 4  # neighbours; three may be on the line between two fingers that move apart


@kernel
def _sort_rows(v: NDArray[np.float64]) -> None:
    """Sorts each column of ``v`` (8, m) float64 in place, by a network of 19 comparisons."""
    for p, q in (
        (0, 1), (2, 3), (4, 5), (6, 7), (0, 2), (1, 3), (4, 6), (5, 7), (1, 2), (5, 6),
        (0, 4), (3, 7), (1, 5), (2, 6), (1, 4), (3, 6), (2, 4), (3, 5), (3, 4),
    ):  # fmt: skip
        low, high = v[p], v[q]
        for i in range(v.shape[1]):
            a, b = low[i], high[i]
            low[i] = a if a < b else b
            high[i] = b if a < b else a


@kernel
def expect(
    position_px: NDArray[np.float64],
    usable: NDArray[np.bool_],
    rest_px: NDArray[np.float64],
    neighbours: NDArray[np.intp],
    expected_px: NDArray[np.float64],
    spread_px: NDArray[np.float64],
) -> None:
    """Writes where each marker should be: at rest plus its neighbours' median displacement.

    Args:
        position_px: (n, 2) float64 px, columns x, y.
        usable: (n,) bool, True for neighbours that count.
        rest_px: (n, 2) float64 px, the markers at rest.
        neighbours: (n, 8) intp, -1 where there is none.
        expected_px: (n, 2) float64 px, written; NaN where fewer than three neighbours count.
        spread_px: (n,) float64 px, written: half the distance between the quartiles of the
            neighbours' displacements, the larger of x and y.
    """
    n = len(position_px)
    moved_px, sorted_px, n_used = np.empty((n + 2, 2)), np.empty((8, 2 * n)), np.empty(n, np.int64)
    for i in range(n):
        moved_px[i, 0] = position_px[i, 0] - rest_px[i, 0]
        moved_px[i, 1] = position_px[i, 1] - rest_px[i, 1]
    moved_px[n], moved_px[n + 1] = np.inf, -np.inf
    for i in range(n):
        n_padded = 0
        for k in range(8):
            j = neighbours[i, k]
            if not (j >= 0 and usable[j]):  # infinities at both ends keep the median in the middle
                j = n + (n_padded & 1)
                n_padded += 1
            # x and y beside each other are moved at once; unsigned, see ``filter``.
            p, q = np.uint64(j), np.uint64(2 * i)
            sorted_px[k, q], sorted_px[k, q + np.uint64(1)] = moved_px[p, 0], moved_px[p, 1]
        n_used[i] = 8 - n_padded
    _sort_rows(sorted_px)
    for i in range(n):
        m = n_used[i]
        if m < 3:
            expected_px[i], spread_px[i] = np.nan, 0.0
            continue
        first = (8 - m) >> 1
        last = first + m - 1
        low, high, quarter = (first + last) >> 1, (first + last + 1) >> 1, m >> 2
        first, last, x, y = first + quarter, last - quarter, 2 * i, 2 * i + 1
        expected_px[i, 0] = rest_px[i, 0] + 0.5 * (sorted_px[low, x] + sorted_px[high, x])
        expected_px[i, 1] = rest_px[i, 1] + 0.5 * (sorted_px[low, y] + sorted_px[high, y])
        spread_x = 0.5 * (sorted_px[last, x] - sorted_px[first, x])
        spread_px[i] = max(spread_x, 0.5 * (sorted_px[last, y] - sorted_px[first, y]))


@kernel
def find_strays(
    position_px: NDArray[np.float64],
    expected_px: NDArray[np.float64],
    spread_px: NDArray[np.float64],
    max_stray_px: float,
    max_stray_ratio: float,
    out: NDArray[np.bool_],
) -> None:
    """Writes to ``out`` (n,) bool which markers are far from their expected places."""
    for i in range(len(position_px)):
        off = max(
            abs(position_px[i, 0] - expected_px[i, 0]), abs(position_px[i, 1] - expected_px[i, 1])
        )
        out[i] = off > max_stray_px + max_stray_ratio * spread_px[i]


@kernel
def find_collisions(
    position_px: NDArray[np.float64],
    expected_px: NDArray[np.float64],
    neighbours: NDArray[np.intp],
    out: NDArray[np.bool_],
) -> None:
    """Sets in ``out``, of two neighbours at one place, the one farther from its expected place."""
    for i in range(len(position_px)):
        for k in range(8):
            j = neighbours[i, k]
            if j <= i:  # none, or a pair that was seen from its other side
                continue
            dx = position_px[i, 0] - position_px[j, 0]
            dy = position_px[i, 1] - position_px[j, 1]
            if dx * dx + dy * dy < CLOSEST_PX * CLOSEST_PX:
                off_i = abs(position_px[i, 0] - expected_px[i, 0])
                off_i += abs(position_px[i, 1] - expected_px[i, 1])
                off_j = abs(position_px[j, 0] - expected_px[j, 0])
                off_j += abs(position_px[j, 1] - expected_px[j, 1])
                out[i if off_i > off_j else j] = True


@kernel
def find_tears(
    position_px: NDArray[np.float64],
    usable: NDArray[np.bool_],
    rest_px: NDArray[np.float64],
    neighbours: NDArray[np.intp],
    least_px: float,
    out: NDArray[np.bool_],
) -> None:
    """Sets in ``out`` the markers whose motion would tear the gel.

    The gel around a finger moves with it. A track that has moved far while its neighbours have not
    follows a wrong marker. So a patch of tracks that is one place off recovers from its corners.

    Args:
        position_px: (n, 2) float64 px, columns x, y.
        usable: (n,) bool, True for neighbours that count.
        rest_px: (n, 2) float64 px, the markers at rest.
        neighbours: (n, 8) intp, -1 where there is none.
        least_px: a smaller motion is never wrong.
        out: (n,) bool, set to True for such markers, else unchanged.
    """
    least_px2 = least_px * least_px
    for i in range(len(position_px)):
        x, y = position_px[i, 0] - rest_px[i, 0], position_px[i, 1] - rest_px[i, 1]
        moved_px2 = x * x + y * y
        if not moved_px2 > least_px2:
            continue
        limit_px2 = LEFT_SHARE * LEFT_SHARE * moved_px2
        n_used, n_left = 0, 0
        for k in range(8):
            j = neighbours[i, k]
            if j >= 0 and usable[j]:
                x, y = position_px[j, 0] - rest_px[j, 0], position_px[j, 1] - rest_px[j, 1]
                n_used += 1
                n_left += x * x + y * y < limit_px2
        if n_left >= LEFT_BEHIND and 2 * n_left > n_used:
            out[i] = True

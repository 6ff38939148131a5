"""The compiled loops of the neighbour check."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

CLOSEST_PX = 1.5  # of two markers, each 2.5 px wide: one of them follows the other one's events
LEFT_SHARE = 0.2  # beside a finger the gel moves by half as much as under it, and more [Mindlin]
LEFT_BEHIND = 4  # neighbours; three may lie on the line between two fingers that part


@njit(cache=True, nogil=True)
def _sort_rows(v: NDArray[np.float64]) -> None:
    """Sort the 8 rows of ``v`` (8, n) column by column: a network of 19 vector comparisons."""
    for p, q in (
        (0, 1), (2, 3), (4, 5), (6, 7), (0, 2), (1, 3), (4, 6), (5, 7), (1, 2), (5, 6),
        (0, 4), (3, 7), (1, 5), (2, 6), (1, 4), (3, 6), (2, 4), (3, 5), (3, 4),
    ):  # fmt: skip
        low, high = v[p], v[q]
        for i in range(v.shape[1]):
            a, b = low[i], high[i]
            low[i] = a if a < b else b
            high[i] = b if a < b else a


@njit(cache=True, nogil=True)
def expect(
    position_px: NDArray[np.float64],
    usable: NDArray[np.bool_],
    rest_px: NDArray[np.float64],
    neighbours: NDArray[np.intp],
    expected_px: NDArray[np.float64],
    spread_px: NDArray[np.float64],
) -> None:
    """Where each marker should be by its neighbours: rest plus their median displacement.

    Args:
        position_px: (n, 2) float64, columns x, y.
        usable: (n,) bool: neighbours that have a say.
        rest_px: (n, 2) float64, where the markers lie at rest.
        neighbours: (n, 8) intp, -1 where there is none.
        expected_px: (n, 2), filled in; NaN where fewer than three neighbours have a say.
        spread_px: (n,), filled in: half the distance between the quartiles of the neighbours'
            displacements, the larger one of x and y.
    """
    n = len(position_px)
    sorted_px = np.empty((8, n))
    count = np.zeros(n, np.int64)
    for axis in range(2):
        for i in range(n):
            n_used, n_padded = 0, 0
            for k in range(8):
                j = neighbours[i, k]
                if j >= 0 and usable[j]:
                    sorted_px[k, i] = position_px[j, axis] - rest_px[j, axis]
                    n_used += 1
                else:  # infinities at both ends keep the median in the middle
                    sorted_px[k, i] = np.inf if n_padded % 2 == 0 else -np.inf
                    n_padded += 1
            count[i] = n_used
        _sort_rows(sorted_px)
        for i in range(n):
            m = count[i]
            if m < 3:
                expected_px[i, axis], spread_px[i] = np.nan, 0.0
                continue
            first = (8 - m) // 2
            last = first + m - 1
            median = 0.5 * (
                sorted_px[(first + last) // 2, i] + sorted_px[(first + last + 1) // 2, i]
            )
            expected_px[i, axis] = rest_px[i, axis] + median
            spread = 0.5 * (sorted_px[last - m // 4, i] - sorted_px[first + m // 4, i])
            spread_px[i] = spread if axis == 0 else max(spread_px[i], spread)


@njit(cache=True, nogil=True)
def strays(
    position_px: NDArray[np.float64],
    expected_px: NDArray[np.float64],
    spread_px: NDArray[np.float64],
    max_stray_px: float,
    max_stray_ratio: float,
    out: NDArray[np.bool_],
) -> None:
    """Which markers are not where their neighbours say: out (n,) bool, filled in."""
    for i in range(len(position_px)):
        off = max(
            abs(position_px[i, 0] - expected_px[i, 0]), abs(position_px[i, 1] - expected_px[i, 1])
        )
        out[i] = off > max_stray_px + max_stray_ratio * spread_px[i]


@njit(cache=True, nogil=True)
def collide(
    position_px: NDArray[np.float64],
    expected_px: NDArray[np.float64],
    neighbours: NDArray[np.intp],
    out: NDArray[np.bool_],
) -> None:
    """Of two neighbours at one place, the one its own neighbours expect less is set in out (n,)."""
    for i in range(len(position_px)):
        for k in range(4, 8):  # each pair once
            j = neighbours[i, k]
            if j < 0:
                continue
            dx = position_px[i, 0] - position_px[j, 0]
            dy = position_px[i, 1] - position_px[j, 1]
            if dx * dx + dy * dy < CLOSEST_PX * CLOSEST_PX:
                off_i = abs(position_px[i, 0] - expected_px[i, 0])
                off_i += abs(position_px[i, 1] - expected_px[i, 1])
                off_j = abs(position_px[j, 0] - expected_px[j, 0])
                off_j += abs(position_px[j, 1] - expected_px[j, 1])
                out[i if off_i > off_j else j] = True


@njit(cache=True, nogil=True)
def tear(
    position_px: NDArray[np.float64],
    usable: NDArray[np.bool_],
    rest_px: NDArray[np.float64],
    neighbours: NDArray[np.intp],
    least_px: float,
    out: NDArray[np.bool_],
) -> None:
    """Markers whose motion would tear the gel are set in out (n,).

    The gel follows a finger far around it. A marker that has moved far while its neighbours have
    not follows another one: so a whole patch that sits one place off heals from its corners.

    Args:
        position_px: (n, 2) float64, columns x, y.
        usable: (n,) bool: neighbours that have a say.
        rest_px: (n, 2) float64, where the markers lie at rest.
        neighbours: (n, 8) intp, -1 where there is none.
        least_px: a marker that has moved less may have.
        out: (n,) bool, set for such markers, else left as it is.
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

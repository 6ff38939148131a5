"""The compiled loops that look for the marker of each event.

Where the markers are aimed at does not change between two checks of all tracks. So no event has to
wait for the ones before it, and the processor takes many at once.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX

TILE_PX = 4  # every tile lists the markers that its events may belong to
SHIFT = np.uint64(2)  # log2(TILE_PX)
BORDER = 4  # tiles around the sensor, so that a marker anywhere enters as many tiles
COLUMNS = -(-SENSOR_WIDTH_PX // TILE_PX) + 2 * BORDER
ROWS = -(-SENSOR_HEIGHT_PX // TILE_PX) + 2 * BORDER
ORIGIN = np.uint64(BORDER * COLUMNS + BORDER)  # the tile of pixel (0, 0)
SPAN = 4  # tiles that twice the reach may touch, along each axis
CAPACITY = 16  # markers within reach of a tile: as many as 3 px apart
GLANCE = 2  # so many are looked at in any case; one event in twenty has more of them near
REACH_PX = 4.5  # the largest gate, 3.5 px, and how far ON events lie ahead at most, 1 px
ON_X, ON_Y, OFF_X, OFF_Y = range(4)


@njit(cache=True, nogil=True)
def list_markers(
    aim_px: NDArray[np.float64],
    near: NDArray[np.uint16],
    n_near: NDArray[np.uint8],
    listed: NDArray[np.int64],
) -> None:
    """Enter every marker into the tiles whose events may belong to it.

    Args:
        aim_px: (n, 4) float64, where the ON and the OFF events of each marker are expected.
        near: (k, tiles) uint16, filled in: the markers of each tile. What stands behind the last
            one is older, and does no harm where it is taken for near. The first rows, all that
            most events need, fit into the nearest cache.
        n_near: (tiles,) uint8, filled in: their number.
        listed: (n, 4) int64, filled in: the first row and column of each marker's tiles, and how
            many there are; all 0 before the first time. While these stay the same, the lists do.
    """
    margin = BORDER * TILE_PX
    is_same = True
    for i in range(len(aim_px)):
        x = 0.5 * (aim_px[i, ON_X] + aim_px[i, OFF_X]) + margin
        y = 0.5 * (aim_px[i, ON_Y] + aim_px[i, OFF_Y]) + margin
        left = min(max(int((x - REACH_PX) / TILE_PX), 0), COLUMNS - SPAN)
        top = min(max(int((y - REACH_PX) / TILE_PX), 0), ROWS - SPAN)
        n_columns = min(int((x + REACH_PX) / TILE_PX) - left + 1, SPAN)
        n_rows = min(int((y + REACH_PX) / TILE_PX) - top + 1, SPAN)
        is_same &= (
            (listed[i, 0] == top)
            & (listed[i, 1] == left)
            & (listed[i, 2] == n_rows)
            & (listed[i, 3] == n_columns)
        )
        listed[i, 0], listed[i, 1], listed[i, 2], listed[i, 3] = top, left, n_rows, n_columns
    if is_same:
        return
    n_near[:] = 0
    for i in range(len(aim_px)):
        top, left, n_rows, n_columns = listed[i]
        for row in range(n_rows):
            for column in range(n_columns):
                tile = np.uint64((top + row) * COLUMNS + left + column)
                k = np.uint64(n_near[tile])
                if k < np.uint64(CAPACITY):
                    near[k, tile] = i
                    n_near[tile] = k + np.uint64(1)


@njit(cache=True, nogil=True, inline="always")
def nearest(
    x: int,
    y: int,
    on: bool,
    gate_px2: float,
    aim_px: NDArray[np.float64],
    near: NDArray[np.uint16],
    n_near: NDArray[np.uint8],
) -> tuple[np.uint64, float]:
    """The marker nearest to an event at pixel (x, y), and their squared distance (px²).

    If that is not less than the gate there is none, and the number means nothing.
    """
    # Unsigned: an index that may be negative would cost a test for each use.
    tile = (np.uint64(y) >> SHIFT) * np.uint64(COLUMNS) + (np.uint64(x) >> SHIFT) + ORIGIN
    side = np.uint64(ON_X if on else OFF_X)
    best, best_px2 = np.uint64(0), gate_px2
    for k in range(GLANCE):
        i = np.uint64(near[k, tile])
        dx, dy = x - aim_px[i, side], y - aim_px[i, side + np.uint64(1)]
        px2 = dx * dx + dy * dy
        closer = px2 < best_px2
        best = i if closer else best
        best_px2 = px2 if closer else best_px2
    for k in range(GLANCE, n_near[tile]):
        i = np.uint64(near[k, tile])
        dx, dy = x - aim_px[i, side], y - aim_px[i, side + np.uint64(1)]
        px2 = dx * dx + dy * dy
        closer = px2 < best_px2
        best = i if closer else best
        best_px2 = px2 if closer else best_px2
    return best, best_px2


@njit(cache=True, nogil=True, inline="always")
def nearest_of_all(
    x: int, y: int, on: bool, gate_px2: float, aim_px: NDArray[np.float64]
) -> tuple[np.uint64, float]:
    """The same without lists: the plain way that they are measured against."""
    side = np.uint64(ON_X if on else OFF_X)
    best, best_px2 = np.uint64(0), gate_px2
    for k in range(len(aim_px)):
        i = np.uint64(k)
        dx, dy = x - aim_px[i, side], y - aim_px[i, side + np.uint64(1)]
        px2 = dx * dx + dy * dy
        closer = px2 < best_px2
        best = i if closer else best
        best_px2 = px2 if closer else best_px2
    return best, best_px2


@njit(cache=True, nogil=True)
def assign(
    events: NDArray[np.void],
    start: int,
    stop: int,
    gate_px: float,
    of_all: bool,
    aim_px: NDArray[np.float64],
    near: NDArray[np.uint16],
    n_near: NDArray[np.uint8],
    taken: NDArray[np.int64],
    owner: NDArray[np.uint16],
) -> int:
    """Find the marker of each event from ``start`` to ``stop``.

    Args:
        events: (m,) EVENT_DTYPE.
        start: the first event.
        stop: the event after the last one, at most ``len(taken)`` further.
        gate_px: an event farther from every marker belongs to none.
        of_all: look among all markers, not in the lists.
        aim_px: see ``list_markers``, as ``near`` and ``n_near``.
        near: the lists.
        n_near: their lengths.
        taken: (k,) int64, filled in: the events that belong to a marker.
        owner: (k,) uint16, filled in: the marker of each of them.

    Returns:
        Their number.
    """
    gate_px2 = gate_px * gate_px
    n = np.uint64(0)
    for k in range(start, stop):
        e = events[np.uint64(k)]
        if of_all:
            i, px2 = nearest_of_all(e.x, e.y, e.p, gate_px2, aim_px)
        else:
            i, px2 = nearest(e.x, e.y, e.p, gate_px2, aim_px, near, n_near)
        taken[n], owner[n] = k, i
        n += np.uint64(px2 < gate_px2)
    return int(n)


@njit(cache=True, nogil=True)
def find_event(events: NDArray[np.void], start: int, until_us: int) -> int:
    """The index of the first event from ``start`` on that is not before ``until_us``."""
    low, high = start, len(events)
    while low < high:
        middle = (low + high) >> 1
        if events[np.uint64(middle)].t < until_us:
            low = middle + 1
        else:
            high = middle
    return low

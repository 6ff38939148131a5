"""Compiled loops that find the marker of each event.

The expected places of events do not change between two checks. So no event has to wait for the ones
before it, and the processor takes several at once.
"""

from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX
from neurotouch_hid.process.kernel_cache import kernel

TILE_PX = 4  # every tile lists the markers that its events may belong to
SHIFT = np.uint64(2)  # log2(TILE_PX)
BORDER = 4  # tiles around the sensor, so that a marker at its edge enters as many tiles as others
COLUMNS = -(-SENSOR_WIDTH_PX // TILE_PX) + 2 * BORDER
ROWS = -(-SENSOR_HEIGHT_PX // TILE_PX) + 2 * BORDER
ORIGIN = np.uint64(BORDER * COLUMNS + BORDER)  # the tile of pixel (0, 0)
SPAN = 4  # tiles that twice the reach may touch, along each axis
CAPACITY = 16  # markers within reach of a tile, for markers 3 px apart
FIRST = 2  # markers compared without a test; one event in twenty has more of them near
REACH_PX = 4.75  # the largest gate, 3.5 px, plus the longest lead of events, 1.25 px

PLACE: Final = np.dtype([("top", "i8"), ("left", "i8"), ("n_rows", "i8"), ("n_columns", "i8")])
"""The tiles in which a marker is listed: the first row and column, and how many there are."""

PAIR: Final = np.dtype([("event", "u4"), ("marker", "u4")])
"""An event and the marker that it belongs to, by their indices."""


class Targets(NamedTuple):
    """Expected places of the events of n markers, and the markers near each tile.

    Attributes:
        aim_px: (n, 2, 2) float64, where the OFF and the ON events of each marker are expected, by
            polarity 0 and 1; columns x, y.
        near: (CAPACITY, tiles) uint16, the markers that the events of a tile may belong to. Entries
            after the last one are old; comparing them does no harm. The first rows, all that most
            events need, fit into the nearest cache.
        n_near: (tiles,) uint8, their number.
        listed: (n,) ``PLACE``, all 0 at first. The lists change only if these change.
    """

    aim_px: NDArray[np.float64]
    near: NDArray[np.uint16]
    n_near: NDArray[np.uint8]
    listed: NDArray[np.void]


@kernel
def list_markers(targets: Targets) -> None:
    """Enters every marker into the tiles whose events may belong to it.

    Only markers that have left their tiles are entered again. Each tile lists them in their order.

    Args:
        targets: ``aim_px`` is read, all else is updated.
    """
    aim_px, near, n_near, listed = targets
    margin = BORDER * TILE_PX
    is_full = False
    for i in range(len(aim_px)):
        x = 0.5 * (aim_px[i, 1, 0] + aim_px[i, 0, 0]) + margin
        y = 0.5 * (aim_px[i, 1, 1] + aim_px[i, 0, 1]) + margin
        left = min(max(int((x - REACH_PX) / TILE_PX), 0), COLUMNS - SPAN)
        top = min(max(int((y - REACH_PX) / TILE_PX), 0), ROWS - SPAN)
        n_columns = min(int((x + REACH_PX) / TILE_PX) - left + 1, SPAN)
        n_rows = min(int((y + REACH_PX) / TILE_PX) - top + 1, SPAN)
        place = listed[i]
        is_same = (
            (place.top == top)
            & (place.left == left)
            & (place.n_rows == n_rows)
            & (place.n_columns == n_columns)
        )
        if is_same:
            continue
        is_full |= _leave(i, place, near, n_near)
        place.top, place.left, place.n_rows, place.n_columns = top, left, n_rows, n_columns
        is_full |= _enter(i, place, near, n_near)
    if is_full:  # a full tile does not know which markers found no place in it
        n_near[:] = 0
        for i in range(len(aim_px)):
            _enter(i, listed[i], near, n_near)


@kernel(inline="always")
def _leave(i: int, place: Any, near: NDArray[np.uint16], n_near: NDArray[np.uint8]) -> bool:
    """Removes a marker from its tiles; returns True if one of them was full."""
    is_full = False
    for row in range(place.top, place.top + place.n_rows):
        for column in range(place.left, place.left + place.n_columns):
            tile = np.uint64(row * COLUMNS + column)
            n = n_near[tile]
            is_full |= n == CAPACITY
            found = False
            for k in range(n):
                found |= near[np.uint64(k), tile] == i
                if found and k + 1 < n:
                    near[np.uint64(k), tile] = near[np.uint64(k + 1), tile]
            n_near[tile] = n - found
    return is_full


@kernel(inline="always")
def _enter(i: int, place: Any, near: NDArray[np.uint16], n_near: NDArray[np.uint8]) -> bool:
    """Enters a marker into its tiles, before those of larger number; True if one was full."""
    is_full = False
    for row in range(place.top, place.top + place.n_rows):
        for column in range(place.left, place.left + place.n_columns):
            tile = np.uint64(row * COLUMNS + column)
            k = np.int64(n_near[tile])
            if k == CAPACITY:
                is_full = True
                continue
            n_near[tile] = k + 1
            while k > 0 and near[np.uint64(k - 1), tile] > i:
                near[np.uint64(k), tile] = near[np.uint64(k - 1), tile]
                k -= 1
            near[np.uint64(k), tile] = i
    return is_full


@kernel(inline="always")
def nearest(x: int, y: int, on: bool, gate_px2: float, targets: Targets) -> tuple[np.uint64, float]:
    """Returns the marker nearest to an event at pixel (x, y), and their squared distance, px².

    If the distance is not below the gate, there is none, and the number has no meaning.
    """
    aim_px, near, n_near = targets.aim_px, targets.near, targets.n_near
    # Unsigned: an index that may be negative would cost a test for each use.
    tile = (np.uint64(y) >> SHIFT) * np.uint64(COLUMNS) + (np.uint64(x) >> SHIFT) + ORIGIN
    polarity = np.uint64(on)
    best, best_px2 = np.uint64(0), gate_px2
    for k in range(FIRST):
        i = np.uint64(near[k, tile])
        dx, dy = x - aim_px[i, polarity, 0], y - aim_px[i, polarity, 1]
        px2 = dx * dx + dy * dy
        closer = px2 < best_px2
        best = i if closer else best
        best_px2 = px2 if closer else best_px2
    for k in range(FIRST, n_near[tile]):
        i = np.uint64(near[k, tile])
        dx, dy = x - aim_px[i, polarity, 0], y - aim_px[i, polarity, 1]
        px2 = dx * dx + dy * dy
        closer = px2 < best_px2
        best = i if closer else best
        best_px2 = px2 if closer else best_px2
    return best, best_px2


@kernel(inline="always")
def nearest_of_all(
    x: int, y: int, on: bool, gate_px2: float, aim_px: NDArray[np.float64]
) -> tuple[np.uint64, float]:
    """Returns the same without lists, the plain way that they are measured against."""
    polarity = np.uint64(on)
    best, best_px2 = np.uint64(0), gate_px2
    for k in range(len(aim_px)):
        i = np.uint64(k)
        dx, dy = x - aim_px[i, polarity, 0], y - aim_px[i, polarity, 1]
        px2 = dx * dx + dy * dy
        closer = px2 < best_px2
        best = i if closer else best
        best_px2 = px2 if closer else best_px2
    return best, best_px2


@kernel
def assign(
    events: NDArray[np.void],
    start: int,
    stop: int,
    gate_px: float,
    of_all: bool,
    targets: Targets,
    pairs: NDArray[np.void],
) -> int:
    """Finds the marker of each event from ``start`` to ``stop``.

    Args:
        events: (m,) EVENT_DTYPE.
        start: the first event.
        stop: the event after the last one, at most ``len(pairs)`` further.
        gate_px: an event farther from every marker belongs to none.
        of_all: search all markers instead of the lists.
        targets: where events are expected.
        pairs: (k,) ``PAIR``, written: the events that belong to a marker.

    Returns:
        The number of pairs.
    """
    gate_px2 = gate_px * gate_px
    n = np.uint64(0)
    for k in range(start, stop):
        e = events[np.uint64(k)]
        if of_all:
            i, px2 = nearest_of_all(e.x, e.y, e.p, gate_px2, targets.aim_px)
        else:
            i, px2 = nearest(e.x, e.y, e.p, gate_px2, targets)
        pairs[n].event, pairs[n].marker = k, i
        n += np.uint64(px2 < gate_px2)
    return int(n)


@kernel
def find_event(events: NDArray[np.void], start: int, until_us: int) -> int:
    """Returns the index of the first event from ``start`` on that is not before ``until_us``."""
    low, high = start, len(events)
    while low < high:
        middle = (low + high) >> 1
        if events[np.uint64(middle)].t < until_us:
            low = middle + 1
        else:
            high = middle
    return low

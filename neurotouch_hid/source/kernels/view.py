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
    at: NDArray[np.int32],
    share: NDArray[np.uint16],
    pairs: NDArray[np.uint16],
    ends: NDArray[np.uint16],
    out: NDArray[np.uint8],
) -> None:
    """Writes a picture whose pixels lie between those of another.

    A pixel and the one right of it are read at once, and a row is read before it is computed, eight
    pixels and more in one instruction: a quarter of the time.

    Args:
        pixels: (h, w) uint8.
        at: (height, width) int32, the pixel up and left of each point, ``y * w + x``. It is in
            neither the last row nor the last column.
        share: (2, height, width) uint16, weight of the pixel right of it and below it, 0 to
            ``ONE``.
        pairs: (h, w) uint16 scratch.
        ends: (2, width) uint16 scratch.
        out: (height, width) uint8, written.
    """
    for y in range(pixels.shape[0]):
        row, pair = pixels[y], pairs[y]
        for x in range(len(row) - 1):
            pair[x] = np.uint16(row[x]) | np.uint16(row[x + 1]) << np.uint16(8)
    words, below_it = pairs.ravel(), np.uintp(pairs.shape[1])
    upper, lower, half = ends[0], ends[1], np.int32(ONE * ONE // 2)
    for y in range(out.shape[0]):
        places, right, below, line = at[y], share[0, y], share[1, y], out[y]
        for x in range(len(line)):
            place = np.uintp(places[x])  # an unsigned index cannot count from the end
            upper[x], lower[x] = words[place], words[place + below_it]
        for x in range(len(line)):
            a, b = np.int32(upper[x]), np.int32(lower[x])
            left_a, left_b = a & 0xFF, b & 0xFF
            above = left_a * ONE + ((a >> 8) - left_a) * np.int32(right[x])
            under = left_b * ONE + ((b >> 8) - left_b) * np.int32(right[x])
            total = above * ONE + (under - above) * np.int32(below[x])
            line[x] = (total + half) // (ONE * ONE)


NOWHERE = -1
"""In a table of columns or rows: the pixel has no place in the canonical picture."""


@kernel
def map_events(
    events: NDArray[np.void],
    shift_us: int,
    last_us: int,
    columns: NDArray[np.int16],
    rows: NDArray[np.int16],
    sums: NDArray[np.int16],
    out: NDArray[np.void],
) -> tuple[int, int, int]:
    """Brings events to the canonical picture, in which a pixel may stand for several of the sensor.

    Each canonical pixel sums up the signs of its events. It fires once the sum is half of its area
    off, and then has the whole area less: an edge that crosses it makes as many events as it makes
    in one pixel of the sensor, when it is in the middle. With an area of 1 all events stay.

    Args:
        events: (n,) records with ``t``, ``x``, ``y`` and ``p``.
        shift_us: is added to the times.
        last_us: no event is older; those that are get this time.
        columns: (h, w) int16 of each pixel of the sensor, or ``NOWHERE``; (1, w) if it is the same
            in all rows. Such small tables stay in the processor's cache.
        rows: (h, w) int16 likewise; (h, 1) if it is the same in all columns.
        sums: (height, width, 2) int16: the sum of each canonical pixel, carried from call to call,
            and its area in pixels of the sensor.
        out: (n,) EVENT_DTYPE or longer, written.

    Returns:
        The number of events written, the last time, and the number of times that went back.
    """
    height, width = rows.shape[0], columns.shape[1]
    down, across = columns.shape[0] > 1, rows.shape[1] > 1
    n = n_back = 0
    for i in range(len(events)):
        event = events[i]
        t = int(event.t) + shift_us
        if t < last_us:
            t = last_us
            n_back += 1
        last_us = t
        x, y = np.int64(event.x), np.int64(event.y)
        if x >= width or y >= height:
            continue
        column, row = columns[y * down, x], rows[y, x * across]
        if column < 0 or row < 0:
            continue
        total, area = sums[row, column, 0], sums[row, column, 1]
        if event.p:
            total += 1
            fires = 2 * total >= area
            sums[row, column, 0] = total - area if fires else total
        else:
            total -= 1
            fires = 2 * total <= -area
            sums[row, column, 0] = total + area if fires else total
        if fires:
            mapped = out[n]
            mapped.t, mapped.x, mapped.y, mapped.p = t, column, row, event.p
            n += 1
    return n, last_us, n_back

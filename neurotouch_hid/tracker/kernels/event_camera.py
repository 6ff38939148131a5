"""Compiled loops that turn events into pictures."""

import math

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX
from neurotouch_hid.process.kernel_cache import kernel

BLACK_DN = 16.0  # of a picture, where there is no marker
HOT = 3.0  # events by which a single pixel may differ from all around it


@kernel
def add_events(events: NDArray[np.void], net: NDArray[np.float32]) -> None:
    """Adds the polarities of events.

    Args:
        events: (m,) EVENT_DTYPE.
        net: (260, 346) float32, how much brighter each pixel is than at first, in events; updated.
    """
    for k in range(len(events)):
        e = events[np.uint64(k)]
        net[np.uint64(e.y), np.uint64(e.x)] += np.float32(1.0) if e.p else np.float32(-1.0)


@kernel(fastmath=True)
def smooth(picture: NDArray[np.float32], out: NDArray[np.float32]) -> None:
    """Writes a picture without hot pixels, smoothed by a binomial window of 3 x 3.

    The border becomes 0.
    """
    height, width = picture.shape
    most, two, sixteenth = np.float32(HOT), np.float32(2.0), np.float32(0.0625)
    clean = np.zeros((height, width), np.float32)
    for y in range(1, height - 1):
        for x in range(1, width - 1):
            north, south = picture[y - 1, x], picture[y + 1, x]
            west, east = picture[y, x - 1], picture[y, x + 1]
            low = min(north, south, west, east) - most
            high = max(north, south, west, east) + most
            clean[y, x] = min(max(picture[y, x], low), high)
    rows = np.empty(width, np.float32)
    out[:] = 0.0
    for y in range(1, height - 1):
        for x in range(width):
            rows[x] = clean[y - 1, x] + two * clean[y, x] + clean[y + 1, x]
        for x in range(1, width - 1):
            out[y, x] = (rows[x - 1] + two * rows[x] + rows[x + 1]) * sixteenth


@kernel(fastmath=True)
def expose(
    change: NDArray[np.float32],
    rest: NDArray[np.float32],
    log_per_event: float,
    out: NDArray[np.uint8],
) -> None:
    """Writes the picture that a camera would take now.

    Args:
        change: (260, 346) float32, how much brighter each pixel is than at rest, in events.
        rest: (260, 346) float32, how much brighter each pixel is at rest than the gel without
            markers, in events.
        log_per_event: the logarithm of the brightness that an event stands for.
        out: (260, 346) uint8, written.
    """
    for y in range(change.shape[0]):
        for x in range(change.shape[1]):
            events = change[y, x] + rest[y, x]
            level = BLACK_DN
            if abs(events) > 0.5:
                level *= math.exp(log_per_event * events)
            out[y, x] = np.uint8(min(level, 255.0))


@kernel
def draw_rest(
    position_px: NDArray[np.float64],
    sigma_px: float,
    ratio: float,
    log_per_event: float,
    out: NDArray[np.float32],
) -> None:
    """Draws markers at rest as Gaussian spots; see ``expose`` for the unit.

    Args:
        position_px: (n, 2) float64 px.
        sigma_px: of a spot.
        ratio: how much brighter than black the middle of a spot is.
        log_per_event: see ``expose``.
        out: (260, 346) float32, written.
    """
    out[:] = 0.0
    reach = math.ceil(4.0 * sigma_px)
    for i in range(len(position_px)):
        cx, cy = position_px[i]
        x0, y0 = round(cx), round(cy)
        for y in range(max(y0 - reach, 0), min(y0 + reach + 1, SENSOR_HEIGHT_PX)):
            for x in range(max(x0 - reach, 0), min(x0 + reach + 1, SENSOR_WIDTH_PX)):
                away2 = ((x - cx) ** 2 + (y - cy) ** 2) / (sigma_px * sigma_px)
                spot = math.log1p(ratio * math.exp(-0.5 * away2)) / log_per_event
                out[y, x] = max(out[y, x], spot)

"""Finds dots that have moved by a fraction of their size, in the changes that events tell.

Such a dot is brighter ahead and darker behind, by an event or two on each side: each side alone is
noise, but both together are not.
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

SIGMA_PX: Final = 1.3  # standard deviation of a blurred dot
REACH_PX: Final = 5
CLEAR: Final = 5.0  # times the noise; at 4, a fifth of the spots is noise, at 5 hardly any
APART_PX: Final = 4.5  # dots are farther apart; nearer spots are parts of one
RAYLEIGH: Final = 1.177  # the median of the length of a random vector, in standard deviations

_AWAY = np.arange(-REACH_PX, REACH_PX + 1.0)
_DOT = np.exp(-0.5 * (_AWAY / SIGMA_PX) ** 2)
_DOT /= _DOT.sum()
_SLOPE = _AWAY / SIGMA_PX**2 * _DOT


def find_faint_spots(
    change: NDArray[np.float32], known_px: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Returns the middles of dots that have moved a little, (m, 2) float64 px, columns x, y.

    Args:
        change: (260, 346) float32, how much brighter each pixel has become, in events.
        known_px: (k, 2) float64 px, spots of dots that have moved farther; none is returned near.
    """
    # A dot that moves changes the picture by the slope of its brightness in this direction.
    size = np.hypot(_filter(change, _SLOPE, _DOT), _filter(change, _DOT, _SLOPE))
    noise = float(np.median(size)) / RAYLEIGH
    middle = np.zeros(size.shape, np.bool_)
    middle[REACH_PX + 1 : -REACH_PX - 1, REACH_PX + 1 : -REACH_PX - 1] = True
    middle &= size > CLEAR * noise
    reach = int(APART_PX)
    for dy in range(-reach, reach + 1):
        for dx in range(-reach, reach + 1):
            if 0 < dx * dx + dy * dy <= APART_PX * APART_PX:
                middle &= size >= np.roll(size, (dy, dx), (0, 1))
    y, x = np.nonzero(middle)
    position_px = np.stack([x, y], axis=1).astype(np.float64)
    for axis, (dx, dy) in enumerate(((1, 0), (0, 1))):  # the top of a parabola through three pixels
        before, here, after = size[y - dy, x - dx], size[y, x], size[y + dy, x + dx]
        position_px[:, axis] += (
            0.5 * (before - after) / np.minimum(before - 2 * here + after, -1e-9)
        )
    if not (len(position_px) and len(known_px)):
        return position_px
    apart_px = position_px[:, None] - known_px[None]
    nearest_px = np.hypot(apart_px[..., 0], apart_px[..., 1]).min(axis=1)
    alone_px: NDArray[np.float64] = position_px[nearest_px > APART_PX]
    return alone_px


def _filter(
    picture: NDArray[np.float32], along_x: NDArray[np.float64], along_y: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Returns the correlation of a picture with two windows; it wraps around at the border."""
    rows = np.zeros(picture.shape)
    for k, weight in enumerate(along_x):
        rows += weight * np.roll(picture, REACH_PX - k, 1)
    out = np.zeros(picture.shape)
    for k, weight in enumerate(along_y):
        out += weight * np.roll(rows, REACH_PX - k, 0)
    return out

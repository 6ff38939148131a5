"""Measures how sharp the dots of a frame are."""

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import PAPER_GEL, Gel
from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX
from neurotouch_hid.tracker.blobs import Blobs

_MOST_DOTS: Final = 40
_GAUSSIAN: Final = 4.355  # area above half of the height of a Gaussian, in variances
_LEAST_PX, _LEAST_MM = 1.5, 0.6  # a dot that is blurred by more than both is out of focus


def measure_blur(
    pixels: NDArray[np.uint8], blobs: Blobs, px_per_mm: float, gel: Gel = PAPER_GEL
) -> float | None:
    """Returns the standard deviation of the point spread, px, to a tenth; None without dots.

    The area above half of a dot's height tells its width; a sharp dot has a known one.

    Args:
        pixels: (260, 346) uint8.
        blobs: its bright dots.
        px_per_mm: scale of the image.
        gel: the gel.
    """
    pixels = gel.lighten(pixels)
    reach = max(round(0.45 * gel.pitch_mm * px_per_mm), 2)
    step = np.arange(-reach, reach + 1)
    near = np.hypot(*np.meshgrid(step, step)) <= reach
    x, y = np.rint(blobs.centroid_px).astype(np.intp).T
    within = (x >= reach) & (x < SENSOR_WIDTH_PX - reach)
    within &= (y >= reach) & (y < SENSOR_HEIGHT_PX - reach)
    chosen = np.flatnonzero(within)
    chosen = chosen[:: max(len(chosen) // _MOST_DOTS, 1)]
    if not len(chosen):
        return None
    rows, columns = y[chosen][:, None, None] + step[:, None], x[chosen][:, None, None] + step
    # Of one dot the noise would be too large, and some dots are reflections, which are sharp.
    dots = np.sort(pixels[rows, columns][:, near], axis=0)
    dot = dots[len(dots) // 4 : len(dots) - len(dots) // 4].mean(axis=0)
    area = float((dot > 0.5 * (dot.min() + dot.max())).sum())
    sharp = math.pi / 4.0 * (gel.dot_mm * px_per_mm) ** 2
    return round(math.sqrt(max(area - sharp, 0.0) / _GAUSSIAN), 1)


def is_blurred(blur_px: float | None, px_per_mm: float) -> bool:
    """Returns whether dots are so blurred that the lens is out of focus."""
    return blur_px is not None and blur_px > max(_LEAST_PX, _LEAST_MM * px_per_mm)

"""Measures how sharp the dots of a frame are."""

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import PAPER_GEL, Gel
from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX, GelProblem
from neurotouch_hid.tracker.blobs import Blobs, lighten
from neurotouch_hid.tracker.kernels.dots import draw_usual

_MOST_DOTS: Final = 40
_GAUSSIAN: Final = 4.355  # area above half of the height of a Gaussian, in variances
_LEAST_PX, _LEAST_MM = 1.5, 0.6  # a dot that is blurred by more than both is out of focus
_WHITE_DN: Final = 230.0  # many webcams send white as 235, and compression makes it uneven


class Sharpness(NamedTuple):
    """The sharpness of dots.

    Attributes:
        blur_px: standard deviation of the point spread, px, to a tenth; None without dots.
        problem: BLURRED, or BRIGHT if dots are as wide only because they are saturated.
    """

    blur_px: float | None
    problem: GelProblem


def measure_sharpness(
    pixels: NDArray[np.uint8], blobs: Blobs, px_per_mm: float, gel: Gel = PAPER_GEL
) -> Sharpness:
    """Returns how sharp dots are.

    The area above half of a dot's height tells its width; a sharp dot has a known one. Of a
    saturated dot the top is missing, and what is left grows. If it is a Gaussian, the area between
    half of the height and the top is the same however much is missing.

    Args:
        pixels: (260, 346) uint8.
        blobs: its bright dots.
        px_per_mm: scale of the image.
        gel: the gel.
    """
    reach = max(round(0.45 * gel.pitch_mm * px_per_mm), 2)
    x, y = np.rint(blobs.centroid_px).astype(np.intp).T
    within = (x >= reach) & (x < SENSOR_WIDTH_PX - reach)
    within &= (y >= reach) & (y < SENSOR_HEIGHT_PX - reach)
    chosen = np.flatnonzero(within)
    chosen = chosen[:: max(len(chosen) // _MOST_DOTS, 1)]
    if not len(chosen):
        return Sharpness(None, GelProblem.NONE)
    dot = draw_usual(lighten(pixels, gel), x[chosen], y[chosen], reach)
    area = float((dot > 0.5 * (dot.min() + dot.max())).sum())
    sharp = math.pi / 4.0 * (gel.dot_mm * px_per_mm) ** 2
    saturated = float((dot >= _WHITE_DN).sum()) if gel.light else 0.0  # black is no lack of light
    width_px, blur_px = (
        round(math.sqrt(max(each - sharp, 0.0) / _GAUSSIAN), 1) for each in (area, area - saturated)
    )
    if is_blurred(blur_px, px_per_mm):
        return Sharpness(blur_px, GelProblem.BLURRED)
    is_wide = is_blurred(width_px, px_per_mm)
    return Sharpness(blur_px, GelProblem.BRIGHT if is_wide else GelProblem.NONE)


def is_blurred(blur_px: float | None, px_per_mm: float) -> bool:
    """Returns whether dots are so blurred that the lens is out of focus."""
    return blur_px is not None and blur_px > max(_LEAST_PX, _LEAST_MM * px_per_mm)

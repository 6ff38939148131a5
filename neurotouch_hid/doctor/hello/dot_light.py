"""Measures how bright dots and gel are, whatever the blur of the lens."""

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import Gel

_REACH: Final = 0.4
"""Of the pitch: all light of a dot is within."""
_GROUND: Final = 0.5
"""Of the pitch: between this and the reach there is only gel."""
_LEAST_DOTS: Final = 10


class DotLight(NamedTuple):
    """Grey levels of a picture.

    Attributes:
        dot_dn: of a dot over the gel, as a sharp disc of the size that the gel's file says.
        ground_dn: of the gel between the dots.
        peak_dn: of the brightest pixel of a dot, over the gel; the less, the more it is blurred.
    """

    dot_dn: float
    ground_dn: float
    peak_dn: float


def measure_dot_light(
    picture: NDArray[np.floating], places_px: NDArray[np.floating], px_per_mm: float, gel: Gel
) -> DotLight | None:
    """Returns how bright dots and gel are; None of dark dots, or if too few are in the picture.

    Blur moves the light of a dot and leaves its sum. So the sum is measured, over the gel's grey
    beside it, and divided by the area of a sharp dot.

    Args:
        picture: (260, 346), grey levels.
        places_px: (n, 2) px, the dots; NaN of one that is not seen.
        px_per_mm: scale.
        gel: the gel.
    """
    pitch_px = gel.pitch_mm * px_per_mm
    margin = math.ceil(_GROUND * pitch_px)
    step = np.arange(-margin, margin + 1)
    height, width = picture.shape
    dots, grounds, peaks = [], [], []
    for x, y in places_px[np.isfinite(places_px).all(axis=1)]:
        column, row = round(float(x)), round(float(y))
        if not (margin <= column < width - margin and margin <= row < height - margin):
            continue
        part = picture[row - margin : row + margin + 1, column - margin : column + margin + 1]
        far = np.hypot(*np.meshgrid(column + step - x, row + step - y)) / pitch_px
        ground = float(np.median(part[(far >= _REACH) & (far < _GROUND)]))
        grounds.append(ground)
        dots.append(float((part[far < _REACH] - ground).sum()))
        peaks.append(float(part[far < _REACH].max()) - ground)
    if len(dots) < _LEAST_DOTS or not gel.light:
        return None
    area = math.pi * (0.5 * gel.dot_mm * px_per_mm) ** 2
    dot, ground, peak = (float(np.median(each)) for each in (dots, grounds, peaks))
    return DotLight(dot / area, ground, peak)

"""Finds glare on a gel: spots brighter than its dots, and gel that is bright itself."""

import math
from collections.abc import Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import Gel, fit_rig
from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX
from neurotouch_hid.tracker.blobs import Blobs
from neurotouch_hid.tracker.diagnosis import find_glints
from neurotouch_hid.tracker.lattice import Lattice

_MOST_GLARE: Final = 0.3
"""Share of the way from gel to dot that the gel's grey may have anywhere."""
_GREY_REACH: Final = (0.38, 0.5)
"""Between these distances from a dot, in pitches, there is only gel."""
_SIDES: Final = (
    "on the right",
    "at the bottom right",
    "at the bottom",
    "at the bottom left",
    "on the left",
    "at the top left",
    "at the top",
    "at the top right",
)


def find_glare(
    pixels: NDArray[np.uint8], blobs: Blobs, lattice: Lattice, gel: Gel
) -> NDArray[np.float64]:
    """Returns the places of glare, (n, 2) float64 px.

    Args:
        pixels: a frame, (260, 346) uint8.
        blobs: the dots in it.
        lattice: which of them belong to the gel.
        gel: the gel in it.
    """
    spots = find_glints(pixels, blobs, lattice.blob, gel)
    places = blobs.centroid_px[spots]
    if len(spots) <= 2:  # one or two may be dots that are a little better than others
        places = places[:0]
    return np.concatenate([places, _find_bright_gel(gel.lighten(pixels), lattice, gel)])


def name_sides(off_px: NDArray[np.float64], reach_px: float) -> list[str]:
    """Returns where in the picture something is, seen from the middle of the gel; most first.

    Args:
        off_px: (n, 2) float64 px, from the middle of the gel.
        reach_px: radius of the gel.
    """
    names = [_name_side(off, reach_px) for off in off_px]
    return sorted(set(names), key=lambda name: (-names.count(name), name))


def _find_bright_gel(pixels: NDArray[np.uint8], lattice: Lattice, gel: Gel) -> NDArray[np.float64]:
    """Returns the places of markers, (n, 2) px, around which the gel itself is bright."""
    pitch_px = gel.pitch_mm * fit_rig(lattice.position_px, gel).px_per_mm
    places = lattice.position_px
    grey = np.array(list(_measure_grey(pixels, places, pitch_px)))
    peak = float(np.percentile(pixels, 99.5))
    usual = float(np.nanmedian(grey))
    # A gel that is bright everywhere is compared with the dark beyond it.
    low = min(usual, float(np.percentile(pixels, 25.0)))
    is_bright = grey - low > max(_MOST_GLARE * (peak - low), 8.0)
    return places[is_bright]


def _measure_grey(
    pixels: NDArray[np.uint8], places: NDArray[np.float64], pitch_px: float
) -> Iterator[float]:
    """Yields the grey of the gel around each place; NaN outside of the picture."""
    reach = math.ceil(_GREY_REACH[1] * pitch_px)
    step = np.arange(-reach, reach + 1)
    far = np.hypot(*np.meshgrid(step, step)) / pitch_px
    ring = (far >= _GREY_REACH[0]) & (far <= _GREY_REACH[1])
    for x, y in np.rint(places).astype(np.intp):
        inside = reach <= x < SENSOR_WIDTH_PX - reach and reach <= y < SENSOR_HEIGHT_PX - reach
        if not inside:
            yield math.nan
            continue
        part = pixels[y - reach : y + reach + 1, x - reach : x + reach + 1]
        yield float(np.median(part[ring]))


def _name_side(off: NDArray[np.float64], reach: float) -> str:
    if np.hypot(*off) < 0.25 * reach:
        return "in the middle"
    sector = round(math.atan2(off[1], off[0]) / (math.pi / 4.0)) % 8
    return _SIDES[sector]

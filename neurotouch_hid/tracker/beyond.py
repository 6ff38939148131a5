"""Looks whether a pattern of dots goes on where the gel ends.

A keyboard, a perforated plate or a printed cloth may have dots at all places of a gel, but it has
more of them around.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import Gel
from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX

_APART: Final = 0.6
"""Of the pitch; a place that is nearer to a marker is not outside of the gel."""

_SAME: Final = 0.3
"""Of the pitch; nearer places are one."""

_NEAR: Final = 0.22
"""Of the pitch; a blob that is nearer to a place is a dot there. Clutter has some by chance."""

_LEAST: Final = 8
"""Places in the picture; fewer prove nothing."""

_BORDER_PX: Final = 3.0
"""Nearer to the border of the picture no blob is whole."""


@dataclass(frozen=True, slots=True, eq=False)
class Beyond:
    """The places around a gel where the next dots of its pattern would be.

    Attributes:
        first, second: (m,) intp, pairs of neighbours: as far beyond the first as the second is
            before it, there is a place.
        place: (m,) intp, the place of each pair.
        n_places: their number.
    """

    first: NDArray[np.intp]
    second: NDArray[np.intp]
    place: NDArray[np.intp]
    n_places: int

    def measure(
        self, position_px: NDArray[np.float64], free_px: NDArray[np.float64], pitch_px: float
    ) -> float:
        """Returns the share of the places that have a dot; 0 if too few are in the picture.

        Args:
            position_px: (n, 2) px, where the markers are.
            free_px: (k, 2) px, blobs that are no markers.
            pitch_px: the pitch.
        """
        if len(free_px) < _LEAST:
            return 0.0
        number = np.bincount(self.place, minlength=self.n_places)
        each_px = 2.0 * position_px[self.first] - position_px[self.second]
        places_px = np.column_stack(
            [np.bincount(self.place, axis, self.n_places) / number for axis in each_px.T]
        )
        most = np.array((SENSOR_WIDTH_PX, SENSOR_HEIGHT_PX)) - 1.0 - _BORDER_PX
        places_px = places_px[((places_px >= _BORDER_PX) & (places_px <= most)).all(axis=1)]
        if len(places_px) < _LEAST:
            return 0.0
        away = np.hypot(*(places_px[:, None] - free_px).transpose(2, 0, 1)).min(axis=1)
        return float((away < _NEAR * pitch_px).mean())


@lru_cache(maxsize=2)
def find_beyond(gel: Gel) -> Beyond:
    """Returns the places around a gel; each start asks five times."""
    points, middle = gel.points_mm, gel.points_mm.mean(axis=0)
    first = np.repeat(np.arange(gel.n_markers), gel.neighbours.shape[1])
    second = gel.neighbours.ravel()
    first, second = first[second >= 0], second[second >= 0]
    places = 2.0 * points[first] - points[second]
    away = np.hypot(*(places[:, None] - points).transpose(2, 0, 1)).min(axis=1)
    is_outward = np.hypot(*(places - middle).T) > np.hypot(*(points[first] - middle).T)
    outside = (away > _APART * gel.pitch_mm) & is_outward
    first, second, places = first[outside], second[outside], places[outside]
    near = np.hypot(*(places[:, None] - places).transpose(2, 0, 1)) < _SAME * gel.pitch_mm
    _, place = np.unique(near.argmax(axis=1), return_inverse=True)
    return Beyond(first, second, place, int(place.max(initial=-1)) + 1)

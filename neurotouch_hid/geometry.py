"""The gel and the rig: markers at rest, their neighbours, and pixels <-> millimetres."""

import cmath
import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

NOMINAL_PX_PER_MM = 2.5  # [NT, "Results"]: r = 30 px is about 12 mm
NOMINAL_PITCH_PX = 10.0  # the same for markers that are 4 mm apart
MOST_MARKERS = 400  # of a gel: records of kernels and the driver's state have so many places
_NEAR = 1.6  # pitches: the diagonal of a square is nearer, the next but one marker is not
_ROUNDING_MM = 1e-9
_WIDEST_RIM_MM = 31.0  # of the paper's gel; the closed forms fit finite elements with it
_SAME = 0.05  # of the pitch
_MOST_TURNS = 12
_MOST_NEIGHBOURS = 8  # as many as a square lattice has


@dataclass(frozen=True, slots=True, eq=False)
class Gel:
    """A gel with its markers, as it was made.

    Attributes:
        name: its name.
        points_mm: (n, 2) float64, every marker at rest in gel coordinates.
        neighbours: (n, 8) intp, the markers around each, from the top and from the left; -1 fills
            the row.
        pitch_mm: distance of neighbours.
        radius_mm: of the gel around the origin.
        rim_mm: how far from the origin the housing clamps it: half a pitch beyond the last marker,
            as otherwise there would be another one; at most as far as on the paper's gel.
        dot_mm: diameter of a marker.
        light: True for light markers on a dark gel, False for dark ones on a light gel.
        dome_height_mm: height of the middle over the rim; 0 for a flat gel.
    """

    name: str
    points_mm: Floats
    neighbours: NDArray[np.intp]
    pitch_mm: float
    radius_mm: float
    rim_mm: float
    dot_mm: float
    light: bool
    dome_height_mm: float

    @property
    def n_markers(self) -> int:
        """The number of markers."""
        return len(self.points_mm)

    def lighten(self, pixels: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Returns a picture in which the markers are light: inverted if they are dark."""
        return pixels if self.light else ~pixels

    def lighten_events(self, events: NDArray[np.void]) -> NDArray[np.void]:
        """Returns events, (m,) EVENT_DTYPE, as light markers make them, not dark ones."""
        if self.light:
            return events
        inverted = events.copy()
        inverted["p"] = ~events["p"]
        return inverted


def make_gel(
    name: str,
    points_mm: Floats,
    *,
    pitch_mm: float,
    radius_mm: float,
    dot_mm: float = 1.0,
    light: bool = True,
    dome_height_mm: float = 15.0,
) -> Gel:
    """Returns a gel with the neighbours of its markers, and its rim.

    The arguments are as of ``Gel``.
    """
    points_mm = np.array(points_mm, np.float64)
    rim_mm = min(float(np.hypot(*points_mm.T).max()) + 0.5 * pitch_mm, _WIDEST_RIM_MM)
    neighbours = _find_neighbours(points_mm, _NEAR * pitch_mm)
    for array in (points_mm, neighbours):
        array.setflags(write=False)
    return Gel(
        name, points_mm, neighbours, pitch_mm, radius_mm, rim_mm, dot_mm, light, dome_height_mm
    )


def place_square(pitch_mm: float, radius_mm: float) -> Floats:
    """Returns a square lattice within a radius of the origin, which is one of its points.

    Returns:
        (n, 2) float64 mm, rows from the top, columns from the left.
    """
    n = int(radius_mm // pitch_mm)
    rows, columns = np.mgrid[-n : n + 1, -n : n + 1]
    inside = np.hypot(rows, columns) * pitch_mm <= radius_mm
    points: Floats = np.stack([columns[inside], rows[inside]], axis=1) * pitch_mm
    return points


def place_hex(pitch_mm: float, radius_mm: float) -> Floats:
    """Returns a hexagonal lattice within a radius of the origin, which is one of its points.

    Returns:
        (n, 2) float64 mm, rows from the top, columns from the left.
    """
    n = int(2.0 * radius_mm // pitch_mm) + 1
    j, i = np.mgrid[-n : n + 1, -n : n + 1].reshape(2, -1)
    points: Floats = pitch_mm * np.column_stack([i + 0.5 * j, math.sqrt(0.75) * j])
    inside: Floats = points[np.hypot(*points.T) <= radius_mm + _ROUNDING_MM]
    return inside


def place_rings(pitch_mm: float, radius_mm: float) -> Floats:
    """Returns the origin and the points of rings around it, 6 more on each; all (n, 2) mm."""
    points = [np.zeros((1, 2))]
    for k in range(1, int((radius_mm + _ROUNDING_MM) // pitch_mm) + 1):
        angle = 2.0 * math.pi * np.arange(6 * k) / (6 * k)
        points.append(k * pitch_mm * np.column_stack([np.cos(angle), np.sin(angle)]))
    return np.concatenate(points)


def place_grid(columns: int, rows: int, x_mm: float, y_mm: float) -> Floats:
    """Returns a rectangle of points around the origin, (n, 2) mm, row by row.

    Args:
        columns: points from left to right.
        rows: points from top to bottom.
        x_mm: distance from left to right.
        y_mm: distance from top to bottom.
    """
    j, i = np.mgrid[:rows, :columns].reshape(2, -1)
    points: Floats = np.column_stack(
        [x_mm * (i - 0.5 * (columns - 1)), y_mm * (j - 0.5 * (rows - 1))]
    )
    return points


def find_median(values: NDArray[np.floating]) -> NDArray[np.floating]:
    """Returns the median along the first axis of numbers without NaN; NaN if there is none.

    It is that of ``np.median``, which takes several times as long, and whose first call imports
    ``numpy.ma``: 8 ms of a start.
    """
    n = len(values)
    if not n:
        return np.full(values.shape[1:], np.nan)
    below, above = (n - 1) // 2, n // 2
    parted = np.partition(values, (below, above), axis=0)
    median: NDArray[np.floating] = (parted[below] + parted[above]) / 2
    return median


def measure_pitch(points: Floats) -> float:
    """Returns the median distance of points, (n, 2), from the nearest other one."""
    away = np.hypot(*(points[:, None] - points).transpose(2, 0, 1))
    np.fill_diagonal(away, np.inf)
    return float(find_median(away.min(axis=1)))


@lru_cache(maxsize=2)
def count_turns(gel: Gel) -> int:
    """Returns how many turns about their middle, within a whole one, map markers to themselves.

    Each start asks three times.
    """
    z = (gel.points_mm - gel.points_mm.mean(axis=0)) @ (1, 1j)
    near_mm = _SAME * measure_pitch(gel.points_mm)
    for n in range(_MOST_TURNS, 1, -1):
        turned = z * cmath.rect(1.0, 2.0 * math.pi / n)
        if np.abs(turned[:, None] - z).min(axis=1).max() < near_mm:
            return n
    return 1


def _find_neighbours(points_mm: Floats, near_mm: float) -> NDArray[np.intp]:
    """Returns the nearest markers around each within a distance, row by row; -1 fills the rows."""
    away = np.hypot(*(points_mm[:, None] - points_mm).transpose(2, 0, 1))
    np.fill_diagonal(away, np.inf)
    nearest = np.argsort(away, axis=1, kind="stable")[:, :_MOST_NEIGHBOURS]
    is_far = np.take_along_axis(away, nearest, axis=1) >= near_mm
    x, y = points_mm[nearest].transpose(2, 0, 1)
    order = np.lexsort((x, y, is_far), axis=1)
    neighbours: NDArray[np.intp] = np.where(is_far, -1, nearest)
    return np.take_along_axis(neighbours, order, axis=1)


PAPER_GEL = make_gel(
    "paper", place_square(4.0, 30.0), pitch_mm=4.0, radius_mm=30.0, dot_mm=1.0, dome_height_mm=15.0
)
"""The gel of the paper [NT, "System Overview"]: a dome of 60 mm diameter with 1 mm markers 4 mm
apart. 177 is exactly the number of points of that lattice within 30 mm of the centre. The height
of the dome is that of the simulator."""


@dataclass(frozen=True, slots=True)
class Rig:
    """The view of one sensor on the gel: a similarity from gel millimetres to image pixels.

    Attributes:
        centre_px: image point (x, y) of the gel's centre.
        px_per_mm: scale at the gel's centre.
        rotation_rad: turn of the lattice in the image, clockwise positive.
        mirrored: the camera sees the gel mirrored; sources undo that, so no later stage needs it.
    """

    centre_px: tuple[float, float]
    px_per_mm: float
    rotation_rad: float = 0.0
    mirrored: bool = False

    def to_px(self, points_mm: NDArray[np.floating]) -> NDArray[np.float64]:
        """Returns image points (n, 2) of gel points (n, 2)."""
        return np.asarray(points_mm, np.float64) @ self._matrix().T + self.centre_px

    def to_mm(self, points_px: NDArray[np.floating]) -> NDArray[np.float64]:
        """Returns gel points (n, 2) in mm of image points (n, 2)."""
        return (
            (np.asarray(points_px, np.float64) - self.centre_px)
            @ self._matrix()
            / self.px_per_mm**2
        )

    def vector_to_mm(self, vector_px: NDArray[np.floating]) -> NDArray[np.float64]:
        """Returns gel displacements (n, 2) in mm of image displacements (n, 2)."""
        return np.asarray(vector_px, np.float64) @ self._matrix() / self.px_per_mm**2

    def _matrix(self) -> NDArray[np.float64]:
        c, s = (
            self.px_per_mm * math.cos(self.rotation_rad),
            self.px_per_mm * math.sin(self.rotation_rad),
        )
        return np.array([[c, -s], [s, c]])


def fit_rig(rest_px: NDArray[np.floating], gel: Gel = PAPER_GEL) -> Rig:
    """Returns the rig whose similarity maps a gel to its markers at rest by least squares.

    Args:
        rest_px: (n, 2) px, the markers at rest in the order of ``Gel.points_mm``; rows that are not
            finite are left out.
        gel: the gel.
    """
    known = np.isfinite(rest_px).all(axis=1)
    source = gel.points_mm[known] @ (1, 1j)
    target = np.asarray(rest_px[known], np.float64) @ (1, 1j)
    ds, dt = source - source.mean(), target - target.mean()
    factor = np.vdot(ds, dt) / np.vdot(ds, ds).real
    centre = target.mean() - factor * source.mean()
    return Rig(
        (float(centre.real), float(centre.imag)), float(abs(factor)), float(np.angle(factor))
    )

"""The gel and the rig: marker lattice at rest, its neighbours, and pixels <-> millimetres."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

GEL_RADIUS_MM = 30.0  # [NT, "System Overview"]: dome of 60 mm diameter
PITCH_MM = 4.0  # [NT, "System Overview"]: markers regularly spaced 4 mm apart
MARKER_DIAMETER_MM = 1.0  # [NT, "System Overview"]
NOMINAL_PX_PER_MM = 2.5  # [NT, "Results"]: r = 30 px is about 12 mm


def _lattice() -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    n = int(GEL_RADIUS_MM // PITCH_MM)
    rows, columns = np.mgrid[-n : n + 1, -n : n + 1]
    inside = np.hypot(rows, columns) * PITCH_MM <= GEL_RADIUS_MM
    index = np.stack([columns[inside], rows[inside]], axis=1)
    lookup = {(int(x), int(y)): i for i, (x, y) in enumerate(index)}
    around = [(dx, dy) for dy in (-1, 0, 1) for dx in (-1, 0, 1) if (dx, dy) != (0, 0)]
    neighbours = [
        [lookup.get((int(x) + dx, int(y) + dy), -1) for dx, dy in around] for x, y in index
    ]
    return index * PITCH_MM, np.array(neighbours, dtype=np.intp)


LATTICE_MM, NEIGHBOURS = _lattice()
"""``LATTICE_MM``: (177, 2) float64, every marker at rest in gel coordinates, rows from the top,
columns from the left: 177 is exactly the number of points of a 4 mm square lattice within 30 mm of
the centre. ``NEIGHBOURS``: (177, 8) intp, the lattice neighbours of each marker (row above, left
and right, row below), -1 where there is none."""
LATTICE_MM.setflags(write=False)
NEIGHBOURS.setflags(write=False)
N_MARKERS = len(LATTICE_MM)


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


def fit_rig(rest_px: NDArray[np.floating]) -> Rig:
    """Returns the rig whose similarity maps the lattice to the markers at rest by least squares.

    Args:
        rest_px: (177, 2) px, the markers at rest in the order of ``LATTICE_MM``; rows that are not
            finite are left out.
    """
    known = np.isfinite(rest_px).all(axis=1)
    source = LATTICE_MM[known] @ (1, 1j)
    target = np.asarray(rest_px[known], np.float64) @ (1, 1j)
    ds, dt = source - source.mean(), target - target.mean()
    factor = np.vdot(ds, dt) / np.vdot(ds, ds).real
    centre = target.mean() - factor * source.mean()
    return Rig(
        (float(centre.real), float(centre.imag)), float(abs(factor)), float(np.angle(factor))
    )

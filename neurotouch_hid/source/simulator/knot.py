"""The gel at one moment, as the simulation makes it and as the sensor sees it."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import LATTICE_MM, N_MARKERS
from neurotouch_hid.messages import GestureKind

Pose = tuple[float, float, float]
"""How a gel has moved in its mount: right and down in mm, clockwise in rad."""


def _ones() -> NDArray[np.float64]:
    return np.ones(N_MARKERS)


@dataclass(frozen=True, slots=True, eq=False)
class Dots:
    """The markers as they were made; by default all alike, on the lattice.

    Attributes:
        points_mm: (177, 2) float64, where each is on the undeformed gel.
        brightness: (177,) float64, 0 is missing.
        size: (177,) float64, diameters relative to the usual one.
    """

    points_mm: NDArray[np.float64] = field(default_factory=lambda: LATTICE_MM)
    brightness: NDArray[np.float64] = field(default_factory=_ones)
    size: NDArray[np.float64] = field(default_factory=_ones)


@dataclass(frozen=True, slots=True, eq=False)
class Knot:
    """The gel at one of the equally spaced moments.

    Attributes:
        outline: (177, 6) float64, see ``CameraModel.outline``.
        kind: of the stroke at work, NONE at rest.
        contacts_px: (k, 2) float64, place of the largest deformation of each finger.
        seen_mm: (k,) float64, how far that place has moved in the image since rest.
        moved_mm: (k,) float64, how far the finger's middle has moved; this is the intensity. With
            the place of the largest deformation, the error of the paper's method would be 2 mm;
            with the middle it is 1.6 mm, and on real hands 1 mm [NT, "Results"].
    """

    outline: NDArray[np.float64]
    kind: GestureKind
    contacts_px: NDArray[np.float64]
    seen_mm: NDArray[np.float64]
    moved_mm: NDArray[np.float64]

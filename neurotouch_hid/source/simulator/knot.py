"""The gel at one moment, as the simulation makes it and as the sensor sees it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import Gel
from neurotouch_hid.messages import GestureKind

Pose = tuple[float, float, float]
"""How a gel has moved in its mount: right and down in mm, clockwise in rad."""


@dataclass(frozen=True, slots=True, eq=False)
class Dots:
    """The markers as they were made.

    Attributes:
        points_mm: (n, 2) float64, where each is on the undeformed gel.
        brightness: (n,) float64, 0 is missing.
        size: (n,) float64, diameters relative to the usual one.
    """

    points_mm: NDArray[np.float64]
    brightness: NDArray[np.float64]
    size: NDArray[np.float64]


def make_dots(gel: Gel, missing: Sequence[int] = ()) -> Dots:
    """Returns markers that are all alike, in their places; some may be missing."""
    brightness = np.ones(gel.n_markers)
    brightness[list(missing)] = 0.0
    return Dots(gel.points_mm, brightness, np.ones(gel.n_markers))


@dataclass(frozen=True, slots=True, eq=False)
class Knot:
    """The gel at one of the equally spaced moments.

    Attributes:
        outline: (n, 6) float64, see ``CameraModel.outline``.
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

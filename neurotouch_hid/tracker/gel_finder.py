"""Finds the gel in a picture that may show it anywhere."""

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import LATTICE_MM
from neurotouch_hid.tracker.blobs import BlobFinder
from neurotouch_hid.tracker.lattice import LatticeConfig, find_lattice


class GelFinder:
    """Finds the gel in one canonical picture, touched or not.

    Attributes:
        points_mm: (177, 2) float64 mm, ``geometry.LATTICE_MM``.
    """

    points_mm = LATTICE_MM

    def __init__(self) -> None:
        self._blobs, self._config = BlobFinder(), LatticeConfig()

    def find(self, pixels: NDArray[np.uint8]) -> NDArray[np.float64] | None:
        """Returns the dots in a picture, (260, 346) uint8, as (177, 2) px; None without a gel."""
        centroid_px = self._blobs.find(pixels).centroid_px
        lattice, config = find_lattice(centroid_px, self._config), self._config
        if lattice is None or lattice.n_found < config.min_found:
            return None
        return None if lattice.aside_mm > config.max_aside_mm else lattice.position_px

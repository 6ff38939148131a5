"""Finds the gel in a picture that may show it anywhere."""

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import PAPER_GEL, Gel
from neurotouch_hid.tracker.blobs import BlobFinder
from neurotouch_hid.tracker.lattice import LatticeFinder


class GelFinder:
    """Finds a gel in one canonical picture.

    Args:
        gel: the gel.

    Attributes:
        gel: the gel.
    """

    def __init__(self, gel: Gel = PAPER_GEL) -> None:
        self.gel = gel
        self._blobs, self._lattice = BlobFinder(gel=gel), LatticeFinder(gel)

    def find(
        self, pixels: NDArray[np.uint8], *, is_still: bool = False
    ) -> NDArray[np.float64] | None:
        """Returns the dots in a picture, (260, 346) uint8, as (n, 2) px; None without the gel.

        Args:
            pixels: the picture.
            is_still: only a gel that nothing deforms counts.
        """
        lattice = self._lattice.find(self._blobs.find(pixels).centroid_px)
        limits = self._lattice.config
        if lattice is None or lattice.share < limits.min_share or lattice.aside > limits.max_aside:
            return None
        if lattice.beyond > limits.max_beyond:
            return None
        if is_still and lattice.bend_px > limits.max_bend_px:
            return None
        return lattice.position_px

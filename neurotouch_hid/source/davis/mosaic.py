"""Takes the mosaic of a colour sensor out of its frames."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.source.davis.kernels import mosaic as kernels

LARGEST_GAIN: Final = 4.0
"""A kind of pixels that is darker than that by its filter shows more noise than dots."""
_LEARN: Final = 1 / 8  # weight of a frame in the estimate of the gains; the first one counts whole
_LEAST_SQUARES: Final = 1_000
"""Squares of 2 x 2 pixels that are not white: of fewer, nothing is learnt."""


class Mosaic:
    """Multiplies each of the four kinds of pixels, so that a frame looks monochrome.

    A filter dims its pixels by a constant share. The dots lie on all four kinds alike, so the sums
    of the kinds over a frame have the ratio of the filters. The gel at rest gives the first
    estimate; later frames follow the colour of the light. No filter's name is needed for that.
    """

    def __init__(self) -> None:
        self._shares = np.zeros(4)
        self._totals = np.zeros(4, np.int64)
        self._gains = np.full(4, kernels.ONE, np.int64)

    @property
    def gains(self) -> NDArray[np.float64]:
        """The gains, (4,): top left, top right, bottom left, bottom right pixel of a square."""
        return self._gains / kernels.ONE

    def level(self, pixels: NDArray[np.uint8]) -> None:
        """Learns from a frame, (h, w) uint8, and levels it in place."""
        n = kernels.add_kinds(pixels, self._totals)
        least = int(self._totals.min())
        if n >= _LEAST_SQUARES and least * LARGEST_GAIN >= self._totals.max() > 0:
            shares = self._totals / self._totals.max()
            share = _LEARN if self._shares.any() else 1.0
            self._shares += share * (shares - self._shares)
            self._gains[:] = np.rint(kernels.ONE * self._shares.max() / self._shares)
        kernels.level(pixels, self._gains)

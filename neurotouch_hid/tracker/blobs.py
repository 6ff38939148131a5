"""Bright blobs in a frame: threshold, connected regions, centroids [NT, "Marker Tracking"]."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX
from neurotouch_hid.tracker.kernels import image as kernels

MAX_BLOBS = 1024  # more is no picture of a gel


@dataclass(frozen=True, slots=True)
class BlobConfig:
    """How markers are told from the background.

    Attributes:
        n_sigma: threshold above the local mean, in local standard deviations. Markers cover about
            5 % of the gel, so 1.5 is some 0.4 of their contrast, up to 0.7 where they crowd.
        min_contrast: least threshold above the local mean, grey levels; five times read noise.
        min_area_px: smaller regions are noise. The smallest marker covers 3 px at 2 px/mm.
        max_area_px: larger regions are no markers; two merged ones at 3 px/mm cover 30 px.
    """

    n_sigma: float = 1.5
    min_contrast: float = 10.0
    min_area_px: int = 2
    max_area_px: int = 40


@dataclass(frozen=True, slots=True, eq=False)
class Blobs:
    """The blobs of one frame; the arrays are valid until the next frame is searched.

    Attributes:
        centroid_px: (n, 2) float64, columns x, y, weighted by intensity.
        begin: (n + 1,) int32: the pixels of blob i are ``members[begin[i]:begin[i + 1]]``.
        members: int32 pixel indices, y * 346 + x.
    """

    centroid_px: NDArray[np.float64]
    begin: NDArray[np.int32]
    members: NDArray[np.int32]

    @property
    def area_px(self) -> NDArray[np.int32]:
        """(n,) int32, the number of pixels of each blob."""
        return np.diff(self.begin)

    def copy(self) -> "Blobs":
        """The same for good."""
        return Blobs(self.centroid_px.copy(), self.begin.copy(), self.members.copy())


class BlobFinder:
    """Finds the blobs of frames, with buffers that are used again and again.

    Whoever asks for the frame that was searched last gets what was found then.
    """

    def __init__(self, config: BlobConfig | None = None) -> None:
        self._config = config or BlobConfig()
        h, w, block = SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX, kernels.BLOCK_PX
        self._threshold = np.empty((-(-h // block), -(-w // block)))
        self._background = np.empty_like(self._threshold)
        self._bright = np.zeros((h + 2, (w // 8 + 1) * 8), np.uint8)
        self._centroid_px = np.empty((MAX_BLOBS, 2))
        self._begin = np.empty(MAX_BLOBS + 1, np.int32)
        self._members = np.empty(h * w, np.int32)
        self._found: tuple[NDArray[np.uint8], Blobs] | None = None

    def find(self, pixels: NDArray[np.uint8]) -> Blobs:
        """The blobs of a frame (260, 346) uint8, which nobody writes to any more."""
        if self._found is None or self._found[0] is not pixels:
            self._found = (pixels, self._search(pixels))
        return self._found[1]

    def _search(self, pixels: NDArray[np.uint8]) -> Blobs:
        c = self._config
        pixels = np.require(pixels, np.uint8, ["C", "W"])
        kernels.threshold_blocks(
            pixels, c.n_sigma, c.min_contrast, self._threshold, self._background
        )
        n = kernels.find_blobs(
            pixels,
            self._threshold,
            self._background,
            c.min_area_px,
            c.max_area_px,
            self._bright,
            self._centroid_px,
            self._begin,
            self._members,
        )
        begin = self._begin[: n + 1]
        return Blobs(self._centroid_px[:n], begin, self._members[: begin[n]])

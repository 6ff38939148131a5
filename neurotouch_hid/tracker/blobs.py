"""Finds bright blobs in a frame: threshold, connected regions, centroids.

[NT, "Marker Tracking"].
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import NOMINAL_PITCH_PX, PAPER_GEL, Gel
from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX
from neurotouch_hid.process.kernel_cache import bind
from neurotouch_hid.tracker.kernels import image as kernels

MAX_BLOBS = 1024  # a picture of a gel has fewer
_MOST_BLOBS = 2  # for each marker; of more, most are noise, which also joins some to dots


@dataclass(frozen=True, slots=True)
class BlobConfig:
    """Settings that distinguish markers from the background.

    Attributes:
        n_sigma: threshold above the local mean, in local standard deviations. Markers cover about
            5 % of the gel, so 1.5 is some 0.4 of their contrast, up to 0.7 where they crowd.
        min_contrast: least threshold above the local mean, grey levels; five times read noise.
        min_clear: least number of blocks of 8 x 8 px in which something exceeds that. A picture
            with fewer, because the lens is out of focus or the light is weak, is smoothed first:
            then noise and threshold are a quarter. A gel at 1.4 px/mm has more if its dots stand
            out.
        min_area_px: smaller regions are noise. The smallest marker covers 3 px at 2 px/mm.
        max_area_px: larger regions are no markers; two merged markers at 3 px/mm cover 30 px.
    """

    n_sigma: float = 1.5
    min_contrast: float = 10.0
    min_clear: int = 120
    min_area_px: int = 2
    max_area_px: int = 40


@dataclass(frozen=True, slots=True, eq=False)
class Blobs:
    """The blobs of one frame; the arrays are valid until the next frame is searched.

    Attributes:
        centroid_px: (n, 2) float64 px, weighted by intensity, columns x, y.
        begin: (n + 1,) int32: the pixels of blob i are ``members[begin[i]:begin[i + 1]]``.
        members: int32 pixel indices, y * 346 + x.
    """

    centroid_px: NDArray[np.float64]
    begin: NDArray[np.int32]
    members: NDArray[np.int32]

    def copy(self) -> "Blobs":
        """Returns a copy that stays valid."""
        return Blobs(self.centroid_px.copy(), self.begin.copy(), self.members.copy())


def lighten(pixels: NDArray[np.uint8], gel: Gel) -> NDArray[np.uint8]:
    """Returns a picture in which the markers are light, as an array that kernels take."""
    light = gel.lighten(pixels)
    is_ready = light.flags.c_contiguous and light.flags.writeable
    return light if is_ready else np.array(light, np.uint8)


class BlobFinder:
    """Finds the blobs of frames; the buffers are reused.

    The result for the last frame is kept, so a second call for the same frame costs nothing.

    Args:
        config: what is a marker.
        gel: says whether the markers are light or dark.

    Attributes:
        is_fine: a dot's place is its middle in a window, see ``centre_blobs``; in noise it always
            is. That takes longer than the search, so it is for cameras without events.
    """

    def __init__(self, config: BlobConfig | None = None, gel: Gel = PAPER_GEL) -> None:
        self._gel, self.is_fine = gel, False
        h, w, block = SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX, kernels.BLOCK_PX
        blocks = -(-h // block), -(-w // block)
        self._buffers = kernels.Buffers(
            threshold=np.empty(blocks),
            background=np.empty(blocks),
            bright=np.zeros((h + 2, (w // 8 + 1) * 8), np.uint8),
            centroid_px=np.empty((MAX_BLOBS, 2)),
            begin=np.empty(MAX_BLOBS + 1, np.int32),
            members=np.empty(h * w, np.int32),
            smoothed=np.empty((h, w), np.uint8),
        )
        config = config or BlobConfig()
        limits = kernels.Limits(
            n_sigma=config.n_sigma,
            min_contrast=config.min_contrast,
            min_clear=config.min_clear,
            min_area_px=config.min_area_px,
            max_area_px=config.max_area_px,
            most_blobs=_MOST_BLOBS * gel.n_markers,
            window_px=0.5 * gel.dot_mm * NOMINAL_PITCH_PX / gel.pitch_mm,
        )
        self._search = bind(kernels.search, self._buffers, limits)
        self._found: tuple[NDArray[np.uint8], Blobs] | None = None

    def find(self, pixels: NDArray[np.uint8]) -> Blobs:
        """Returns the blobs of a frame, (260, 346) uint8, which must not change any more."""
        if self._found is not None and self._found[0] is pixels:
            return self._found[1]
        n, b = self._search(lighten(pixels, self._gel), self.is_fine), self._buffers
        blobs = Blobs(b.centroid_px[:n], b.begin[: n + 1], b.members[: b.begin[n]])
        self._found = pixels, blobs
        return blobs

"""The gel at rest, with which frames are compared."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import Gel, fit_rig
from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX
from neurotouch_hid.tracker.blobs import Blobs
from neurotouch_hid.tracker.kernels import chamfer, rigid
from neurotouch_hid.tracker.kernels import reference as kernels
from neurotouch_hid.tracker.lattice import Lattice
from neurotouch_hid.tracker.rest_config import RestConfig

MEAN_FRAMES = 16  # of a reference; the noise of one frame is then a quarter
_FOLLOW_US = 400_000  # time constant with which a reference follows a rig that creeps
_LONGEST_US = 200_000  # longest time that one frame counts for
_REDRAW_PX = 0.4  # as far from where they were drawn, white pixels hardly count as elsewhere


class Comparison(NamedTuple):
    """Distances of a frame from the gel at rest.

    Attributes:
        n_found: number of markers near their places.
        displacement_px: largest distance of these from their places, without the few that may be
            elsewhere.
        chamfer_px2: Chamfer distance; NaN if the markers alone show that the gel is not at rest.
    """

    n_found: int
    displacement_px: float
    chamfer_px2: float


class Reference:
    """The gel at rest: marker positions, and white pixels for the Chamfer distance.

    Args:
        lattice: the markers.
        blobs: of the frame that shows them.
        gel: the gel.
        config: the limits of rest.

    Attributes:
        position_px: (n, 2) float64 px, the mean of the first frames at rest; never changed in
            place.
        limit_px: largest displacement of a gel at rest.
    """

    def __init__(self, lattice: Lattice, blobs: Blobs, gel: Gel, config: RestConfig) -> None:
        self.bend_px = lattice.bend_px
        self.n_found = lattice.n_found
        self._config = config
        rig = fit_rig(lattice.position_px, gel)
        self.px_per_mm = rig.px_per_mm
        self.gate_px = 0.35 * gel.pitch_mm * rig.px_per_mm
        self.limit_px = config.max_displacement_mm * rig.px_per_mm
        reach = np.hypot(*(lattice.position_px - rig.centre_px).T).max()
        self._radius_px = float(reach) + gel.pitch_mm * rig.px_per_mm
        self._mask = np.zeros((SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX), np.uint8)
        self._pixels = np.empty(0, np.int32)
        self._scratch = np.empty(self._mask.size, np.int32)
        self._n_frames, self._rest_us = 1, 0
        self.move(lattice.position_px, blobs)
        self._n_moved = MEAN_FRAMES

    def move(self, position_px: NDArray[np.float64], blobs: Blobs) -> None:
        """Takes the same markers at other places, where the blobs of a frame show them."""
        self._n_moved = 1
        self.position_px = position_px
        self._draw(blobs)

    def _draw(self, blobs: Blobs) -> None:
        """Takes the white pixels of a frame that shows the markers where they are at rest.

        They are those on the gel, without a lamp beside it.
        """
        self._drawn_px = self.position_px
        self._centre_px = self.position_px.mean(axis=0)
        x, y = self._centre_px.tolist()
        n = chamfer.gather_inside(
            blobs.centroid_px, blobs.begin, blobs.members, (x, y), self._radius_px, self._scratch
        )
        self._mask.flat[self._pixels] = 0
        self._pixels = self._scratch[:n].copy()
        self._mask.flat[self._pixels] = chamfer.REFERENCE

    def add(self, t_us: int, blobs: Blobs, match: NDArray[np.int32]) -> bool:
        """Takes a frame at rest into the mean, and follows the rig.

        One frame of a blurred or noisy picture is off by as much as a soft touch, so each marker's
        place is the mean of the first frames. Afterwards all of them move with the rig only: it
        creeps and turns, and one that was bumped still swings a little. A touch that is too soft
        to be seen hardly moves all markers rigidly.

        Args:
            t_us: the time of the frame.
            blobs: its blobs.
            match: (n,) int32, the blob of each marker; negative without one.

        Returns:
            True if the rig has moved by more than ``_REDRAW_PX`` since this last was so.
        """
        elapsed_us = min(max(t_us - self._rest_us, 0), _LONGEST_US)
        self._rest_us = t_us
        self._n_moved += 1
        if self._n_frames < MEAN_FRAMES:
            self._n_frames += 1
            seen = (match >= 0)[:, None]
            off_px = np.where(seen, blobs.centroid_px[match] - self.position_px, 0.0)
            self.position_px = self.position_px + off_px / self._n_frames
            return False
        share = max(1.0 / self._n_moved, -math.expm1(-elapsed_us / _FOLLOW_US))
        self.position_px, far_px = rigid.creep(
            self.position_px, blobs.centroid_px, match, share, self._drawn_px
        )
        if far_px < _REDRAW_PX:
            return False
        self._draw(blobs)
        return True

    def compare(self, blobs: Blobs, match: NDArray[np.int32]) -> Comparison:
        """Returns how far a frame is from the gel at rest.

        Args:
            blobs: of the frame.
            match: (n,) int32, written: the blob of each marker; negative without one.
        """
        return Comparison(
            *kernels.compare(
                self.position_px,
                self._centre_px,
                self._radius_px,
                self._pixels,
                self._mask,
                self._scratch,
                blobs.centroid_px,
                blobs.begin,
                blobs.members,
                self.gate_px,
                self._config.max_displaced,
                self.limit_px,
                self._config.min_share * self.n_found,
                self._config.max_apart_px2,
                match,
            )
        )

    def find_moved(
        self, blobs: Blobs, n_unmoved: int, match: NDArray[np.int32]
    ) -> NDArray[np.float64] | None:
        """Returns where the markers are, (n, 2) px, if only the rig has moved; else None.

        Args:
            blobs: of a frame.
            n_unmoved: markers that are near their places.
            match: (n,) int32, the blobs of these.
        """
        is_rig, moved_px = rigid.find_moved(
            self.position_px,
            self._centre_px,
            self._radius_px,
            blobs.centroid_px,
            self.gate_px,
            self._config.max_displaced,
            self.limit_px,
            self._config.min_share * self.n_found,
            n_unmoved,
            match,
        )
        return moved_px if is_rig else None

    def locate(self, blobs: Blobs, match: NDArray[np.int32]) -> NDArray[np.float32]:
        """Returns where a frame shows the markers, (n, 2) px; at rest where it shows none.

        Args:
            blobs: of the frame.
            match: (n,) int32, the blob of each marker; negative without one.
        """
        seen_px = np.empty(self.position_px.shape, np.float32)
        kernels.write_seen(self.position_px, blobs.centroid_px, match, seen_px)
        return seen_px

"""The gel at rest, with which frames are compared."""

import math

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import Gel, fit_rig
from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX
from neurotouch_hid.tracker.blobs import Blobs
from neurotouch_hid.tracker.kernels import image as kernels
from neurotouch_hid.tracker.kernels import matching, rigid
from neurotouch_hid.tracker.lattice import Lattice

MEAN_FRAMES = 16  # of a reference; the noise of one frame is then a quarter
MOST_LEFT = 0.5  # of a rig's motion may be left; the light part of a touch is not that rigid
_FOLLOW_US = 400_000  # time constant with which a reference follows a rig that creeps
_LONGEST_US = 200_000  # longest time that one frame counts for
_REDRAW_PX = 0.4  # as far from where they were drawn, white pixels hardly count as elsewhere
_TURN_RATIO = 1.5  # a turn moves no marker farther than so many times the median of all


class Reference:
    """The gel at rest: marker positions, and white pixels for the Chamfer distance.

    Args:
        lattice: the markers.
        blobs: of the frame that shows them.
        gel: the gel.
        most_px2: a larger distance of a single white pixel counts as this one.

    Attributes:
        position_px: (n, 2) float64 px, the mean of the first frames at rest; never changed in
            place.
    """

    def __init__(self, lattice: Lattice, blobs: Blobs, gel: Gel, most_px2: int) -> None:
        self.bend_px = lattice.bend_px
        self.n_found = lattice.n_found
        rig = fit_rig(lattice.position_px, gel)
        self.px_per_mm = rig.px_per_mm
        self.gate_px = 0.35 * gel.pitch_mm * rig.px_per_mm
        reach = np.hypot(*(lattice.position_px - rig.centre_px).T).max()
        self._radius_px = float(reach) + gel.pitch_mm * rig.px_per_mm
        shape = (SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX)
        self._mask, self._most_px2 = np.zeros(shape, np.uint8), most_px2
        self._distance_px2 = np.empty(shape, np.int32)
        self._white = np.empty(SENSOR_HEIGHT_PX * SENSOR_WIDTH_PX, np.int32)
        self._match = np.empty(gel.n_markers, np.int32)
        self._n_frames, self._rest_us = 1, 0
        self.move(lattice.position_px, blobs)
        self._n_moved = MEAN_FRAMES

    def move(self, position_px: NDArray[np.float64], blobs: Blobs) -> None:
        """Takes the same markers at other places, where the blobs of a frame show them."""
        self._n_moved = 1
        self.position_px = position_px
        self._draw(blobs)

    def _draw(self, blobs: Blobs) -> None:
        """Takes the white pixels of a frame that shows the markers where they are at rest."""
        self._drawn_px = self.position_px
        self._centre_px = self.position_px.mean(axis=0)
        self._pixels = self._white_pixels(blobs).copy()
        self._mask.flat[self._pixels] = 1
        kernels.distance_map(self._mask, self._most_px2, self._distance_px2)
        self._mask.flat[self._pixels] = 0

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
        moved = np.empty_like(self.position_px)
        rigid.follow_rig(self.position_px, blobs.centroid_px, match, moved)
        self.position_px = self.position_px + share * (moved - self.position_px)
        if np.abs(self.position_px - self._drawn_px).max() < _REDRAW_PX:
            return False
        self._draw(blobs)
        return True

    def find_moved(
        self, blobs: Blobs, n_left_out: int, limit_px: float, n_unmoved: int
    ) -> NDArray[np.float64] | None:
        """Returns where the markers would be, (n, 2) px, if only the rig had moved.

        Args:
            blobs: of a frame.
            n_left_out: markers that may be elsewhere.
            limit_px: for all others, how far a rig may leave them elsewhere.
            n_unmoved: markers that are near their places if the rig has not moved.

        Returns:
            None if the gel is plainly touched: some markers are far off and most are not.
        """

        def measure(by_px: tuple[float, float]) -> tuple[float, float, int]:
            """Returns the motions from places moved by this, and how many markers are there."""
            median_px, largest_px = matching.measure_motions(
                self.position_px + by_px,
                blobs.centroid_px,
                self.gate_px,
                n_left_out,
                self._match,
            )
            return median_px, largest_px, int((self._match >= 0).sum())

        # Specks beside the dots pull the middle of all blobs, but then it fits fewer markers.
        by_px = rigid.recentre(blobs.centroid_px, self._centre_px, self._radius_px)
        median_px, largest_px, n_seen = measure(by_px)
        if n_seen < n_unmoved:
            by_px = (0.0, 0.0)
            median_px, largest_px, _ = measure(by_px)
        shifted: NDArray[np.float64] = self.position_px + by_px
        left_px = MOST_LEFT * math.hypot(*by_px, median_px)
        if largest_px > _TURN_RATIO * median_px + min(limit_px, left_px):
            return None
        moved = np.empty_like(shifted)
        rigid.follow_rig(shifted, blobs.centroid_px, self._match, moved)
        return moved

    def _white_pixels(self, blobs: Blobs) -> NDArray[np.int32]:
        """Returns the pixels of the blobs on the gel, (n,) int32, without a lamp beside it."""
        n = kernels.gather_inside(
            blobs.centroid_px,
            blobs.begin,
            blobs.members,
            self._centre_px,
            self._radius_px,
            self._white,
        )
        return self._white[:n]

    def chamfer(self, blobs: Blobs) -> float:
        """Returns the Chamfer distance of a frame, px²; infinite without any white pixel."""
        pixels = self._white_pixels(blobs)
        if not len(pixels):
            return float("inf")
        return float(
            kernels.chamfer(pixels, self._mask, self._pixels, self._distance_px2, self._most_px2)
        )

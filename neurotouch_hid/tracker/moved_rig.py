"""Notices that the rig has moved, and stands still elsewhere."""

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.tracker.blobs import Blobs
from neurotouch_hid.tracker.kept_motion import PACE_US
from neurotouch_hid.tracker.reference import Reference

_STILL_MM = 0.15  # a rig that moves more from frame to frame still swings


class MovedRig:
    """Watches the frames in which markers are off their places.

    What moves rigidly is the rig: a touch leaves the gel at the rim behind.
    """

    def __init__(self) -> None:
        self._moved_px: NDArray[np.float64] | None = None
        self._moved_us = 0

    def update(
        self, t_us: int, blobs: Blobs, reference: Reference, n_found: int, match: NDArray[np.int32]
    ) -> bool:
        """Returns True if the reference has just been moved with the rig.

        Args:
            t_us: the time of a frame.
            blobs: its blobs.
            reference: the gel at rest.
            n_found: markers near their places.
            match: (n,) int32, the blobs of these.
        """
        before_px, since_us = self._moved_px, t_us - self._moved_us
        if before_px is not None and 0 <= since_us < PACE_US:  # too early to tell
            return False
        self._moved_us = t_us
        self._moved_px = moved_px = reference.find_moved(blobs, n_found, match)
        if moved_px is None or before_px is None:
            return False
        if np.abs(moved_px - before_px).max() > _STILL_MM * reference.px_per_mm:
            return False
        reference.move(moved_px, blobs)
        self._moved_px = None
        return True

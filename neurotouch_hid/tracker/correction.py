"""Frames correct what events have let drift: tracks move to the blobs of a picture."""

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import N_MARKERS
from neurotouch_hid.messages import Frame, RestField
from neurotouch_hid.tracker.blobs import Blobs
from neurotouch_hid.tracker.kernels import correction
from neurotouch_hid.tracker.kernels import neighbours as neighbour_kernels
from neurotouch_hid.tracker.kernels import tracks as track_kernels

_MIN_EXPOSURE_US = 5_000  # assumed where a recording does not say
_MAX_ASTRAY_PX = 2.0  # at rest no track that follows its own marker is farther off


class FrameCorrection:
    """Moves tracks to the blobs of a frame, as they lay in the middle of its exposure."""

    def __init__(self, tracks: track_kernels.Tracks, tuning: track_kernels.Tuning) -> None:
        self._tracks, self._tuning = tracks, tuning
        self._expected_px = np.empty((N_MARKERS, 2))
        self._spread_px = np.empty(N_MARKERS)
        self._missed = np.zeros(N_MARKERS, np.intp)

    def apply(self, frame: Frame, blobs: Blobs) -> None:
        """Correct all tracks by the blobs of a frame whose exposure ends now, or ended lately."""
        begin_us = min(frame.exposure_begin_us, frame.exposure_end_us - _MIN_EXPOSURE_US)
        seen, by_px = correction.correct(
            begin_us,
            frame.t_us,
            frame.exposure_end_us,
            blobs.centroid_px,
            blobs.begin,
            self._missed,
            self._tracks,
            self._tuning,
        )
        if len(seen):
            track_kernels.shift(seen, by_px, self._tracks)

    def anchor(self, rest: RestField) -> None:
        """Correct all tracks by a frame that shows the gel at rest, however late that is known.

        At rest the position identifies each marker. So a track that was elsewhere had followed a
        neighbour: it is put where its own neighbours say that it is now.
        """
        then_px = np.empty((N_MARKERS, 2))
        if not correction.recall(rest.t_us, self._tracks, then_px):
            return
        tracks = self._tracks
        error = rest.position_px - then_px
        astray = np.hypot(*error.T) > _MAX_ASTRAY_PX
        track_kernels.shift(np.flatnonzero(~astray), error[~astray], tracks)
        tracks.lost[~astray & (self._missed < correction.MAX_MISSED)] = False
        if not astray.any():
            return
        t_us = float(tracks.state["t_us"].max())
        now_px = np.stack([tracks.state["x"], tracks.state["y"]], axis=1)
        self._expect(now_px, ~astray)
        unknown = ~np.isfinite(self._expected_px)
        self._expected_px[unknown] = rest.position_px[unknown]
        track_kernels.place(
            np.flatnonzero(astray), self._expected_px[astray], 1.0, t_us, tracks, self._tuning
        )
        tracks.lost[astray] = True

    def _expect(self, position_px: NDArray[np.float64], usable: NDArray[np.bool_]) -> None:
        tracks = self._tracks
        neighbour_kernels.expect(
            position_px,
            usable,
            tracks.rest_px,
            tracks.neighbours,
            self._expected_px,
            self._spread_px,
        )

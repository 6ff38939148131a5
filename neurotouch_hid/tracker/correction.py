"""Corrects the drift of the tracks by frames: tracks move to the blobs of a frame."""

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.messages import Frame, RestField
from neurotouch_hid.process.kernel_cache import bind
from neurotouch_hid.tracker.blobs import Blobs
from neurotouch_hid.tracker.kernels import correction, frames_alone
from neurotouch_hid.tracker.kernels import neighbours as neighbour_kernels
from neurotouch_hid.tracker.kernels import tracks as track_kernels

_MIN_EXPOSURE_US = 5_000  # assumed if a recording does not contain it
_MAX_ASTRAY_PX = 2.0  # at rest, a track farther off follows a wrong marker


class FrameCorrection:
    """Moves tracks to the blobs of a frame, at the time of the middle of its exposure."""

    def __init__(self, tracks: track_kernels.Tracks, tuning: track_kernels.Tuning) -> None:
        self._tracks, self._tuning = tracks, tuning
        n = len(tracks.rest_px)
        self._correct = bind(correction.correct, tracks, tuning)
        self._compare = bind(correction.compare, tracks)
        self._shift = bind(track_kernels.shift, tracks)
        self._everyone = np.arange(n)
        self._by_px, self._astray = np.empty((n, 2)), np.empty(n, np.bool_)
        self._expected_px, self._spread_px = np.empty((n, 2)), np.empty(n)

    def follow(self, frame: Frame, blobs: Blobs) -> None:
        """Moves all tracks to the blobs of a frame, where no events come between frames."""
        frames_alone.follow(
            frame.t_us,
            frame.exposure_end_us,
            blobs.centroid_px,
            blobs.begin,
            self._tracks,
            self._tuning,
        )

    def apply(self, frame: Frame, blobs: Blobs) -> None:
        """Corrects all tracks by the blobs of a frame whose exposure has ended recently."""
        begin_us = min(frame.exposure_begin_us, frame.exposure_end_us - _MIN_EXPOSURE_US)
        seen, by_px = self._correct(
            begin_us, frame.t_us, frame.exposure_end_us, blobs.centroid_px, blobs.begin
        )
        if len(seen):
            self._shift(seen, by_px)

    def anchor(self, rest: RestField, *, is_followed: bool = False) -> None:
        """Corrects all tracks by a frame that shows the gel at rest; the frame may be late.

        Tracks that follow frames alone have taken their places from it already.

        At rest the position identifies each marker. A track that was elsewhere had followed a
        neighbour, so it moves to the place that its own neighbours give.
        """
        tracks, astray = self._tracks, self._astray
        n_astray = self._compare(rest.t_us, rest.position_px, _MAX_ASTRAY_PX, self._by_px, astray)
        if n_astray < 0:
            return
        if not is_followed:
            self._shift(self._everyone, self._by_px)
        if not n_astray:
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

"""Frames correct what events have let drift: tracks move to the blobs of a picture."""

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import N_MARKERS
from neurotouch_hid.messages import Frame, RestField
from neurotouch_hid.tracker import kernels
from neurotouch_hid.tracker.image import BlobFinder, Blobs
from neurotouch_hid.tracker.image import kernels as image_kernels
from neurotouch_hid.tracker.neighbours import kernels as neighbour_kernels

_GATE_PX = 3.5  # a third of the pitch: nobody else's blob
_MAX_BLUR_PX = 2.0  # smeared markers merge with their neighbours
_MIN_EXPOSURE_US = 5_000  # assumed where a recording does not say
_MAX_AREA_RATIO = 1.8  # to the median: two markers in one blob
_MAX_MISSED = 3  # sharp frames without a blob before a marker counts as lost
_MIN_MATCHED = 60  # a third; with fewer the picture or all tracks are wrong
_MAX_ASTRAY_PX = 2.0  # at rest no track that follows its own marker is farther off


class FrameCorrection:
    """Moves tracks to the blobs of a frame, as they lay in the middle of its exposure."""

    def __init__(self, tracks: kernels.Tracks, tuning: kernels.Tuning) -> None:
        self._tracks, self._tuning = tracks, tuning
        self._finder = BlobFinder()
        self._match = np.empty(N_MARKERS, np.int32)
        self._expected_px = np.empty((N_MARKERS, 2))
        self._spread_px = np.empty(N_MARKERS)
        self._stray = np.empty(N_MARKERS, np.bool_)
        self._missed = np.zeros(N_MARKERS, np.intp)

    def apply(self, frame: Frame) -> None:
        """Correct all tracks by a frame whose exposure ends now."""
        begin_us = min(frame.exposure_begin_us, frame.exposure_end_us - _MIN_EXPOSURE_US)
        begin_px = self._positions_at(begin_us)
        then_px = self._positions_at(frame.t_us)
        end_px = self._positions_at(frame.exposure_end_us)
        if begin_px is None or then_px is None or end_px is None:
            return
        sharp = np.hypot(*(end_px - begin_px).T) <= _MAX_BLUR_PX
        blobs = self._finder.find(frame.pixels)
        points = blobs.centroid_px
        if len(points) < _MIN_MATCHED:
            return
        blob = self._assign(then_px, blobs, sharp)
        seen = blob >= 0
        if seen.sum() < _MIN_MATCHED:
            return
        kernels.shift(np.flatnonzero(seen), points[blob[seen]] - then_px[seen], self._tracks)
        self._tracks.lost[seen] = False
        self._missed[seen] = 0
        self._tracks.lost[self._missed >= _MAX_MISSED] = True

    def anchor(self, rest: RestField) -> None:
        """Correct all tracks by a frame that shows the gel at rest, however late that is known.

        At rest the position tells who is who. So a track that was elsewhere then has followed a
        neighbour: it is put where its own neighbours say that it is now.
        """
        then_px = self._positions_at(rest.t_us)
        if then_px is None:
            return
        tracks = self._tracks
        error = rest.position_px - then_px
        astray = np.hypot(*error.T) > _MAX_ASTRAY_PX
        kernels.shift(np.flatnonzero(~astray), error[~astray], tracks)
        tracks.lost[~astray & (self._missed < _MAX_MISSED)] = False
        if not astray.any():
            return
        t_us = float(tracks.state[:, kernels.T].max())
        now_px = tracks.state[:, :2].copy()
        self._expect(now_px, ~astray)
        unknown = ~np.isfinite(self._expected_px)
        self._expected_px[unknown] = rest.position_px[unknown]
        kernels.place(np.flatnonzero(astray), self._expected_px[astray], 1.0, t_us, tracks)
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

    def _positions_at(self, t_us: int) -> NDArray[np.float64] | None:
        """All positions (177, 2) px at a moment in the past, None if nobody remembers it."""
        times, past_px = self._tracks.past_us, self._tracks.past_px
        step = self._tuning.check_us
        part = t_us % step / step
        before = np.flatnonzero(times == t_us // step * step)
        after = np.flatnonzero(times == -(-t_us // step) * step)
        if not len(before):
            return None
        later = after[0] if len(after) else before[0]  # the moment is after the last check
        px: NDArray[np.float64] = past_px[:, before[0]] * (1.0 - part) + past_px[:, later] * part
        return px

    def _assign(
        self, then_px: NDArray[np.float64], blobs: Blobs, sharp: NDArray[np.bool_]
    ) -> NDArray[np.int32]:
        """The blob of each track, -1 where none is certain.

        First each to the nearest, if both agree. Pairs whose place does not fit their neighbours
        are undone; then lost markers look around the place the neighbours give them.
        """
        points, area = blobs.centroid_px, blobs.area_px
        merged = area > _MAX_AREA_RATIO * np.median(area)
        blob = np.empty(N_MARKERS, np.int32)
        image_kernels.match_points(then_px, points, _GATE_PX, blob)
        self._missed[sharp & (blob == -1)] += 1
        blob[~sharp | ((blob >= 0) & merged[blob])] = -1
        lost = self._tracks.lost | (self._missed > 0)
        for _ in range(3):
            seen = blob >= 0
            position = then_px.copy()
            position[seen] = points[blob[seen]]
            self._expect(position, seen)
            neighbour_kernels.strays(
                position,
                self._expected_px,
                self._spread_px,
                self._tuning.max_stray_px,
                self._tuning.max_stray_ratio,
                self._stray,
            )
            blob[self._stray & seen] = -1
            lost |= self._stray
            known = np.isfinite(self._expected_px[:, 0])
            open_ = np.flatnonzero((blob < 0) & lost & sharp & known)
            if not len(open_):
                break
            free = np.setdiff1d(np.flatnonzero(~merged), blob[blob >= 0])
            match = np.empty(len(open_), np.int32)
            if not image_kernels.match_points(
                self._expected_px[open_], points[free], _GATE_PX, match
            ):
                break
            blob[open_[match >= 0]] = free[match[match >= 0]]
        return blob

"""Corrects tracks near rest by pictures drawn from events, while a camera sends no frames.

A gel that creeps back makes too few events for motion, so tracks stop short. All its events since
the last rest, summed up, still show where the dots are. Far from rest they do not: pixels over
which dots have passed are a few events too bright or too dark.
"""

import math

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import Gel, fit_rig
from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX
from neurotouch_hid.tracker.blobs import BlobConfig, BlobFinder
from neurotouch_hid.tracker.event_camera import FADE_US, FULL_SHARE, RATIO, SIGMA
from neurotouch_hid.tracker.kernels import correction
from neurotouch_hid.tracker.kernels import event_camera as kernels
from neurotouch_hid.tracker.kernels.tracks import Tracks, Tuning, shift

_PERIOD_US = 20_000  # from one picture to the next
_NEAR_PX = 1.5  # from rest; farther off, pictures count four fingers as three
_USUAL_FULL = 13.0  # events of a dot that has left its place, at thresholds of 0.2
_LEAST_FULL = 0.5  # of it; less is a dot that has moved a little
_FEW = 5  # dots that tell it
_LEARN = 0.3  # weight of the newest stroke
_EXPOSURE_US = 5_000  # a picture shows what events have told for this time


class DrawnRest:
    """Draws the gel from events, and moves the tracks that are near rest.

    Args:
        tracks: of the tracker.
        gel: the gel.
    """

    def __init__(self, tracks: Tracks, gel: Gel) -> None:
        self._tracks, self._gel = tracks, gel
        shape = (SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX)
        self._net, self._low, self._now, self._rest = (np.zeros(shape, np.float32) for _ in "nlwr")
        self._finder = BlobFinder(BlobConfig(min_clear=0))  # its pictures are smooth already
        self._full = _USUAL_FULL
        self._next_us = 0
        self.is_on = False

    def begin(self, t_us: int) -> None:
        """Takes that the gel is at rest now, at the places of ``tracks.rest_px``."""
        rest_px = self._tracks.rest_px.copy()
        if self.is_on:
            self._learn_full(rest_px)
        self._net[:] = self._low[:] = 0.0
        sigma_px = SIGMA * self._gel.dot_mm * fit_rig(rest_px, self._gel).px_per_mm
        kernels.draw_rest(rest_px, sigma_px, RATIO, math.log1p(RATIO) / self._full, self._now)
        kernels.smooth(self._now, self._rest)  # as wide as what events draw, and as deep
        self._rest *= self._full / self._rest.max()
        self._next_us, self.is_on = t_us + _PERIOD_US, True

    def end(self) -> None:
        """Takes that frames show the markers again, or that events are missing."""
        self.is_on = False

    def update(
        self, events: NDArray[np.void], t_us: int, tuning: Tuning, *, is_at_rest: bool
    ) -> None:
        """Takes the events of a slice, and corrects the tracks if a picture is due.

        Args:
            events: (m,) EVENT_DTYPE, of light dots.
            t_us: the end of the slice.
            tuning: of the filter.
            is_at_rest: nothing moves; then noise fades, and tracks stay.
        """
        kernels.add_events(events, self._net)
        if t_us < self._next_us:
            return
        self._next_us = t_us + _PERIOD_US
        kernels.smooth(self._net, self._now)
        np.minimum(self._low, self._now, out=self._low)
        if is_at_rest:
            self._net *= math.exp(-_PERIOD_US / FADE_US)
            return
        pixels = np.empty(self._net.shape, np.uint8)
        kernels.expose(self._now, self._rest, math.log1p(RATIO) / self._full, pixels)
        blobs = self._finder.find(pixels)
        tracks = self._tracks
        last_us = tracks.common["last_frame_us"].copy()
        seen, by_px = correction.correct(
            t_us - _EXPOSURE_US, t_us, t_us, blobs.centroid_px, blobs.begin, tracks, tuning
        )
        tracks.common["last_frame_us"] = last_us  # this was no frame of the camera
        state = tracks.state
        off_x, off_y = state["x"] - tracks.rest_px[:, 0], state["y"] - tracks.rest_px[:, 1]
        is_near = np.hypot(off_x, off_y)[seen] < _NEAR_PX
        if is_near.any():
            shift(seen[is_near], by_px[is_near], tracks)

    def _learn_full(self, rest_px: NDArray[np.float64]) -> None:
        """Learns from the stroke that is over how many events a dot makes that leaves its place."""
        x, y = np.rint(rest_px).astype(np.intp).T
        depth = -self._low[y.clip(0, SENSOR_HEIGHT_PX - 1), x.clip(0, SENSOR_WIDTH_PX - 1)]
        if np.count_nonzero(depth > _LEAST_FULL * self._full) >= _FEW:
            newest = float(np.percentile(depth, FULL_SHARE))
            self._full += _LEARN * (newest - self._full)

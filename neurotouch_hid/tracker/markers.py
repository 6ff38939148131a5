"""Tracks all markers: by each event, by their neighbours every 4 ms, and by each frame."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import PAPER_GEL, Gel
from neurotouch_hid.messages import EVENT_DTYPE, EventPacket, Frame, MarkerField, RestField
from neurotouch_hid.process.kernel_cache import bind
from neurotouch_hid.tracker.blobs import BlobFinder, Blobs
from neurotouch_hid.tracker.config import TrackerConfig, make_tracks
from neurotouch_hid.tracker.correction import FrameCorrection
from neurotouch_hid.tracker.flicker import Flicker, FlickerFilter
from neurotouch_hid.tracker.frame_identity import FrameIdentity
from neurotouch_hid.tracker.hot_pixels import HotPixelFilter
from neurotouch_hid.tracker.kernels import filter as kernels
from neurotouch_hid.tracker.kernels import tracks as track_kernels
from neurotouch_hid.tracker.kernels.lost_markers import FRAMELESS_US
from neurotouch_hid.tracker.kernels.rest_position import follow_rest
from neurotouch_hid.tracker.kernels.slow_motion import forget_steps
from neurotouch_hid.tracker.quiet_return import QuietReturn

_RIG_US = 300e3  # time constant with which the rest position follows a rig that may swing ...
_CREEP_US = 1e6  # ... and of one that creeps or turns, because the gel creeps back too
_DRIFT_US = 20e6  # time constant of the rest position: a rig drifts over minutes ...
_TOUCH_US = 300e6  # ... but a soft touch may last long
_EDGE = 3.0  # standard deviations from its centre to the edge of a blurred dot
_LONGEST_US = 200_000  # longest time that one rest position counts for
_EVENTLESS_US = 1_000_000  # after this time without an event, frames alone show where markers go
_FLICKER_LAG = 0.45  # of the lead: the events that remain come this much later than in steady light
_MAX_HOLE_US = 100_000  # after a longer gap, positions do not identify the markers
_SHOWN_DRIFT_PX = 0.1  # later stages do not see smaller changes of the rest position


@dataclass(frozen=True, slots=True)
class TrackerStats:
    """Counts of the tracker so far.

    Attributes:
        n_events: number of events.
        n_anchors: number of rest positions.
        n_gaps: how often events were missing.
        n_repairs: how often a marker was moved to the place that its neighbours gave.
        n_valid: number of markers that are measured now.
    """

    n_events: int
    n_anchors: int
    n_gaps: int
    n_repairs: int
    n_valid: int


class MarkerTracker:
    """Follows the markers of a gel from the first rest position on.

    Attributes:
        has_events: the camera has sent an event.
        follows_frames: no events come, so that frames alone show where the markers go.
    """

    def __init__(
        self,
        config: TrackerConfig | None = None,
        finder: BlobFinder | None = None,
        gel: Gel = PAPER_GEL,
        *,
        looks_late: bool = False,
    ) -> None:
        """Starts without a gel; the first ``anchor`` gives one.

        Args:
            config: of the event filter.
            finder: finds the blobs of frames, see ``RestDetector``.
            gel: the gel.
            looks_late: leave it to the caller to call ``look`` after each slice, when there is
                time.
        """
        self._config = config or TrackerConfig()
        self._tuning, self._blur_px = self._config.tuning(), 0.0
        self._gel, n = gel, gel.n_markers
        self._all = np.arange(n, dtype=np.int32)
        self._nowhere_px = np.full((n, 2), np.nan, np.float32)
        self._nowhere_px.setflags(write=False)
        self._tracks = make_tracks(gel.neighbours, self._config)
        self._last_frame_us = self._tracks.common["last_frame_us"]  # a view
        self._filter = bind(kernels.filter_slice, self._tracks, self._tuning)
        self._finder = finder or BlobFinder(gel=gel)
        self._correction = FrameCorrection(self._tracks, self._tuning)
        self._identity = FrameIdentity(self._tracks, self._tuning, gel)
        self._hot = HotPixelFilter(looks_late=looks_late)
        self._flicker = FlickerFilter(looks_late=looks_late)
        self._return = QuietReturn(self._tracks)
        self._rest_px = np.full((n, 2), np.nan, np.float32)
        self._anchored = False
        self._anchor_us = 0
        self._end_us: int | None = None
        self._n_events = self._n_anchors = self._n_gaps = 0
        self.has_events, self.follows_frames, self._flicker_prevails = False, False, False
        self._event_us = 0  # the end of the last slice with events
        self._last_pixels: NDArray[np.uint8] | None = None
        self._n_mean = 0  # frames in the mean that the rest position is

    @property
    def flicker(self) -> Flicker | None:
        """The flicker of the light in the last quarter of a second, None if it is steady."""
        return self._flicker.flicker

    @property
    def is_frameless(self) -> bool:
        """True while the markers are followed by events, and no frame has shown them for 0.5 s."""
        if not self._anchored or self._end_us is None or self.follows_frames:
            return False
        return bool(self._end_us - self._last_frame_us.item() >= FRAMELESS_US)

    @property
    def is_unsure(self) -> bool:
        """True while frames alone do not tell the markers apart, because they move too fast."""
        return self._identity.is_unsure

    def anchor(self, rest: RestField) -> None:
        """Takes a rest position, which may be late: ``rest.t_us`` is the time that it shows.

        The first one is taken as it is, and so is one that shows other markers. Otherwise the rest
        position moves with the rig, and each marker's own place follows: at first as the mean of
        the frames so far, then slowly.
        """
        measured = rest.position_px.astype(np.float64)
        self._anchored = self._anchored and not rest.is_new
        tracks, elapsed_us = self._tracks, rest.t_us - self._anchor_us
        self._n_anchors += 1
        tracks.common["rest_noise_hz"] = tracks.common["noise_hz"]
        if rest.blur_px != self._blur_px:
            self._widen(rest.blur_px)
        self._n_mean = self._follow_rest(measured, elapsed_us) if self._anchored else 0
        if not self._n_mean:
            tracks.rest_px[:], self._n_mean = measured, 1
        if not self._anchored:
            t_us = float(rest.t_us if self._end_us is None else self._end_us)
            everyone = np.arange(self._gel.n_markers)
            track_kernels.place(everyone, measured, 1.0, t_us, tracks, self._tuning)
            self._restart(int(t_us))
            tracks.common["placed_us"] = int(t_us)
            self._anchored = True
        self._anchor_us = rest.t_us
        self._identity.anchor()
        self._correction.anchor(rest, is_followed=self.follows_frames)
        if not np.abs(self._rest_px - tracks.rest_px).max() < _SHOWN_DRIFT_PX:
            self._rest_px = tracks.rest_px.astype(np.float32)

    def update(self, packet: EventPacket) -> MarkerField:
        """Returns all markers at the end of a slice."""
        begin_us, end_us = packet.t_begin_us, packet.t_end_us
        n, n_events = len(self._all), len(packet.events)
        if n_events:
            self.has_events, self._event_us = True, end_us
        self._finder.is_fine = not self.has_events
        is_alone = not self.has_events or end_us - self._event_us > _EVENTLESS_US
        if is_alone is not self.follows_frames:
            self.follows_frames = is_alone
            self._tracks.common["frames_alone"] = is_alone
        events = self._gel.lighten_events(packet.events)
        if not events.flags.carray:
            events = np.array(events, EVENT_DTYPE)
        events = self._hot.update(events, begin_us, end_us)
        events = self._flicker.update(events, begin_us, end_us)
        prevails = self.flicker is not None and self.flicker.prevails
        if prevails is not self._flicker_prevails:
            self._flicker_prevails = prevails
            self._tracks.common["event_lag"] = _FLICKER_LAG if prevails else 0.0
        if not self._anchored:
            return self._unknown(end_us)
        if packet.gap or self._end_us != begin_us:
            self._n_gaps += self._end_us is not None
            if packet.gap and begin_us - (self._end_us or 0) > _MAX_HOLE_US:
                self._anchored = False
                return self._unknown(end_us)
            self._restart(begin_us)
        position_px, valid = np.empty((n, 2), np.float32), np.empty(n, np.bool_)
        start = 0
        for frame in packet.frames:
            until_us = min(frame.exposure_end_us, end_us)
            start = self._filter(events, start, until_us, position_px, valid)
            self._correct(frame, self._finder.find(frame.pixels))
        self._filter(events, start, end_us, position_px, valid)
        self._end_us = end_us
        self._n_events += n_events
        return MarkerField(end_us, self._rest_px, position_px, valid, self._gel)

    def look(self) -> None:
        """Looks for hot pixels and for flicker, now and then; see ``looks_late``."""
        self._hot.look()
        self._flicker.look()

    def find_return(self) -> RestField | None:
        """Returns all markers if events alone show that the gel has just come back to rest.

        The caller gives them to ``anchor``, unless a hand may rest on the gel.
        """
        if self._end_us is None:
            return None
        rest_px = self._return.find(self._end_us)
        return None if rest_px is None else RestField(self._end_us, rest_px.astype(np.float32))

    def forget(self) -> None:
        """Knows no places any more, because the gel is lost, until the next ``anchor``."""
        self._anchored = False

    def correct(self, frame: Frame, blobs: Blobs) -> None:
        """Corrects the tracks by the blobs found in a frame of an earlier slice.

        A frame that ``update`` has followed already changes nothing.
        """
        if self._anchored and frame.t_us > self._identity.frame_us:
            self._correct(frame, blobs)

    def stats(self) -> TrackerStats:
        """Returns the counts so far."""
        return TrackerStats(
            self._n_events,
            self._n_anchors,
            self._n_gaps,
            int(self._tracks.common["n_repairs"][0]),
            int((~self._tracks.lost).sum()) if self._anchored else 0,
        )

    def _correct(self, frame: Frame, blobs: Blobs) -> None:
        if not self.follows_frames:
            self._correction.apply(frame, blobs)
            return
        # A camera that has no new picture in time may send the last one again.
        if self._last_pixels is None or frame.pixels.data != self._last_pixels.data:
            self._identity.remember()
            self._correction.follow(frame, blobs)
            self._identity.judge(frame.t_us, blobs)
        self._last_pixels = frame.pixels

    def _follow_rest(self, measured_px: NDArray[np.float64], elapsed_us: int) -> int:
        """Moves the rest position towards a measured one, see ``follow_rest``.

        It hardly follows where a soft touch looked like rest. The whole gel drifts together. Errors
        of single markers beyond that come from a touch, or from the gel that creeps back after one.
        """
        elapsed = min(max(elapsed_us, 0), _LONGEST_US)
        return int(
            follow_rest(
                measured_px,
                self._n_mean,
                -math.expm1(-elapsed / _RIG_US),
                -math.expm1(-elapsed / _CREEP_US),
                elapsed / _DRIFT_US,
                elapsed / _TOUCH_US,
                self._all,
                self._tracks.rest_px,
            )
        )

    def _widen(self, blur_px: float) -> None:
        """Takes the events of dots out of focus, which are farther from their centres.

        A track that lags a little would lose the events ahead of it, and those behind it would hold
        it back. Lists of near markers do not reach as far.
        """
        self._blur_px, tuning = blur_px, self._config.tuning()
        gate_px = _EDGE * blur_px
        if gate_px > tuning.gate_px:
            spread_px = gate_px / tuning.gate_px * tuning.spread_px
            tuning = tuning._replace(gate_px=gate_px, spread_px=spread_px, search_all=True)
        self._tuning = tuning
        self._filter = bind(kernels.filter_slice, self._tracks, tuning)

    def _unknown(self, t_us: int) -> MarkerField:
        self._end_us = t_us
        nowhere_px, unmeasured = self._nowhere_px, np.zeros(self._gel.n_markers, np.bool_)
        return MarkerField(t_us, nowhere_px, nowhere_px, unmeasured, self._gel)

    def _restart(self, t_us: int) -> None:
        """Forgets velocities and the past, because events are missing, but keeps positions."""
        tracks = self._tracks
        state = tracks.state
        for name in ("vx", "vy", "cov_xv", "lead_x", "lead_y", "ahead_x", "ahead_y"):
            state[name] = 0.0
        state["excess"] = state["excess_hz"] = 0.0
        state["var_x"], state["var_v"], state["t_us"] = 1.0, 100.0, t_us
        track_kernels.aim(float(t_us), tracks, self._tuning)
        forget_steps(tracks)
        tracks.n_new[:] = 0
        tracks.past_us[:] = -1
        check_us = self._config.check_us
        tracks.common["next_check_us"] = -(-t_us // check_us) * check_us

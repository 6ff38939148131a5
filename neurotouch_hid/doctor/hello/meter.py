"""Measures a rig from a person's strokes: noise, dots in motion, the gel's return, its rim."""

from collections import deque
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import Gel
from neurotouch_hid.messages import (
    SENSOR_HEIGHT_PX,
    SENSOR_WIDTH_PX,
    EventPacket,
    Frame,
    Gesture,
    GestureKind,
    Step,
    no_gesture,
)
from neurotouch_hid.source.simulator.nuisances.chip import READ_EVENTS, READ_GREY_DN, SWEEP_US
from neurotouch_hid.tracker import BlobFinder

REST_US: Final = 5_000_000
"""Rest that gives steady figures; what comes after it may be the beginning of a touch."""
_SETTLED_US: Final = 1_000_000
"""A gel without a gesture for this long has come back as far as it does at once."""
_SAME_STROKE_US: Final = 200_000
"""A gesture that is back after less than this is the same stroke."""
LEAST_MM: Final = 1.5
"""A weaker gesture is no stroke."""
_FAST_PX_S: Final = 20.0
"""A slower dot may only tremble."""
_LEAST_PEAK_MM: Final = 1.0
"""Dots that a stroke moves less say little of what it leaves behind."""
_SAME: Final = 0.45
"""Of the pitch: a dot this near to a place is the one of this place."""
_READOUT_US: Final = 2_000
"""After an edge of a frame's exposure; events of the readout come within it."""
_LEAST_DN: Final = 10.0
_LEAST_LIT: Final = 1_000
_CERTAIN: Final = 4.0
"""Standard deviations by which events of the readout must be more than noise."""
_HOT_HZ: Final = 20.0
_RIM: Final = 0.85
"""Of the gel's radius: dots beyond it are the rim's."""
_N_FRAMES: Final = 10


@dataclass(frozen=True, slots=True)
class Stroke:
    """A movement that has ended.

    Attributes:
        gesture: its strongest moment.
        kinds: number of slices of each kind in it.
    """

    gesture: Gesture
    kinds: dict[GestureKind, int]

    @property
    def kind(self) -> GestureKind:
        """The kind that it was recognised as for longest."""
        return max(self.kinds, key=lambda kind: self.kinds[kind])


class StrokeFinder:
    """Finds where strokes begin and end.

    Attributes:
        quiet_us: time since the last gesture.
    """

    def __init__(self) -> None:
        self.quiet_us = 0
        self._best = no_gesture(0)
        self._kinds: dict[GestureKind, int] = {}

    def take(self, step: Step) -> Stroke | None:
        """Returns the stroke that has just ended, if one has."""
        gesture = step.gesture
        if gesture.kind is not GestureKind.NONE:
            self.quiet_us = 0
            self._kinds[gesture.kind] = self._kinds.get(gesture.kind, 0) + 1
            if gesture.intensity_mm > self._best.intensity_mm:
                self._best = gesture
            return None
        self.quiet_us += step.packet.t_end_us - step.packet.t_begin_us
        if not self._kinds:
            return None
        done = Stroke(self._best, self._kinds)
        self._best, self._kinds = no_gesture(0), {}
        return done if done.gesture.intensity_mm >= LEAST_MM else None


class RestMeter:
    """Measures the gel and the sensor while nothing touches the gel.

    Attributes:
        seconds: sensor time so far.
        n_events: events in it.
        frames: the last frames.
    """

    def __init__(self) -> None:
        self.seconds, self.n_events = 0.0, 0
        self.frames: deque[Frame] = deque(maxlen=_N_FRAMES)
        self._n_on = self._n_frames = 0
        self._counts = np.zeros(SENSOR_HEIGHT_PX * SENSOR_WIDTH_PX, np.int64)
        self._counts_on = np.zeros_like(self._counts)
        self._sum = np.zeros((SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX))
        self._squares = np.zeros_like(self._sum)
        self._stamps: list[NDArray[np.int64]] = []
        self._exposures_us: list[tuple[int, int]] = []

    def take(self, packet: EventPacket) -> None:
        """Counts a slice; after five seconds, no more."""
        if 1e6 * self.seconds >= REST_US:
            return
        self.seconds += 1e-6 * (packet.t_end_us - packet.t_begin_us)
        events = packet.events
        if len(events):
            self.n_events += len(events)
            self._n_on += int(events["p"].sum())
            at = events["y"].astype(np.int64) * SENSOR_WIDTH_PX + events["x"]
            np.add.at(self._counts, at, 1)
            np.add.at(self._counts_on, at[events["p"] != 0], 1)
            self._stamps.append(events["t"].astype(np.int64))
        for frame in packet.frames:
            self.frames.append(frame)
            self._n_frames += 1
            self._sum += frame.pixels
            self._squares += np.square(frame.pixels.astype(np.float64))
            self._exposures_us.append((frame.exposure_begin_us, frame.exposure_end_us))

    @property
    def picture(self) -> NDArray[np.float64] | None:
        """The mean of all frames, (260, 346) float64; None without frames."""
        return self._sum / self._n_frames if self._n_frames else None

    def list_figures(self) -> dict[str, float | None]:
        """Returns the figures; None for what this source cannot show."""
        seconds, n_pixels = self.seconds, self._counts.size
        noise = hot = hot_hz = on = readout = grey = exposure = period = None
        if self._n_frames > 1:
            exposures = np.array(self._exposures_us, np.int64)
            exposure = float(np.median(exposures[:, 1] - exposures[:, 0]))
            period = float(np.median(np.diff(exposures[:, 0])))
        if self.n_events and seconds:
            is_hot = self._counts > _HOT_HZ * seconds
            hot = float(is_hot.sum())
            hot_hz = float(self._counts[is_hot].mean() / seconds) if is_hot.any() else None
            noise = float(self._counts[~is_hot].mean() / seconds)
            on = self._n_on / self.n_events
            readout = self._measure_readout()
        picture = self.picture
        if self._n_frames > 1 and picture is not None:
            spread = np.sqrt(np.maximum(self._squares / self._n_frames - picture**2, 0.0))
            lit = spread[picture >= _LEAST_DN]  # a darker pixel is cut at 0 and looks quiet
            if len(lit) < _LEAST_LIT:
                lit = spread
            grey = float(np.median(lit) * (self._n_frames / (self._n_frames - 1)) ** 0.5)
        return {
            "seconds": seconds,
            "frames_hz": self._n_frames / seconds if seconds else None,
            "events_hz": self.n_events / seconds if seconds and self.n_events else None,
            "noise_hz_per_px": noise,
            "hot_pixels": hot if n_pixels else None,
            "hot_hz": hot_hz,
            "on_share": on,
            "readout_ratio": readout,
            **self._measure_quiet(),
            "frame_noise_dn": grey,
            "frame_period_us": period,
            "exposure_us": exposure,
        }

    def _measure_quiet(self) -> dict[str, float | None]:
        """Returns the noise without hot pixels and readouts, and the events of the readouts.

        A DAVIS reads a frame row by row, in a sweep before its exposure and one after it. Both make
        ON events, which are compared with those of another DAVIS-346 that saw the same picture.
        """
        names = ("quiet_on_hz_per_px", "quiet_off_hz_per_px", "readout_times")
        if not self.n_events or not self.seconds:
            return dict.fromkeys(names)
        quiet = self._counts <= _HOT_HZ * self.seconds
        n_on, n_off = self._counts_on[quiet].sum(), (self._counts - self._counts_on)[quiet].sum()
        n_read, times = self._count_readout()
        per_pixel_hz = float(quiet.sum()) * self.seconds
        rates = (max(n_on - n_read, 0.0) / per_pixel_hz, n_off / per_pixel_hz, times)
        return dict(zip(names, rates, strict=True))

    def _count_readout(self) -> tuple[float, float | None]:
        """Returns the number of events of readouts, and how many times the known one this is.

        0 and None where they are too few to be told from noise, or nothing is left to compare with.
        """
        picture = self.picture
        if picture is None:
            return 0.0, None
        exposures = np.array(self._exposures_us, np.float64)
        sweeps = np.sort(np.concatenate([exposures[:, 0] - SWEEP_US, exposures[:, 1]]))
        stamps = np.concatenate(self._stamps)
        behind = np.searchsorted(sweeps, stamps, "right") - 1
        n_in = int(((behind >= 0) & (stamps - sweeps[behind] < SWEEP_US)).sum())
        in_s = 1e-6 * SWEEP_US * len(sweeps)
        out_s = self.seconds - in_s
        if out_s < 0.1 * self.seconds:
            return 0.0, None
        usual = (len(stamps) - n_in) / out_s * in_s
        more = n_in - usual
        if more < _CERTAIN * (usual * (1.0 + in_s / out_s)) ** 0.5:
            return 0.0, None
        known = len(sweeps) * float(np.interp(picture, READ_GREY_DN, READ_EVENTS).sum())
        return more, more / known

    def _measure_readout(self) -> float | None:
        """Returns how much denser events are just after the edges of exposures than elsewhere."""
        edges = np.sort(np.array(self._exposures_us, np.int64).ravel())
        if not len(edges):
            return None
        stamps = np.concatenate(self._stamps)
        behind = np.searchsorted(edges, stamps, "right") - 1
        since = stamps - edges[np.maximum(behind, 0)]
        n_near = int(((behind >= 0) & (since < _READOUT_US)).sum())
        near_s = 1e-6 * float(np.minimum(np.diff(edges), _READOUT_US).sum() + _READOUT_US)
        far_s = self.seconds - near_s
        n_far = len(stamps) - n_near
        if near_s <= 0.0 or far_s <= 0.0 or not n_far:
            return None
        return (n_near / near_s) / (n_far / far_s)


class MotionMeter:
    """Measures what strokes do to the dots.

    Args:
        gel: the gel.
        rest: what was measured at rest.
    """

    def __init__(self, gel: Gel, rest: RestMeter) -> None:
        self._gel, self._rest = gel, rest
        self._blobs = BlobFinder(gel=gel)
        self._n_events = self._path_px = 0.0
        self._last_px: NDArray[np.float32] | None = None
        self._home_px: NDArray[np.float64] | None = None
        self._peak_px = np.zeros((gel.n_markers, 2))
        self._kept: list[float] = []
        self._rim: list[float] = []
        self._is_pending, self._quiet_us = False, 0
        radius = np.hypot(*gel.points_mm.T)
        self._is_rim: NDArray[np.bool_] = np.asarray(radius > _RIM * radius.max())

    def set_home(self, step: Step) -> None:
        """Notes where the dots are before the first touch, from the frames at rest."""
        places = [self._find_places(frame, step) for frame in self._rest.frames]
        with np.errstate(all="ignore"):
            stack = np.array(places or [step.markers.position_px.astype(np.float64)])
            seen = np.isfinite(stack[..., 0]) & np.isfinite(stack[..., 1])
            total = np.where(seen[..., None], stack, 0.0).sum(axis=0)
            self._home_px = total / seen.sum(axis=0)[:, None]

    def take(self, step: Step, quiet_us: int) -> None:
        """Follows the dots through a slice.

        Args:
            step: the slice.
            quiet_us: time since the last gesture.
        """
        markers = step.markers
        if self._home_px is None or not step.gel.is_found:
            self._last_px = None
            return
        self._count_events(step)
        if step.gesture.kind is not GestureKind.NONE:
            if not self._is_pending or self._quiet_us > _SAME_STROKE_US:
                self._peak_px[:] = 0.0
            self._is_pending = True
            moved = np.where(markers.valid[:, None], markers.position_px - self._home_px, 0.0)
            larger = np.hypot(*moved.T) > np.hypot(*self._peak_px.T)
            self._peak_px[larger] = moved[larger]
        elif self._is_pending and quiet_us >= _SETTLED_US:
            self._note_return(step)
        self._quiet_us = quiet_us

    def list_figures(self) -> dict[str, float | None]:
        """Returns the figures; None for what was not seen."""
        has_events = self._path_px > 0.0 and self._n_events > 0.0
        return {
            "events_per_dot_px": self._n_events / self._path_px if has_events else None,
            "kept_share": float(np.median(self._kept)) if self._kept else None,
            "rim_share": float(np.median(self._rim)) if self._rim else None,
        }

    def _count_events(self, step: Step) -> None:
        """Adds the events of a slice in motion, without those of noise, and the dots' ways."""
        packet, now = step.packet, step.markers.position_px
        before, self._last_px = self._last_px, now.copy()
        if before is None or not self._rest.n_events or not self._rest.seconds:
            return
        seconds = 1e-6 * (packet.t_end_us - packet.t_begin_us)
        way_px = np.hypot(*(now - before).T)
        is_fast = step.markers.valid & (way_px > _FAST_PX_S * seconds)
        if is_fast.sum() < 0.2 * self._gel.n_markers:
            return
        self._path_px += float(way_px[is_fast].sum())
        noise = self._rest.n_events / self._rest.seconds * seconds
        self._n_events += max(len(packet.events) - noise, 0.0)

    def _note_return(self, step: Step) -> None:
        """Compares where the dots are after a stroke with where they were before the first one."""
        home = self._home_px
        frames = step.packet.frames
        if home is None or (self._rest.frames and not frames):
            return  # a frame says it better than the tracker, and one comes soon
        self._is_pending = False
        px_per_mm = step.gel.px_per_mm
        if px_per_mm is None:
            return
        if frames:
            left = self._find_places(frames[-1], step) - home
        else:
            left = step.markers.position_px - home
        size_px = np.hypot(*self._peak_px.T)
        used = np.isfinite(left).all(axis=1) & (size_px > _LEAST_PEAK_MM * px_per_mm)
        if used.sum() < 10:
            return
        peak = self._peak_px[used]
        # Least squares: what is left is this share of each dot's largest motion.
        self._kept.append(float((left[used] * peak).sum() / (peak * peak).sum()))
        rim = float(np.mean(size_px[self._is_rim]))
        self._rim.append(rim / float(np.percentile(size_px, 95.0)))

    def _find_places(self, frame: Frame, step: Step) -> NDArray[np.float64]:
        """Returns each marker's place in a frame at rest, (n, 2) px; NaN of one that is not seen.

        A marker is looked for near its place before the first touch.
        """
        near = step.markers.rest_px.astype(np.float64) if self._home_px is None else self._home_px
        places = np.full_like(near, np.nan)
        dots = self._blobs.find(frame.pixels).centroid_px
        px_per_mm = step.gel.px_per_mm
        if not len(dots) or px_per_mm is None:
            return places
        apart = np.hypot(*(near[:, None] - dots).transpose(2, 0, 1))
        apart = np.where(np.isfinite(apart), apart, np.inf)
        nearest = apart.argmin(axis=1)
        close = apart[np.arange(len(near)), nearest] < _SAME * self._gel.pitch_mm * px_per_mm
        places[close] = dots[nearest[close]]
        return places


def strongest(strokes: list[Stroke], kind: GestureKind | None = None) -> Gesture | None:
    """Returns the strongest moment of some strokes, or of those of a kind; None without one."""
    fitting = [each.gesture for each in strokes if kind is None or each.kind is kind]
    best = max(fitting, key=lambda gesture: gesture.intensity_mm, default=None)
    return None if best is None or kind is None else replace(best, kind=kind)

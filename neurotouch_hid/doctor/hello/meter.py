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
from neurotouch_hid.tracker import BlobFinder

REST_US: Final = 5_000_000
"""Rest that gives steady figures; what comes after it may be the beginning of a touch."""
_SETTLED_US: Final = 800_000
"""A gel without a gesture for this long has come back as far as it does at once."""
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
        self._sum = np.zeros((SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX))
        self._squares = np.zeros_like(self._sum)
        self._stamps: list[NDArray[np.int64]] = []
        self._edges_us: list[int] = []

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
            self._stamps.append(events["t"].astype(np.int64))
        for frame in packet.frames:
            self.frames.append(frame)
            self._n_frames += 1
            self._sum += frame.pixels
            self._squares += np.square(frame.pixels.astype(np.float64))
            self._edges_us += [frame.exposure_begin_us, frame.exposure_end_us]

    def list_figures(self) -> dict[str, float | None]:
        """Returns the figures; None for what this source cannot show."""
        seconds, n_pixels = self.seconds, self._counts.size
        noise = hot = on = readout = grey = None
        if self.n_events and seconds:
            is_hot = self._counts > _HOT_HZ * seconds
            hot = float(is_hot.sum())
            noise = float(self._counts[~is_hot].mean() / seconds)
            on = self._n_on / self.n_events
            readout = self._measure_readout()
        if self._n_frames > 1:
            mean = self._sum / self._n_frames
            spread = np.sqrt(np.maximum(self._squares / self._n_frames - mean**2, 0.0))
            grey = float(np.median(spread) * (self._n_frames / (self._n_frames - 1)) ** 0.5)
        return {
            "seconds": seconds,
            "frames_hz": self._n_frames / seconds if seconds else None,
            "events_hz": self.n_events / seconds if seconds and self.n_events else None,
            "noise_hz_per_px": noise,
            "hot_pixels": hot if n_pixels else None,
            "on_share": on,
            "readout_ratio": readout,
            "frame_noise_dn": grey,
        }

    def _measure_readout(self) -> float | None:
        """Returns how much denser events are just after the edges of exposures than elsewhere."""
        edges = np.sort(np.array(self._edges_us, np.int64))
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
        self._is_pending = False
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
            if not self._is_pending:
                self._peak_px[:] = 0.0
            self._is_pending = True
            moved = np.where(markers.valid[:, None], markers.position_px - self._home_px, 0.0)
            larger = np.hypot(*moved.T) > np.hypot(*self._peak_px.T)
            self._peak_px[larger] = moved[larger]
        elif self._is_pending and quiet_us >= _SETTLED_US:
            self._note_return(step)

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

"""Checks the camera's data: events and frames, the gel with its markers, and its rest."""

import math
import time
from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid import client as driver
from neurotouch_hid.doctor.event_cameras import judge_events
from neurotouch_hid.doctor.finding import Finding, approve, fail, skip, warn
from neurotouch_hid.doctor.video import judge_pictures
from neurotouch_hid.driver.camera_settings import load_camera_config
from neurotouch_hid.driver.gel_file import choose_gel
from neurotouch_hid.errors import NotRunningError
from neurotouch_hid.gel_picture import GREEN, RED, YELLOW, find_picture, save_picture
from neurotouch_hid.gel_sentences import explain_gel, name_dots
from neurotouch_hid.geometry import Gel, fit_rig
from neurotouch_hid.messages import (
    SENSOR_HEIGHT_PX,
    SENSOR_WIDTH_PX,
    EventPacket,
    Frame,
    GelState,
)
from neurotouch_hid.recording.wire import receive_packets
from neurotouch_hid.source import PictureSource, open_source
from neurotouch_hid.source.davis import find_cameras
from neurotouch_hid.source.events.source import EventCameraSource, EventsStats
from neurotouch_hid.source.video.live import VideoCameraSource, VideoStats
from neurotouch_hid.source.view import View
from neurotouch_hid.tracker import GelFinder, RestConfig, RestDetector
from neurotouch_hid.tracker.blobs import BlobFinder
from neurotouch_hid.tracker.lattice import LatticeFinder
from neurotouch_hid.vocabulary import SourceKind, find_source_kind

LOOK_S: Final = 5.0
FRAMES_HZ: Final = 25.0
_MOST_OFF_HZ: Final = 5.0
_MOST_EVENTS_HZ: Final = 500_000.0
"""Limit for a gel at rest: a tenth of the rate that the pipeline can follow."""

_LEAST_SHARE: Final = 0.9
"""Share of the markers that a good picture shows."""
LEAST_CONTRAST: Final = 40
"""Grey levels between markers and gel; the detector's own limit for a dark picture is 50."""

MOST_OFF_CENTRE_PX: Final = 25.0
"""Offset at which the outermost markers leave the picture: the dome's radius is 75 px of 130."""

_MOST_DRIFT_MM: Final = 0.3

_WATCH_US: Final = 500_000
_N_WATCHED: Final = 10
"""Frames from which a picture is judged while a person turns the lens."""

_SAME_PX: Final = 4.0
"""A dot this near to the place of a marker is that marker; markers are 10 px apart."""


@dataclass(frozen=True, slots=True)
class Seen:
    """The data of some seconds.

    Attributes:
        source: its source.
        seconds: sensor time.
        events: number of events.
        lost: number of lost events.
        frames: all frames.
        video: what a video camera counted; None if it is none.
        other: what an event camera of another maker counted; None if it is none.
        is_video: the source has pictures alone.
        view: the map from the pictures of a video camera to the frames; None of other sources.
    """

    source: str
    seconds: float
    events: int
    lost: int
    frames: tuple[Frame, ...]
    video: VideoStats | None = None
    other: EventsStats | None = None
    is_video: bool = False
    view: View | None = None


@dataclass(frozen=True, slots=True)
class GelFigures:
    """Content of the frames: the detector's last result, the first and the last markers at rest.

    Attributes:
        n_found: markers in the last frame.
        state: what the frames show of the gel.
        chamfer_px2: Chamfer distance of the last frame.
        is_at_rest: the last frame shows the gel at rest.
        first_px, last_px: (n, 2) px, the markers at rest; None if they never were.
    """

    n_found: int
    state: GelState
    chamfer_px2: float
    is_at_rest: bool
    first_px: NDArray[np.float32] | None
    last_px: NDArray[np.float32] | None


class GelView:
    """Collects data once, for five seconds, and runs three checks on it.

    Args:
        picture: path for the picture with the markers; None: a file in the cache folder.
        source: the source; None: the running driver's data, or the first camera.
        gel: name or path of the gel's file; None: the one that applies to the source.
    """

    def __init__(
        self, picture: Path | None = None, source: str | None = None, gel: str | None = None
    ) -> None:
        self._picture = picture or find_picture("doctor-gel.png")
        self._source = source
        self._is_video = False
        self._made = choose_gel(gel, source or driver.find_live_source()).gel

    def check_stream(self) -> Finding:  # noqa: PLR0911
        """Checks whether frames and events arrive at the usual rates."""
        seen = self.seen
        if seen is None:
            return skip("Needs a camera that can be opened, or a running driver.")
        if not seen.seconds:
            return fail(f"No data from {seen.source}.", "Unplug the camera and plug it in again.")
        if seen.video is not None:
            return judge_pictures(seen.source, seen.video, self._made)
        if seen.other is not None:
            return judge_events(seen.source, seen.other, seen.seconds)
        frames_hz, events_hz = len(seen.frames) / seen.seconds, seen.events / seen.seconds
        sentence = f"{seen.source}: {frames_hz:.0f} frames/s, {events_hz:,.0f} events/s."
        if not seen.frames:
            return fail(
                f"{sentence} There is no picture.",
                "Another program may have changed a setting: plug the camera in again.",
            )
        if seen.is_video:
            return approve(f"{seen.source}: {frames_hz:.0f} frames/s.")
        if not seen.events:
            return fail(f"{sentence} There are no events.", "Is the lens cap off, the lamp on?")
        if abs(frames_hz - FRAMES_HZ) > _MOST_OFF_HZ:
            return warn(sentence, f"About {FRAMES_HZ:.0f} frames/s are usual. Is it USB 3?")
        if seen.lost:
            return warn(f"{sentence} {seen.lost:,} events were lost.", "Close other programs.")
        if events_hz > _MOST_EVENTS_HZ:
            return warn(
                sentence,
                "That is a lot for a gel at rest: the lamp may flicker.",
            )
        return approve(sentence)

    def check_markers(self) -> Finding:
        """Checks whether the whole gel is in the picture, and bright enough."""
        seen, gel = self.seen, self.figures
        if seen is None or gel is None:
            return skip("Needs frames.")
        frame = seen.frames[-1]
        saved = self._save(frame, gel)
        contrast = measure_contrast(frame.pixels)
        what = (
            f"{gel.n_found} of {self._made.n_markers} markers"
            if gel.n_found
            else "No gel can be found"
        )
        sentence = f"{what}, contrast {contrast:.0f}; {saved}"
        if gel.state.problem:
            why = explain_gel(gel.state)
            judge = warn if gel.state.is_found else fail
            return judge(f"{sentence} The gel is {why.text}.", why.fix)
        fault, fix = _find_fault(gel, contrast)
        return warn(sentence + fault, fix) if fix else approve(sentence)

    def check_rest(self) -> Finding:
        """Checks whether the gel is at rest, and stays there."""
        gel = self.figures
        if gel is None:
            return skip("Needs frames.")
        if gel.first_px is None or gel.last_px is None:
            why = explain_gel(gel.state)
            return warn(
                f"The gel was never at rest. It is {why.text}.",
                f"{why.fix} If your hand has to rest on the gel: "
                "neurotouch profile set user neutral resting",
            )
        moved_px = np.hypot(*(gel.last_px - gel.first_px).T)
        drift_mm = float(np.median(moved_px)) / fit_rig(gel.last_px, self._made).px_per_mm
        drift = f"drift {drift_mm:.2f} mm in {LOOK_S:.0f} s."
        if not gel.is_at_rest:
            return warn(f"At the end the gel is touched; {drift}", "Take the hand off the gel.")
        sentence = (
            f"Chamfer distance {gel.chamfer_px2:.2f} px² (at rest up to "
            f"{RestConfig().max_chamfer_px2} px²), {drift}"
        )
        if drift_mm > _MOST_DRIFT_MM:
            return warn(
                sentence, "Something moves. Check that the gel and the camera are mounted firmly."
            )
        return approve(sentence)

    def save_boxes(self) -> str:
        """Saves the last picture with boxes, and returns a sentence with its path."""
        if self.seen is None or self.figures is None:
            return "There is no picture."
        saved = self._save(self.seen.frames[-1], self.figures)
        return f"{saved[0].upper()}{saved[1:]}"

    @cached_property
    def seen(self) -> Seen | None:
        """The data, collected once; None without a source."""
        with ExitStack() as stack:
            opened = self._open(stack)
            return None if opened is None else _collect(*opened, is_video=self._is_video)

    @cached_property
    def figures(self) -> GelFigures | None:
        """The gel as the frames show it; None without frames."""
        if self.seen is None or not self.seen.frames:
            return None
        return examine_frames(self.seen.frames, self._made)

    def watch(self) -> Iterator[Seen]:
        """Yields the newest frames twice a second, until the source ends."""
        with ExitStack() as stack:
            opened = self._open(stack, speed="recorded")
            if opened is None:
                return
            name, packets = opened
            frames: deque[Frame] = deque(maxlen=_N_WATCHED)
            told_us = 0
            for packet in packets:
                frames += packet.frames
                if not frames or packet.t_end_us - told_us < _WATCH_US:
                    continue
                told_us = packet.t_end_us
                view = packets.view if isinstance(packets, PictureSource) else None
                seconds = 1e-6 * (frames[-1].t_us - frames[0].t_us)
                is_video = self._is_video or isinstance(packets, PictureSource)
                yield Seen(name, seconds, 0, 0, tuple(frames), is_video=is_video, view=view)

    def _open(
        self, stack: ExitStack, speed: Literal["recorded", "max"] = "max"
    ) -> tuple[str, Iterable[EventPacket]] | None:
        """Returns the source's name and its packets; None without a source."""
        if self._source is not None:
            source = open_source(
                self._source,
                speed=speed,
                camera=load_camera_config(),
                gel=self._made,
                finder=GelFinder(self._made),
            )
            stack.enter_context(source)
            return f"{'SIMULATED ' if source.is_simulated else ''}{self._source}", source
        try:
            answer, line = driver.open_stream("record")
        except NotRunningError:
            free = next((info for info in find_cameras() if not info.reason), None)
            if free is None:
                return None
            camera = stack.enter_context(open_source(f"davis:{free.serial}"))
            return camera.name, camera
        stack.callback(line.close)
        line.settimeout(2 * LOOK_S)
        simulated = "SIMULATED " if answer.get("simulated") is True else ""
        self._is_video = find_source_kind(str(answer.get("source"))) is SourceKind.VIDEO
        name = f"the running driver ({simulated}{answer.get('source', 'unknown source')})"
        return name, receive_packets(line)

    def _save(self, frame: Frame, gel: GelFigures) -> str:
        """Saves the picture, and returns a sentence with its path.

        Markers are boxed green, other bright dots yellow, markers that are missing red.
        """
        dots = BlobFinder(gel=self._made).find(frame.pixels).centroid_px
        markers = np.zeros((0, 2)) if gel.last_px is None else gel.last_px.astype(np.float64)
        apart = np.hypot(*(dots[:, None] - markers).transpose(2, 0, 1)) > _SAME_PX
        lonely = apart.all(axis=1)
        unseen = markers[apart.all(axis=0)] if len(markers) else gel.state.missing_px
        boxes = {YELLOW: dots[lonely], GREEN: dots[~lonely], RED: unseen}
        save_picture(self._picture, frame.pixels, boxes)
        return f"the picture with boxes is {self._picture}."


def examine_frames(frames: Sequence[Frame], gel: Gel) -> GelFigures:
    """Returns what frames, at least one, show of a gel."""
    detector = RestDetector(gel=gel)
    fields = [detector.update(frame) for frame in frames]
    rests = [field.position_px for field in fields if field is not None]
    stats = detector.stats()
    n_found = stats.n_found
    if not rests:  # then that is the number of bright dots, markers or not
        dots = BlobFinder(gel=gel).find(frames[-1].pixels).centroid_px
        lattice = LatticeFinder(gel).find(dots)
        n_found = 0 if lattice is None else lattice.n_found
    first, last = (rests[0], rests[-1]) if rests else (None, None)
    return GelFigures(n_found, detector.gel, stats.chamfer_px2, not stats.problem, first, last)


def measure_contrast(pixels: NDArray[np.uint8]) -> float:
    """Returns the grey levels between the dots and the gel of a picture, (260, 346) uint8."""
    low, high = np.percentile(pixels, (50.0, 99.5))
    return float(high - low)


def _collect(source: str, packets: Iterable[EventPacket], *, is_video: bool) -> Seen:
    """Collects packets for five seconds, by the camera's clock or ours, whichever ends first.

    Our clock begins with the first packet: the simulator compiles its kernels before it.
    """
    deadline = math.inf
    frames: list[Frame] = []
    events = lost = 0
    begin_us = end_us = None
    for packet in packets:
        if begin_us is None:
            begin_us, deadline = packet.t_begin_us, time.monotonic() + 2 * LOOK_S
        end_us = packet.t_end_us
        events += len(packet.events)
        lost += packet.gap
        frames += packet.frames
        if end_us - begin_us >= LOOK_S * 1e6 or time.monotonic() > deadline:
            break
    seconds = 0.0 if begin_us is None or end_us is None else (end_us - begin_us) / 1e6
    return Seen(
        source,
        seconds,
        events,
        lost,
        tuple(frames),
        packets.stats() if isinstance(packets, VideoCameraSource) else None,
        packets.stats() if isinstance(packets, EventCameraSource) else None,
        is_video or isinstance(packets, PictureSource),
        packets.view if isinstance(packets, PictureSource) else None,
    )


def _find_fault(gel: GelFigures, contrast: float) -> tuple[str, str]:
    """Returns what is wrong with a gel that is found, and the fix; empty if nothing is."""
    if gel.n_found < _LEAST_SHARE * gel.state.layout.n_markers:
        missing = name_dots(gel.state.missing, gel.state.layout)
        return (
            f" Dots not seen: {missing}.",
            "Clean the gel and the lens, and light all of the gel.",
        )
    if contrast < LEAST_CONTRAST:
        return "", "The picture is faint: is the LED ring at full brightness?"
    if gel.last_px is not None:
        centre = fit_rig(gel.last_px, gel.state.layout).centre_px
        off = np.subtract(centre, ((SENSOR_WIDTH_PX - 1) / 2, (SENSOR_HEIGHT_PX - 1) / 2))
        if np.hypot(*off) > MOST_OFF_CENTRE_PX:
            return (
                f" The gel is {off[0]:+.0f} px, {off[1]:+.0f} px off the middle.",
                "Turn the camera until the gel is in the middle of the picture.",
            )
    return "", ""

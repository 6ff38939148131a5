"""A video camera as a source: plugged in, unplugged and plugged in again."""

import logging
import math
import time
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, replace
from statistics import median
from typing import Final

import numpy as np

from neurotouch_hid.errors import CameraError
from neurotouch_hid.recording import Picture
from neurotouch_hid.source.camera_errors import CameraAbsentError
from neurotouch_hid.source.camera_source import MAX_DELAY_US, POLL_S, CameraSource
from neurotouch_hid.source.video.camera import VideoCamera
from neurotouch_hid.source.video.config import VideoConfig
from neurotouch_hid.source.video.enumeration import (
    VideoInfo,
    find_video_cameras,
    select_video_cameras,
)
from neurotouch_hid.source.video.modes import Mode
from neurotouch_hid.source.video.source import PictureSlicer
from neurotouch_hid.source.video.v4l2 import Linux
from neurotouch_hid.source.video.view_search import GelFinder
from neurotouch_hid.source.view import View

SLICES_US: Final = (4_000, 10_000)
"""Shortest and longest slice: one picture each, where its rate allows that."""
SILENCE_S: Final = 2.0
"""A camera that sends no usable picture for this long has failed."""
START_S: Final = 5.0
"""The same before its first picture."""
SEARCH_S: Final = 1.5
"""How long a camera is watched for a gel, if there are several."""
_SLOW: Final = 0.8
"""Share of the stated rate below which a camera counts as slow."""
_RATE_PICTURES: Final = 30
_LEARN: Final = 1 / 8  # weight of a picture in the estimate of the period
_MOST_GROWTH: Final = 4.0  # periods; a longer time between two pictures is a pause, not a rate
_MOST_PICTURES: Final = 64
"""Pictures that may wait for a recorder."""
_WARM_SIZE: Final = (720, 960)

log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class VideoStats:
    """Counts and state of a video camera.

    Attributes:
        info: the camera; None before one was opened.
        mode: the pictures that it agreed to send.
        exposure_us: their exposure; None if the camera does not say.
        lacking: what could not be fixed, a sentence each.
        fps: pictures/s that come; 0 before the first.
        n_connects: times it was opened.
        n_pictures: pictures that were read.
        n_lost: pictures that were lost.
        n_damaged: pictures that could not be read.
        n_unstamped: pictures without a usable stamp.
        latency_us: median from the stamp of a picture to its packet; 0 before the first.
        trouble: why it does not stream, or an empty string.
    """

    info: VideoInfo | None
    mode: Mode | None
    exposure_us: int | None
    lacking: tuple[str, ...]
    fps: float
    n_connects: int
    n_pictures: int
    n_lost: int
    n_damaged: int
    n_unstamped: int
    latency_us: float
    trouble: str


class VideoCameraSource(CameraSource):
    """Slices of a video camera's time, as pictures arrive.

    After a camera was unplugged, the same one is waited for: at its place, or elsewhere by its
    name. Then the slices continue, later by the time it was away; the first has a ``gap``.

    Args:
        camera: its device node, its place such as ``usb-0000:00:14.0-2``, or a part of its name.
            If empty, the only camera; of several, the only one that shows a gel.
        config: how it is set up.
        finder: finds the gel in pictures; without, they are shown whole.
        slice_us: length of a slice; without, it suits the camera's rate.
        wait: a camera need not be there yet.
        max_delay_us: slices that wait longer for the pipeline are dropped: old data moves no stick.
        linux: the calls into Linux.

    Raises:
        CameraBusyError: another program has the camera.
        CameraError: it cannot be used; never raised with ``wait``.
    """

    def __init__(
        self,
        camera: str = "",
        config: VideoConfig | None = None,
        *,
        finder: GelFinder | None = None,
        slice_us: int | None = None,
        wait: bool = False,
        max_delay_us: int = MAX_DELAY_US,
        linux: Linux | None = None,
    ) -> None:
        super().__init__(max_delay_us // (slice_us or SLICES_US[0]))
        self._chosen = camera
        self._config = config or VideoConfig()
        self._finder, self._slice_us = finder, slice_us
        self._linux = linux or Linux()
        self._info: VideoInfo | None = None
        self._present: tuple[VideoInfo, ...] = ()
        self._others: set[str] = set()  # places of the cameras beside the one that played last
        self._camera: VideoCamera | None = None
        self._played: VideoCamera | None = None
        self._counts = (0, 0, 0)  # of the cameras before
        self._origin_us: int | None = None
        self._end_us = 0
        self._period_s = 0.0
        self._said: set[str] = set()
        self._pictures: deque[Picture] | None = None
        self._slicer: PictureSlicer | None = None
        self._n_dropped = self._n_pictures = 0
        self._latencies_us: deque[int] = deque(maxlen=250)
        self.name = f"video:{camera}"
        _load_kernels(finder)
        if not wait:
            self._open()

    @property
    def view(self) -> View | None:
        """The map from the camera's pictures to the frames; None before the first picture."""
        return None if self._slicer is None else self._slicer.view

    def pictures(self) -> Iterator[Picture]:
        """Yields the camera's pictures as they arrive, instead of packets."""
        self._pictures = pictures = deque[Picture]()
        for _ in self.poll():
            while pictures:
                yield pictures.popleft()

    @property
    def n_lost(self) -> int:
        """Pictures that were lost, or could not be read."""
        stats = self.stats()
        return stats.n_lost + stats.n_damaged

    @property
    def period_s(self) -> float:
        """Time from picture to picture, as it was lately; 0 before the first."""
        return self._period_s

    @property
    def n_restarts(self) -> int:
        """Times it was started again because its data made no sense: never."""
        return 0

    def stats(self) -> VideoStats:
        """Returns counts of what happened so far."""
        camera = self._played
        n_lost, n_damaged, n_unstamped = self._counts
        if camera is not None:
            n_lost += camera.n_lost
            n_damaged += camera.n_damaged
            n_unstamped += camera.n_unstamped
        latencies = self._latencies_us.copy()
        return VideoStats(
            info=self._info,
            mode=None if camera is None else camera.mode,
            exposure_us=None if camera is None else camera.exposure_us,
            lacking=() if camera is None else camera.lacking,
            fps=1.0 / self._period_s if self._period_s else 0.0,
            n_connects=self._n_connects,
            n_pictures=self._n_pictures,
            n_lost=n_lost + self._n_dropped,
            n_damaged=n_damaged,
            n_unstamped=n_unstamped,
            latency_us=float(median(latencies)) if latencies else 0.0,
            trouble=self._trouble,
        )

    def _open(self) -> None:
        if self._camera is not None:
            return
        self._present = find_video_cameras(self._linux)
        candidates = self._list_candidates()
        try:
            info = candidates[0] if len(candidates) == 1 else self._find_gel(candidates)
            self._camera = VideoCamera(info.node, self._config, self._linux)
        except CameraAbsentError:
            raise
        except CameraError:
            self._n_failures += 1
            raise
        self._info = info
        self.name = f"video:{info.place}"
        self._others = {each.bus_info for each in self._present if each != info}

    def _list_candidates(self) -> tuple[VideoInfo, ...]:
        """Returns the cameras to choose from: the one that played last, or those of the name.

        Of several of one model, the one that played last is known by its place, or by a new place.
        """
        before = self._info
        if before is None:
            return select_video_cameras(self._present, self._chosen)
        same = [info for info in self._present if info.name == before.name]
        there = [info for info in same if info.bus_info == before.bus_info]
        moved = [info for info in same if info.bus_info not in self._others]
        if not (there or moved):
            raise CameraAbsentError(f"The camera {before.name} is not plugged in.")
        return tuple(there or moved)[:1]

    def _find_gel(self, candidates: tuple[VideoInfo, ...]) -> VideoInfo:
        """Returns the only camera that shows a gel.

        Raises:
            CameraError: none shows one, or several do.
        """
        showing = [info for info in candidates if not info.reason and self._shows_gel(info)]
        if len(showing) == 1:
            log.info("The camera %s shows the gel.", showing[0])
            return showing[0]
        names = ", ".join(map(str, showing or candidates))
        if showing:
            raise CameraError(
                f"Several cameras show a gel: {names}.",
                hint=f"Choose one, for example: --source video:{showing[0].node}",
            )
        raise CameraError(
            f"None of {len(candidates)} cameras shows a gel: {names}.",
            hint=f"Choose one, for example: --source video:{candidates[0].node}",
        )

    def _shows_gel(self, info: VideoInfo) -> bool:
        """Watches a camera for a moment."""
        slicer = PictureSlicer(self._finder, SLICES_US[1], mirrored=self._config.mirrored)
        try:
            with VideoCamera(info.node, self._config, self._linux) as camera:
                camera.start()
                deadline = time.monotonic() + SEARCH_S
                while time.monotonic() < deadline and not self._closing.is_set():
                    picture = camera.take(POLL_S)
                    if picture is not None:
                        for _ in slicer.push(
                            picture.pixels, picture.exposure_begin_us, picture.exposure_end_us
                        ):
                            pass
                    if slicer.is_found:
                        return True
        except CameraError as error:
            log.info("%s", error.message)
        return False

    def _release(self) -> None:
        if self._camera is not None:
            self._camera.close()
            self._camera = None

    def _is_replugged(self) -> bool:
        return find_video_cameras(self._linux) != self._present

    def _describe(self) -> str:
        return self._chosen if self._info is None else self._info.place

    def _play(self) -> None:
        camera, self._camera = self._camera, None
        if camera is None:
            return
        before = self.stats()
        self._counts = before.n_lost - self._n_dropped, before.n_damaged, before.n_unstamped
        self._played = camera
        with camera:
            self._say(camera)
            camera.start()
            interval_us = 1e6 * float(camera.mode.interval)
            self._period_s = 1e-6 * interval_us
            slice_us = self._slice_us or round(min(max(interval_us, SLICES_US[0]), SLICES_US[1]))
            # A picture brings all slices since the one before it at once.
            self._queue.make_room(2 * math.ceil(interval_us / slice_us))
            self._slicer = PictureSlicer(self._finder, slice_us, mirrored=self._config.mirrored)
            self._run(camera, self._slicer)

    def _run(self, camera: VideoCamera, slicer: PictureSlicer) -> None:
        """Hands over the slices of a camera until it fails or the source is closed."""
        heard_s = begun_s = time.monotonic()
        silence_s = max(SILENCE_S, 4.0 * self._period_s)
        n_pictures = n_lost = 0
        while not self._closing.is_set():
            looked_s = time.monotonic()
            picture = camera.take(POLL_S, keeps_jpeg=self._pictures is not None)
            if picture is None:
                if looked_s - heard_s > (silence_s if n_pictures else START_S):
                    what = "only damaged pictures" if camera.n_damaged else "no pictures"
                    raise CameraError(f"The camera {camera.name} sends {what}.")
                continue
            now_s = time.monotonic()
            if n_pictures == 0:
                self._start(picture)
                begun_s, n_lost = now_s, camera.n_lost
            else:
                self._learn_period(now_s - heard_s)
            heard_s = now_s
            self._hand_over(slicer, picture, is_first=n_pictures == 0)
            self._latencies_us.append(time.monotonic_ns() // 1000 - camera.stamp_us)
            n_pictures += 1
            self._n_pictures += 1
            if n_pictures == _RATE_PICTURES:
                n_sent = n_pictures - 1 + camera.n_lost - n_lost
                self._check_rate(camera, n_sent / max(now_s - begun_s, 1e-6))

    def _start(self, picture: Picture) -> None:
        """Notes the first picture; its time is never before the end of the last slice."""
        latest_us = picture.exposure_end_us - self._end_us
        origin_us = latest_us if self._origin_us is None else min(self._origin_us, latest_us)
        self._origin_us = origin_us
        self._note_start(picture.exposure_end_us - origin_us)

    def _hand_over(self, slicer: PictureSlicer, picture: Picture, *, is_first: bool) -> None:
        origin_us = self._origin_us or 0
        end_us = picture.exposure_end_us - origin_us
        exposure_us = picture.exposure_end_us - picture.exposure_begin_us
        gap = int(is_first and self._n_connects > 1)
        if self._pictures is not None:
            self._keep(
                replace(picture, exposure_begin_us=end_us - exposure_us, exposure_end_us=end_us)
            )
            self._end_us = end_us + 1
            return
        for packet in slicer.push(picture.pixels, end_us - exposure_us, end_us):
            self._queue.put(replace(packet, gap=gap) if gap else packet)
            self._end_us = max(self._end_us, packet.t_end_us)
            gap = 0
        self._note_progress(self._end_us)

    def _keep(self, picture: Picture) -> None:
        """Keeps a picture for the recorder; one that finds no room is lost."""
        if self._pictures is None or len(self._pictures) >= _MOST_PICTURES:
            self._n_dropped += 1
            return
        self._pictures.append(replace(picture, pixels=picture.pixels.copy()))

    def _learn_period(self, since_s: float) -> None:
        since_s = min(since_s, _MOST_GROWTH * self._period_s)
        self._period_s += _LEARN * (since_s - self._period_s)

    def _check_rate(self, camera: VideoCamera, fps: float) -> None:
        if fps < _SLOW * camera.mode.fps:
            self._say_once(
                f"The camera {camera.name} sends {fps:.0f} pictures/s instead of "
                f"{camera.mode.fps:.0f}."
            )

    def _say(self, camera: VideoCamera) -> None:
        log.info("The camera %s sends %s.", camera.name, camera.mode)
        for sentence in camera.lacking:
            self._say_once(f"The camera {camera.name}: {sentence}")

    def _say_once(self, sentence: str) -> None:
        if sentence not in self._said:
            self._said.add(sentence)
            log.warning("%s", sentence)


def _load_kernels(finder: GelFinder | None) -> None:
    """Compiles or loads what pictures need, so that no picture waits for it."""
    slicer = PictureSlicer(finder, SLICES_US[0])
    for _ in slicer.push(np.zeros(_WARM_SIZE, np.uint8), 0, 0):
        pass

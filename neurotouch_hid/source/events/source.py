"""An event camera as a source: plugged in, unplugged and plugged in again."""

import logging
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Final

from neurotouch_hid.errors import CameraBusyError, CameraError
from neurotouch_hid.geometry import PAPER_GEL, Gel
from neurotouch_hid.messages import EventPacket
from neurotouch_hid.recording import Sensor
from neurotouch_hid.source.camera_errors import CameraAbsentError, CameraGoneError
from neurotouch_hid.source.camera_source import MAX_DELAY_US, POLL_S, CameraSource, Watch
from neurotouch_hid.source.events.config import EventsConfig
from neurotouch_hid.source.events.enumeration import (
    EventCameraInfo,
    choose_event_camera,
    find_event_cameras,
)
from neurotouch_hid.source.events.gel_place import find_region, place_gel
from neurotouch_hid.source.events.library import Device, Library, Status, load_library
from neurotouch_hid.source.events.models import DAVIS, make_configuration, make_ring
from neurotouch_hid.source.events.plugged import list_plugged
from neurotouch_hid.source.events.reader import ClockJumpError, PacketReader, load_kernels
from neurotouch_hid.source.slice_pacer import SlicePacer
from neurotouch_hid.source.strobe.decoder import Strobe
from neurotouch_hid.source.view import View

SILENCE_S: Final = 2.0
"""A camera that is silent this long has failed: each sends its time all the while."""
SETTLE_S: Final = 0.2
"""Between a failure and closing the camera. The library aborts the whole program if it closes one
that was unplugged before Linux has given back all transfers."""
ASK_S: Final = 10.0
"""The library stops all threads while it lists cameras. One that is missing is looked for as often
where Linux lists the same cameras as before."""

log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class EventsStats:
    """Counts and state of an event camera.

    Attributes:
        info: the camera; None before one was opened.
        n_connects: times it was opened.
        n_events: its events.
        n_shown: those that the pipeline's picture got; a pixel of it may stand for several.
        n_lost: buffers that were lost on the way, and times that went back.
        n_cleared: times that data which was too old was thrown away.
        limited_us: time during which the camera dropped events, at its own limit.
        n_restarts: times it was started again because its times made no sense.
        trouble: why it does not stream, or an empty string.
    """

    info: EventCameraInfo | None
    n_connects: int
    n_events: int
    n_shown: int
    n_lost: int
    n_cleared: int
    limited_us: int
    n_restarts: int
    trouble: str


class EventCameraSource(CameraSource):
    """Slices of an event camera's time, in the canonical picture.

    After a camera was unplugged, the same one is waited for, by model and number. Then the slices
    continue, later by the time it was away; the first has a ``gap``.

    Args:
        camera: its serial number, or a part of its model's name; if empty, the only camera.
        config: how it is set up.
        gel: the gel that it sees.
        slice_us: length of a slice.
        part_us: length of the parts in which slices come while the gel moves; without, they come
            whole.
        wait: a camera need not be there yet.
        max_delay_us: data that waits longer is thrown away: old data moves no stick.
        library: the library, or what behaves like it.
        plugged: lists the cameras at the USB without the library.
        clock_s: the host's clock.

    Raises:
        CameraBusyError: another program has the camera.
        CameraError: it cannot be used, or the extra is missing; with ``wait``, only the latter.
    """

    def __init__(
        self,
        camera: str = "",
        config: EventsConfig | None = None,
        *,
        gel: Gel = PAPER_GEL,
        slice_us: int = 10_000,
        part_us: int | None = None,
        wait: bool = False,
        max_delay_us: int = MAX_DELAY_US,
        library: Library | None = None,
        plugged: Callable[[], frozenset[str]] = list_plugged,
        clock_s: Callable[[], float] = time.monotonic,
    ) -> None:
        super().__init__(max_delay_us // slice_us)
        self._library = library or load_library()
        self._chosen, self._config, self._gel = camera, config or EventsConfig(), gel
        self._slice_us, self._max_delay_s = slice_us, 1e-6 * max_delay_us
        self._clock_s = clock_s
        self._pacer, self._part_us = SlicePacer(slice_us), part_us
        strobe = self._config.strobe
        self._strobe = None if strobe is None else Strobe(strobe)
        self._info: EventCameraInfo | None = None
        self._list_plugged = plugged
        self._plugged: frozenset[str] = frozenset()
        self._ask_s = 0.0  # until then, only a change of the USB is a reason to ask the library
        self._device: Device | None = None
        self._reader: PacketReader | None = None
        self._view: View | None = None
        self._ended_s = 0.0
        self._before = (0, 0, 0, 0)  # counts of the readers before
        self._n_cleared = self._n_restarts = 0
        self._is_limited = self._keeps_size = False
        self.name = f"events:{camera}"
        if not wait:
            self._open()

    def set_activity(self, *, is_idle: bool, wants_frames: bool = True) -> None:  # noqa: ARG002
        """Sets whether idle slices may be merged."""
        self._pacer.is_idle = is_idle

    @property
    def sensor(self) -> Sensor | None:
        """The camera's own picture; None before a camera was opened."""
        info = self._info
        if info is None:
            return None
        return Sensor(info.model.title, info.model.width_px, info.model.height_px)

    def sensor_packets(self) -> Iterator[EventPacket]:
        """Yields slices in the camera's own pixels, all its events, instead of canonical ones."""
        self._keeps_size = True
        return iter(self)

    @property
    def n_restarts(self) -> int:
        """Times it was started again because its times made no sense."""
        return self._n_restarts

    def stats(self) -> EventsStats:
        """Returns counts of what happened so far."""
        n_events, n_shown, n_lost, limited_us = self._count()
        return EventsStats(
            self._info,
            self._n_connects,
            n_events,
            n_shown,
            n_lost,
            self._n_cleared,
            limited_us,
            self._n_restarts,
            self._trouble,
        )

    def _count(self) -> tuple[int, int, int, int]:
        reader = self._reader
        if reader is None:
            return self._before
        counts = reader.n_events, reader.n_shown, reader.n_lost, reader.limited_us
        n_events, n_shown, n_lost, limited_us = map(sum, zip(self._before, counts, strict=True))
        return n_events, n_shown, n_lost, limited_us

    def _open(self) -> None:
        if self._device is not None:
            return
        before, self._plugged = self._plugged, self._list_plugged()
        played, now_s = self._info, self._clock_s()
        if played is not None and before == self._plugged and now_s < self._ask_s:
            raise CameraAbsentError(f"The camera {played} is not plugged in.")
        self._ask_s = now_s + ASK_S
        info = self._choose(find_event_cameras(self._library))
        self._ask_s = 0.0
        if info.reason:
            self._n_failures += 1
            kind = CameraBusyError if info.reason.startswith("in use") else CameraError
            raise kind(f"The camera {info} cannot be used: {info.reason}.")
        view = place_gel(info.model, self._config, self._gel)
        configuration = make_configuration(
            self._library, info.model, self._config, find_region(view)
        )
        load_kernels(view, has_frames=info.model == DAVIS)  # before the camera sends anything
        try:
            self._device = self._library.open(
                configuration=configuration,
                iterator_timeout=POLL_S,
                serial=info.serial or None,
                ring_configuration=make_ring(self._library, info.model),
            )
        except RuntimeError as error:
            self._n_failures += 1
            raise CameraError(f"The camera {info} cannot be opened: {error}.") from error
        self._info, self._view = info, view
        self.name = info.source

    def _choose(self, cameras: tuple[EventCameraInfo, ...]) -> EventCameraInfo:
        """Returns the camera that played last, or that of the name."""
        before = self._info
        if before is None:
            return choose_event_camera(cameras, self._chosen)
        for info in cameras:
            if (info.model, info.serial) == (before.model, before.serial):
                return info
        raise CameraAbsentError(f"The camera {before} is not plugged in.")

    def _release(self) -> None:
        if self._device is not None:
            self._device.close()
            self._device = None

    def _is_replugged(self) -> bool:
        return self._list_plugged() != self._plugged

    def _describe(self) -> str:
        return self._chosen if self._info is None else str(self._info)

    def _pause(self, watch: Watch) -> None:
        # The pad is neutral by now. The library stops all threads while it closes a camera.
        time.sleep(SETTLE_S)
        self._release()
        super()._pause(watch)

    def _play(self) -> None:
        device = self._device
        if device is None or self._view is None or self._info is None:
            return
        begin_us, gap = self._find_begin()
        self._before = self._count()
        limit = self._config.max_events_per_s if self._info.model.has_limit else 0
        reader = PacketReader(
            self._view,
            self._slice_us,
            begin_us,
            self._hand_over,
            max_events_per_s=limit,
            keeps_size=self._keeps_size,
            clock_s=self._clock_s,
        )
        reader.note_lost(gap)
        self._reader = reader
        try:
            self._run(device, reader)
        except RuntimeError as error:  # of the library
            kind = CameraGoneError if self._is_replugged() else CameraError
            raise kind(f"The camera {self._info} has failed: {error}.") from error
        finally:
            self._ended_s = self._clock_s()

    def _find_begin(self) -> tuple[int, int]:
        """Returns when the stream goes on, and what is missing before: nothing at the start."""
        if self._reader is None:
            return 0, 0
        away_us = int(1e6 * (self._clock_s() - self._ended_s))
        n_before = -(-self._reader.end_us // self._slice_us)
        return (n_before + away_us // self._slice_us + 1) * self._slice_us, 1

    def _run(self, device: Device, reader: PacketReader) -> None:
        """Hands over the slices of a camera until it fails or the source is closed."""
        heard_s, has_begun = self._clock_s(), False
        while not self._closing.is_set():
            looked_s = self._clock_s()
            status, packet = next(device)
            if status.ring is None or packet is None:
                if looked_s - heard_s > SILENCE_S:
                    raise CameraError(f"The camera {self._info} sends nothing.")
                continue
            heard_s = self._clock_s()
            if not has_begun:
                has_begun = True
                self._note_start(reader.end_us)
            reader.read(status.ring, packet)
            self._clear_old(device, reader, status)
            self._note_limit(reader)

    def _clear_old(self, device: Device, reader: PacketReader, status: Status) -> None:
        """Throws data away that has waited for too long."""
        ring = status.ring
        if ring is None or not ring.backlog:
            return
        if status.system_time - ring.system_time > self._max_delay_s:
            device.clear_backlog(until=1)
            self._n_cleared += 1
            reader.note_lost(ring.backlog)

    def _note_limit(self, reader: PacketReader) -> None:
        if reader.limited_us and not self._is_limited:
            self._is_limited = True
            log.warning(
                "The camera %s has reached its limit of %d events/s and drops the rest. Less "
                "light that flickers, a smaller picture of the gel, or a higher "
                "max_events_per_s in camera.yaml would help.",
                self._info,
                self._config.max_events_per_s,
            )

    def _hand_over(self, packet: EventPacket) -> int | None:
        """Queues a slice, and returns in which parts the next ones come, as ``DavisSource`` does.

        A strobe is found by whole slices.
        """
        is_behind = not self._queue.is_empty
        if self._strobe is not None and not self._keeps_size:
            packet = self._strobe.take(packet)
        for whole in self._pacer.take(packet):
            self._queue.put(whole)
        self._note_progress(packet.t_end_us)
        if self._strobe is not None or is_behind or not self._pacer.wants_parts:
            return None
        return self._part_us

    def _note(self, error: CameraError) -> None:
        self._n_restarts += isinstance(error, ClockJumpError)
        super()._note(error)

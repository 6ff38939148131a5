"""The camera as a source: plugged in, unplugged and plugged in again."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Final, Protocol

from neurotouch_hid.errors import CameraError
from neurotouch_hid.messages import EventPacket
from neurotouch_hid.source.camera_errors import CameraAbsentError
from neurotouch_hid.source.camera_source import MAX_DELAY_US, CameraSource, Watch
from neurotouch_hid.source.davis.camera import Camera
from neurotouch_hid.source.davis.config import DavisConfig
from neurotouch_hid.source.davis.decoder import Decoder, DecoderStats
from neurotouch_hid.source.davis.enumeration import CameraInfo
from neurotouch_hid.source.davis.kernels.transfers import load_pump
from neurotouch_hid.source.davis.stream import Stream
from neurotouch_hid.source.davis.stream_check import OutOfStepError
from neurotouch_hid.source.davis.transport import Transport
from neurotouch_hid.source.davis.usb import Usb
from neurotouch_hid.source.slice_pacer import SlicePacer

_ANY_WORD: Final = b"\x01\x00"


class Cameras(Protocol):
    """Finds and opens cameras: ``Usb``, or a scripted one in tests."""

    def choose(self, serial: str) -> CameraInfo:
        """Returns the camera of a serial number, or the first one."""
        ...

    def open(self, info: CameraInfo) -> Transport:
        """Returns the open camera, claimed by this process."""
        ...

    def watch(self) -> Watch:
        """Returns a watch that waits for cameras."""
        ...


@dataclass(frozen=True, slots=True)
class DavisStats:
    """Counts and state of a camera source.

    Attributes:
        serial: of the camera, empty before one was seen.
        connected: whether it streams now.
        n_connects: times it was opened.
        n_faults: transfers that failed.
        n_dropped: events that the camera itself dropped.
        n_restarts: times it was started again because its data made no sense.
        trouble: why it does not stream, or an empty string.
        decoder: counts of malformed data since it was last opened.
    """

    serial: str = ""
    connected: bool = False
    n_connects: int = 0
    n_faults: int = 0
    n_dropped: int = 0
    n_restarts: int = 0
    trouble: str = ""
    decoder: DecoderStats = field(default_factory=DecoderStats)


class DavisSource(CameraSource):
    """Slices of the time of a DAVIS.

    When the camera is back after it was unplugged, the slices continue, later by the time it was
    away; the first has a ``gap``.

    Args:
        serial: of the camera, with or without leading zeros. If empty, the first camera is used,
            or another one that is present when the first is gone.
        config: how it is set up.
        slice_us: length of a slice.
        part_us: length of the parts in which slices come while the gel moves; without, they come
            whole.
        wait: a camera need not be there yet.
        max_delay_us: slices that wait longer for the pipeline are dropped: old data moves no stick.
        cameras: where they come from.
        sleep_s: how to wait for a camera that is being set up.

    Attributes:
        name: ``davis:`` and the serial.
        rig: None, it is found from the resting frame.

    Raises:
        CameraBusyError: another program has the camera.
        CameraError: it cannot be used; never raised with ``wait``.
    """

    def __init__(
        self,
        serial: str = "",
        config: DavisConfig | None = None,
        *,
        slice_us: int = 10_000,
        part_us: int | None = None,
        wait: bool = False,
        max_delay_us: int = MAX_DELAY_US,
        cameras: Cameras | None = None,
        sleep_s: Callable[[float], None] = time.sleep,
    ) -> None:
        super().__init__(max_delay_us // slice_us)
        self._config = config or DavisConfig()
        self._cameras = cameras or Usb()
        self._sleep_s = sleep_s
        self._chosen = self._serial = serial
        self._slice_us, self._part_us = slice_us, part_us
        self._pacer = SlicePacer(slice_us)
        self._wants_frames = True
        self._stream: Stream | None = None
        self._n_restarts = 0
        self._info: CameraInfo | None = None
        self._camera = None if wait else self._connect()
        Decoder().decode(_ANY_WORD)  # compiles or loads; a refusal comes before it
        load_pump()
        self.name = f"davis:{self._serial}"

    def set_activity(self, *, is_idle: bool, wants_frames: bool = True) -> None:
        """Sets whether idle slices may be merged, and partial slices delivered early."""
        self._pacer.is_idle, self._wants_frames = is_idle, wants_frames

    @property
    def n_restarts(self) -> int:
        """Times it was started again because its data made no sense."""
        return self._n_restarts

    def stats(self) -> DavisStats:
        """Returns counts of what happened so far."""
        stream = self._stream
        return DavisStats(
            self._serial,
            not self._trouble and stream is not None,
            self._n_connects,
            stream.n_faults if stream else 0,
            stream.n_dropped if stream else 0,
            self._n_restarts,
            self._trouble,
            stream.stats() if stream else DecoderStats(),
        )

    def _open(self) -> None:
        self._camera = self._camera or self._connect()

    def _release(self) -> None:
        if self._camera is not None:
            self._camera.transport.close()
            self._camera = None

    def _make_watch(self) -> Watch:
        return self._cameras.watch()

    def _is_replugged(self) -> bool:
        return self._look() != self._info

    def _describe(self) -> str:
        return self._serial

    def _look(self) -> CameraInfo | None:
        """Returns the camera that would be opened now, or None."""
        try:
            return self._choose()
        except CameraError:
            return None

    def _connect(self) -> Camera:
        """Returns the camera, ready to start."""
        self._info = info = self._choose()
        camera = Camera(info, self._cameras.open(info), self._sleep_s)
        try:
            camera.check()
            camera.silence()
            camera.configure(self._config)
        except CameraError:
            camera.transport.close()
            raise
        self._serial = info.serial or self._serial
        return camera

    def _choose(self) -> CameraInfo:
        """Returns the chosen camera.

        Without a choice the one that played last, or else the first.
        """
        try:
            return self._cameras.choose(self._serial)
        except CameraAbsentError:
            if self._chosen:
                raise
            return self._cameras.choose("")

    def _play(self) -> None:
        camera, self._camera = self._camera, None
        if camera is None:
            return
        try:
            self._stream = Stream(
                camera,
                self._config,
                self._slice_us,
                self._hand_over,
                lambda: None if self._wants_frames else self._pacer.find_calm(),
                self._stream,
            )
            self._note_start(self._stream.end_us)
            self._stream.run(self._closing)
        finally:
            camera.stop()
            camera.transport.close()

    def _hand_over(self, packet: EventPacket) -> int | None:
        """Queues a slice, and returns in which parts the next ones come.

        A pipeline that is behind catches up sooner with whole slices.
        """
        if packet.is_partial:
            if self._pacer.takes_partials:
                self._queue.offer(packet)
            return None
        is_behind = not self._queue.is_empty
        for whole in self._pacer.take(packet):
            self._queue.put(whole)
            self._note_progress(whole.t_end_us)
        return self._part_us if self._pacer.wants_parts and not is_behind else None

    def _note(self, error: CameraError) -> None:
        self._n_restarts += isinstance(error, OutOfStepError)
        super()._note(error)

"""The camera as a source: plugged in, unplugged and plugged in again."""

import logging
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import dataclass, field
from typing import Final, Protocol

from neurotouch_hid.closing import Closing
from neurotouch_hid.errors import CameraError
from neurotouch_hid.geometry import Rig
from neurotouch_hid.messages import EventPacket
from neurotouch_hid.source.camera_errors import CameraAbsentError, CameraGoneError
from neurotouch_hid.source.davis.camera import Camera
from neurotouch_hid.source.davis.config import DavisConfig
from neurotouch_hid.source.davis.decoder import Decoder, DecoderStats
from neurotouch_hid.source.davis.enumeration import CameraInfo
from neurotouch_hid.source.davis.stream import Stream
from neurotouch_hid.source.davis.stream_check import OutOfStepError
from neurotouch_hid.source.davis.transport import Transport
from neurotouch_hid.source.davis.usb import Usb, Watch
from neurotouch_hid.source.idle import IdleMerger
from neurotouch_hid.source.packet_queue import PacketQueue

MAX_DELAY_US: Final = 100_000
POLL_S: Final = 0.05
"""A loop over ``poll`` never waits longer."""
RETRY_S: Final = 0.5
"""How often an unplugged camera is looked for if no event reports it."""
LONGEST_PAUSE_S: Final = 30.0
"""Between two starts of a camera that fails again and again; the pause doubles up to here."""
WELL_US: Final = 10_000_000
"""A camera that has played this long is no longer one that fails again and again."""

_ANY_WORD: Final = b"\x01\x00"

log = logging.getLogger(__name__)


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


class DavisSource(Closing):
    """Slices of a camera's time, as they happen; it may be iterated once.

    A separate thread keeps the camera open. While the camera is unplugged, no slices come. When it
    is back, the slices continue, later by the time it was away; the first has a ``gap``.

    Args:
        serial: of the camera, with or without leading zeros. If empty, the first camera is used,
            or another one that is present when the first is gone.
        config: how it is set up.
        slice_us: length of a slice.
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

    is_live = True
    is_simulated = False

    def __init__(
        self,
        serial: str = "",
        config: DavisConfig | None = None,
        *,
        slice_us: int = 10_000,
        wait: bool = False,
        max_delay_us: int = MAX_DELAY_US,
        cameras: Cameras | None = None,
        sleep_s: Callable[[float], None] = time.sleep,
    ) -> None:
        self.rig: Rig | None = None
        self._config = config or DavisConfig()
        self._cameras = cameras or Usb()
        self._sleep_s = sleep_s
        self._chosen = self._serial = serial
        self._slice_us = slice_us
        self._merger = IdleMerger()
        self._wants_frames = True
        self._queue = PacketQueue(max(1, max_delay_us // slice_us))
        self._closing = threading.Event()
        self._thread: threading.Thread | None = None
        self._stream: Stream | None = None
        self._trouble = ""
        self._away = False
        self._vanished = False
        self._n_connects = self._n_restarts = 0
        self._n_failures = 0  # in a row, each less than WELL_US after the start
        self._begun_us = 0
        self._info: CameraInfo | None = None
        self._camera = None if wait else self._connect()
        Decoder().decode(_ANY_WORD)  # compiles or loads; a refusal comes before it
        self.name = f"davis:{self._serial}"

    def __iter__(self) -> Iterator[EventPacket]:
        return (packet for packet in self.poll() if packet is not None)

    def poll(self) -> Iterator[EventPacket | None]:
        """Yields the packets as they arrive, and None whenever none arrived for POLL_S.

        Raises:
            CameraError: the camera thread has failed; a camera that fails is waited for.
        """
        if self._thread is None:
            self._thread = threading.Thread(target=self._work, name="camera", daemon=True)
            self._thread.start()
        while not self._queue.has_ended:
            yield self._queue.take(POLL_S)
        if not self._closing.is_set():
            raise CameraError("The camera's thread has ended; this is a bug in the driver.")

    def set_activity(self, *, is_idle: bool, wants_frames: bool = True) -> None:
        """Sets whether idle slices may be merged, and partial slices delivered early."""
        self._merger.is_idle, self._wants_frames = is_idle, wants_frames

    @property
    def is_blind(self) -> bool:
        """True if Linux listed a camera at the last attempt, but opening it found none."""
        return self._vanished

    @property
    def trouble(self) -> str:
        """The reason why it does not stream, in a sentence; empty while it does."""
        return self._trouble

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

    def close(self) -> None:
        """Stops and releases the camera; ends a waiting iteration. Any thread may call it."""
        self._closing.set()
        self._queue.end()
        if self._thread is not None:
            self._thread.join()
        if self._camera is not None:  # it has never been played
            self._camera.transport.close()
            self._camera = None

    def _work(self) -> None:
        """Plays the camera in a thread of its own, and waits while it is unplugged."""
        try:
            with closing(self._cameras.watch()) as watch:
                while not self._closing.is_set():
                    try:
                        self._play(self._camera or self._connect())
                    except CameraError as error:
                        self._note(error)
                        self._pause(watch)
        finally:
            self._queue.end()

    def _pause(self, watch: Watch) -> None:
        """Waits for the next attempt: longer after each failure, unless the camera is replugged."""
        pause_s = min(RETRY_S * 2 ** max(0, self._n_failures - 1), LONGEST_PAUSE_S)
        for _ in range(round(pause_s / RETRY_S)):
            watch.wait(RETRY_S)
            if self._closing.is_set():
                return
            if self._n_failures and self._look() != self._info:
                self._n_failures = 0
                return

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

    def _play(self, camera: Camera) -> None:
        """Plays a camera until it fails or the source is closed."""
        self._camera = None
        try:
            self._stream = Stream(
                camera,
                self._config,
                self._slice_us,
                self._hand_over,
                lambda: self._merger.is_calm and not self._wants_frames,
                self._stream,
            )
            if self._trouble and self._n_failures < 2:
                log.warning("The camera %s plays.", self._serial)
            self._trouble, self._away = "", False
            self._vanished = False
            self._n_connects += 1
            self._begun_us = self._stream.end_us
            self._stream.run(self._closing)
        except CameraError:
            self._n_failures += 1
            raise
        finally:
            camera.stop()
            camera.transport.close()

    def _hand_over(self, packet: EventPacket) -> None:
        if packet.is_partial:
            if self._merger.takes_partials:
                self._queue.offer(packet)
            return
        for whole in self._merger.take(packet):
            self._queue.put(whole)
        if self._n_failures and packet.t_end_us - self._begun_us >= WELL_US:
            if self._n_failures > 1:
                log.warning("The camera %s plays.", self._serial)
            self._n_failures = 0

    def _note(self, error: CameraError) -> None:
        """Logs why the camera does not stream: each reason once, and its absence only once.

        Of a camera that fails again and again, only the second failure is logged.
        """
        known, self._trouble = self._trouble, error.message
        was_away, self._away = self._away, isinstance(error, CameraGoneError | CameraAbsentError)
        self._vanished = isinstance(error, CameraGoneError)
        self._n_restarts += isinstance(error, OutOfStepError)
        if self._away:
            self._n_failures = 0
        if error.message == known or (was_away and self._away) or self._n_failures > 2:
            return
        if self._n_failures == 2:
            log.warning(
                "%s It fails again and again, so it is started again less and less often, "
                "at least every %.0f s.",
                error.message,
                LONGEST_PAUSE_S,
            )
        else:
            log.warning("%s The gamepad works again as soon as the camera does.", error.message)

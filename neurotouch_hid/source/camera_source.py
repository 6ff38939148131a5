"""The part of a source that all cameras share: a thread, a queue, a way back after a failure."""

import logging
import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Iterator
from contextlib import closing
from typing import Final, Protocol

from neurotouch_hid.closing import Closing
from neurotouch_hid.errors import CameraError
from neurotouch_hid.geometry import Rig
from neurotouch_hid.messages import EventPacket
from neurotouch_hid.source.camera_errors import CameraAbsentError, CameraGoneError
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

log = logging.getLogger(__name__)


class Watch(Protocol):
    """Waits for cameras to come and go."""

    def wait(self, timeout_s: float) -> None:
        """Returns at the next change, or after the timeout."""
        ...

    def close(self) -> None:
        """Stops listening."""
        ...


class PatientWatch:
    """Receives no messages, so it always waits for the whole timeout."""

    def wait(self, timeout_s: float) -> None:
        """Returns after the timeout."""
        time.sleep(timeout_s)

    def close(self) -> None:
        """Does nothing: there is nothing to stop."""


class CameraSource(Closing, ABC):
    """Slices of a camera's time, as they happen; it may be iterated once.

    A separate thread keeps the camera open, and opens it again after a failure. While the camera
    is unplugged, no slices come. A subclass says how it is opened and played.

    Args:
        limit: slices that may wait for the pipeline; older ones are dropped.

    Attributes:
        name: the source as the user may write it.
        rig: None, it is found from the resting frame.
    """

    is_live = True
    is_simulated = False
    name: str

    def __init__(self, limit: int) -> None:
        self.rig: Rig | None = None
        self._queue = PacketQueue(max(1, limit))
        self._closing = threading.Event()
        self._thread: threading.Thread | None = None
        self._trouble = ""
        self._away = self._vanished = False
        self._n_connects = 0
        self._n_failures = 0  # in a row, each less than WELL_US after the start
        self._begun_us = 0

    def __iter__(self) -> Iterator[EventPacket]:
        return (packet for packet in self.poll() if packet is not None)

    def poll(self) -> Iterator[EventPacket | None]:
        """Yields the packets as they arrive; None if none did for POLL_S, or the camera fails.

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

    @property
    def is_blind(self) -> bool:
        """True if Linux listed a camera at the last attempt, but opening it found none."""
        return self._vanished

    @property
    def trouble(self) -> str:
        """The reason why it does not stream, in a sentence; empty while it does."""
        return self._trouble

    def close(self) -> None:
        """Stops and releases the camera; ends a waiting iteration. Any thread may call it."""
        self._closing.set()
        self._queue.end()
        if self._thread is not None:
            self._thread.join()
        self._release()

    @abstractmethod
    def _open(self) -> None:
        """Opens the camera, unless it is open."""

    @abstractmethod
    def _play(self) -> None:
        """Plays the open camera until it fails or the source is closed; closes it."""

    @abstractmethod
    def _release(self) -> None:
        """Closes a camera that was opened, but never played."""

    def _make_watch(self) -> Watch:
        """Returns a watch that waits for cameras."""
        return PatientWatch()

    @abstractmethod
    def _is_replugged(self) -> bool:
        """Returns whether other cameras are plugged in than at the last attempt."""

    @abstractmethod
    def _describe(self) -> str:
        """Returns the camera's name for a sentence."""

    def _work(self) -> None:
        """Plays the camera in a thread of its own, and waits while it is unplugged."""
        try:
            with closing(self._make_watch()) as watch:
                while not self._closing.is_set():
                    try:
                        self._open()
                        try:
                            self._play()
                        except CameraError:
                            self._n_failures += 1
                            raise
                    except CameraError as error:
                        self._note(error)
                        self._queue.wake()
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
            if self._n_failures and self._is_replugged():
                self._n_failures = 0
                return

    def _note_start(self, begin_us: int) -> None:
        """Notes that the camera streams, from this time of its clock on."""
        if self._trouble and self._n_failures < 2:
            log.warning("The camera %s plays.", self._describe())
        self._trouble, self._away = "", False
        self._vanished = False
        self._n_connects += 1
        self._begun_us = begin_us

    def _note_progress(self, end_us: int) -> None:
        """Notes that the camera has played up to this time of its clock."""
        if self._n_failures and end_us - self._begun_us >= WELL_US:
            if self._n_failures > 1:
                log.warning("The camera %s plays.", self._describe())
            self._n_failures = 0

    def _note(self, error: CameraError) -> None:
        """Logs why the camera does not stream: each reason once, and its absence only once.

        Of a camera that fails again and again, only the second failure is logged.
        """
        known, self._trouble = self._trouble, error.message
        was_away, self._away = self._away, isinstance(error, CameraGoneError | CameraAbsentError)
        self._vanished = isinstance(error, CameraGoneError)
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

"""Writes a recording in a separate thread, through a queue with a limit."""

import threading
from collections import deque
from dataclasses import dataclass
from typing import Final

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.messages import EventPacket
from neurotouch_hid.recording.writer import RecordingWriter

QUEUE_BYTES: Final = 64 << 20
"""Limit of the queue: 0.8 s at 5 million events/s, minutes of an ordinary gel."""


@dataclass(frozen=True, slots=True)
class RecorderStats:
    """Counts of a recording so far.

    Attributes:
        seconds: sensor time from the first packet written to the end of the last.
        events: events written.
        frames: frames written.
        lost_before: events lost earlier, in the camera or the driver.
        lost_here: events that the recorder dropped, because the disk was slower than the camera.
        size_bytes: length of the file.
    """

    seconds: float
    events: int
    frames: int
    lost_before: int
    lost_here: int
    size_bytes: int


class Recorder:
    """Writes packets in a separate thread; the caller never waits unless it asks to.

    A failed write ends the recording, not the caller: ``error`` has the reason.

    Args:
        writer: writes the file; ``close`` closes it.
        queue_bytes: limit of the queue, in bytes.

    Attributes:
        error: why nothing is written any more, or None.
    """

    def __init__(self, writer: RecordingWriter, *, queue_bytes: int = QUEUE_BYTES) -> None:
        self.error: RecordingError | None = None
        self._writer = writer
        self._room = queue_bytes
        self._queue: deque[EventPacket] = deque()
        self._waiting = 0  # bytes
        self._changed = threading.Condition()
        self._ending = False
        self._first_us: int | None = None
        self._end_us = 0
        self._events = self._frames = self._lost_before = self._lost_here = 0
        self._thread = threading.Thread(target=self._work, name="recorder", daemon=True)
        self._thread.start()

    def take(self, packet: EventPacket, *, wait: bool = False) -> bool:
        """Queues a packet for writing; False without room, and then its events count as lost.

        Args:
            packet: the packet; it must not change afterwards.
            wait: wait for room instead, for sources that can be stopped.
        """
        size = _size_of(packet)
        with self._changed:
            while wait and self._waiting and self._waiting + size > self._room and not self.error:
                self._changed.wait()
            self._lost_before += packet.gap
            if self.error or (self._waiting and self._waiting + size > self._room):
                self._lost_here += len(packet.events)
                return False
            self._queue.append(packet)
            self._waiting += size
            self._changed.notify_all()
        return True

    def stats(self) -> RecorderStats:
        """Returns counts of the written data so far."""
        seconds = 0.0 if self._first_us is None else (self._end_us - self._first_us) / 1e6
        return RecorderStats(
            seconds,
            self._events,
            self._frames,
            self._lost_before,
            self._lost_here,
            self._writer.size_bytes,
        )

    def close(self) -> None:
        """Writes the queue, finishes the file, ends the thread; a second call does nothing."""
        with self._changed:
            self._ending = True
            self._changed.notify_all()
        self._thread.join()

    def _work(self) -> None:
        try:
            while (packet := self._next()) is not None:
                self._writer.write(packet)
                self._count(packet)
        except RecordingError as error:
            with self._changed:
                self.error = error
                self._lost_here += sum(len(packet.events) for packet in self._queue)
                self._queue.clear()
                self._waiting = 0
                self._changed.notify_all()
        finally:
            self._writer.close()

    def _next(self) -> EventPacket | None:
        """Returns the next packet; None when all is written and no more will come."""
        with self._changed:
            while not self._queue:
                if self._ending:
                    return None
                self._changed.wait()
            packet = self._queue.popleft()
            self._waiting -= _size_of(packet)
            self._changed.notify_all()
        return packet

    def _count(self, packet: EventPacket) -> None:
        if self._first_us is None:
            self._first_us = packet.t_begin_us
        self._end_us = packet.t_end_us
        self._events += len(packet.events)
        self._frames += len(packet.frames)


def _size_of(packet: EventPacket) -> int:
    """Returns the size of a packet in memory, in bytes; an empty one counts too."""
    return 64 + packet.events.nbytes + sum(frame.pixels.nbytes for frame in packet.frames)

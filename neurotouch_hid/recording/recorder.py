"""Writes a recording in a separate thread, through a queue with a limit."""

import threading
from collections import deque
from dataclasses import dataclass
from typing import Final, Protocol

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.messages import EventPacket
from neurotouch_hid.recording.clip import Picture

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


Item = EventPacket | Picture
"""One thing to write: a slice, or a picture of a sensor of any size."""


class Writer(Protocol):
    """Writes a recording's file."""

    @property
    def size_bytes(self) -> int:
        """The file's present size."""
        ...

    def write(self, item: Item, /) -> None:
        """Appends an item; items come in order of time.

        Raises:
            RecordingError: the file does not take it.
        """
        ...

    def close(self) -> None:
        """Finishes the file."""
        ...


class Recorder:
    """Writes packets or pictures in a separate thread; the caller never waits unless it asks to.

    A failed write ends the recording, not the caller: ``error`` has the reason.

    Args:
        writer: writes the file; ``close`` closes it.
        queue_bytes: limit of the queue, in bytes.

    Attributes:
        error: why nothing is written any more, or None.
    """

    def __init__(self, writer: Writer, *, queue_bytes: int = QUEUE_BYTES) -> None:
        self.error: RecordingError | None = None
        self._writer = writer
        self._room = queue_bytes
        self._queue: deque[Item] = deque()
        self._waiting = 0  # bytes
        self._changed = threading.Condition()
        self._ending = False
        self._first_us: int | None = None
        self._end_us = 0
        self._events = self._frames = self._lost_before = self._lost_here = 0
        self._thread = threading.Thread(target=self._work, name="recorder", daemon=True)
        self._thread.start()

    def take(self, item: Item, *, wait: bool = False) -> bool:
        """Queues an item for writing; False without room, and then what it has counts as lost.

        Args:
            item: the item; it must not change afterwards.
            wait: wait for room instead, for sources that can be stopped.
        """
        size = _size_of(item)
        with self._changed:
            while wait and self._waiting and self._waiting + size > self._room and not self.error:
                self._changed.wait()
            if isinstance(item, EventPacket):
                self._lost_before += item.gap
            if self.error or (self._waiting and self._waiting + size > self._room):
                self._lost_here += _count_contents(item)
                return False
            self._queue.append(item)
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
            while (item := self._next()) is not None:
                self._writer.write(item)
                self._count(item)
        except RecordingError as error:
            with self._changed:
                self.error = error
                self._lost_here += sum(map(_count_contents, self._queue))
                self._queue.clear()
                self._waiting = 0
                self._changed.notify_all()
        finally:
            self._writer.close()

    def _next(self) -> Item | None:
        """Returns the next item; None when all is written and no more will come."""
        with self._changed:
            while not self._queue:
                if self._ending:
                    return None
                self._changed.wait()
            item = self._queue.popleft()
            self._waiting -= _size_of(item)
            self._changed.notify_all()
        return item

    def _count(self, item: Item) -> None:
        if isinstance(item, Picture):
            begin_us, end_us = item.exposure_begin_us, item.exposure_end_us
            n_events, n_frames = 0, 1
        else:
            begin_us, end_us = item.t_begin_us, item.t_end_us
            n_events, n_frames = len(item.events), len(item.frames)
        self._first_us = begin_us if self._first_us is None else self._first_us
        self._end_us = end_us
        self._events += n_events
        self._frames += n_frames


def _count_contents(item: Item) -> int:
    """Returns how many events are lost with an item, or pictures if it has no events."""
    return 1 if isinstance(item, Picture) else len(item.events)


def _size_of(item: Item) -> int:
    """Returns the size of an item in memory, in bytes; an empty one counts too."""
    if isinstance(item, Picture):
        return 64 + item.pixels.nbytes + len(item.jpeg or b"")
    return 64 + item.events.nbytes + sum(frame.pixels.nbytes for frame in item.frames)

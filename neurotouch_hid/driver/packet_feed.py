"""Sends the packets of the running driver to other programs that ask for them, as to a recorder."""

import socket
import threading
import time
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Final

from neurotouch_hid.errors import DriverError
from neurotouch_hid.messages import EventPacket, Step
from neurotouch_hid.recording.wire import send_packet

MAX_SUBSCRIBERS: Final = 4
QUEUE_BYTES: Final = 16 << 20
"""Bytes that may wait for one subscriber: 0.2 s at 5 million events/s. Then the oldest is lost."""

PATIENCE_S: Final = 10.0
"""A subscriber that takes nothing for this time makes room for another, and holds up no end."""

_LOOK_S: Final = 0.5
"""So often it is looked whether one that takes nothing is to end."""


class PacketFeed:
    """A tap. The pipeline only puts packets into queues; each subscriber has a thread of its own.

    A subscriber that is slow, or stopped for a while, loses packets, oldest first; the next one it
    gets says in its ``gap`` how many events they held.
    """

    def __init__(self) -> None:
        self._subscribers: tuple[_Subscriber, ...] = ()
        self._lock = threading.Lock()

    def __call__(self, step: Step) -> None:
        """Offers the packet of ``step`` to its subscribers; never waits."""
        for subscriber in self._subscribers:
            subscriber.offer(step.packet)

    def serve(self, connection: socket.socket) -> None:
        """Sends packets until the other end leaves or this is closed; in a thread of its own."""
        connection.settimeout(_LOOK_S)
        with self._subscribe(connection) as subscriber:
            try:
                while (packet := subscriber.take()) is not None:
                    send_packet(subscriber, packet)
            except OSError:
                return  # the other end has left

    def require_place(self) -> None:
        """Checks that one more may subscribe.

        Raises:
            DriverError: there are enough subscribers.
        """
        for subscriber in self._subscribers:
            if len(self._subscribers) >= MAX_SUBSCRIBERS and subscriber.is_stuck:
                subscriber.end()
                self._forget(subscriber)
        if len(self._subscribers) >= MAX_SUBSCRIBERS:
            raise DriverError(f"Too many programs record or watch already: {MAX_SUBSCRIBERS}.")

    def close(self) -> None:
        """Sends all subscribers what still waits for them, then the end."""
        for subscriber in self._subscribers:
            subscriber.end()

    @contextmanager
    def _subscribe(self, connection: socket.socket) -> Iterator["_Subscriber"]:
        subscriber = _Subscriber(connection)
        with self._lock:
            self._subscribers = (*self._subscribers, subscriber)
        try:
            yield subscriber
        finally:
            self._forget(subscriber)

    def _forget(self, subscriber: "_Subscriber") -> None:
        with self._lock:
            self._subscribers = tuple(each for each in self._subscribers if each is not subscriber)


class _Subscriber:
    """The queue of one subscriber, and the way to it."""

    def __init__(self, connection: socket.socket) -> None:
        self._connection = connection
        self._sent_s = time.monotonic()
        self._queue: deque[EventPacket] = deque()
        self._waiting = self._lost = 0
        self._changed = threading.Condition()
        self._ended = False

    def offer(self, packet: EventPacket) -> None:
        with self._changed:
            if not self._queue:  # it has taken all: from now on it is waited for
                self._sent_s = time.monotonic()
            self._queue.append(packet)
            self._waiting += _size_of(packet)
            while self._waiting > QUEUE_BYTES and len(self._queue) > 1:
                oldest = self._queue.popleft()
                self._waiting -= _size_of(oldest)
                self._lost += len(oldest.events) + oldest.gap
            self._changed.notify()

    @property
    def is_stuck(self) -> bool:
        """True if it has taken nothing for long, although there is something."""
        return bool(self._queue) and time.monotonic() - self._sent_s > PATIENCE_S

    def sendall(self, data: bytes | memoryview, /) -> None:
        """Sends all of it, however long a part waits, unless it is to end and is stuck."""
        left = memoryview(data).cast("B")
        while left:
            try:
                left = left[self._connection.send(left) :]
                self._sent_s = time.monotonic()
            except TimeoutError:
                if self._ended and time.monotonic() - self._sent_s > PATIENCE_S:
                    raise

    def end(self) -> None:
        with self._changed:
            self._ended = True
            self._changed.notify()

    def take(self) -> EventPacket | None:
        with self._changed:
            while not self._queue:
                if self._ended:
                    return None
                self._changed.wait()
            packet = self._queue.popleft()
            self._waiting -= _size_of(packet)
            lost, self._lost = self._lost, 0
        return replace(packet, gap=packet.gap + lost) if lost else packet


def _size_of(packet: EventPacket) -> int:
    return 64 + packet.events.nbytes + sum(frame.pixels.nbytes for frame in packet.frames)

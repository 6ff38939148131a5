"""Queues slices between camera thread and pipeline; drops the oldest ones, and counts them."""

import threading
from collections import deque
from dataclasses import replace

from neurotouch_hid.messages import EventPacket


class PacketQueue:
    """Keeps the newest slices; the ``gap`` of the next slice counts the dropped events.

    Args:
        limit: slices that may wait.
    """

    def __init__(self, limit: int) -> None:
        self._limit = limit
        self._packets: deque[EventPacket] = deque()
        self._changing = threading.Lock()
        # Free if the reader need not wait: a Condition costs each packet 4 µs more.
        self._ready = threading.Lock()
        self._ended = self._woken = False

    def make_room(self, least: int) -> None:
        """Lets at least so many slices wait."""
        with self._changing:
            self._limit = max(self._limit, least)

    def put(self, packet: EventPacket) -> None:
        """Adds a slice; drops the oldest if there are too many."""
        with self._changing:
            if self._ended:
                return
            if self._packets and self._packets[-1].is_partial:
                self._packets.pop()  # of no more use
            self._packets.append(packet)
            if len(self._packets) > self._limit:
                lost, first = self._packets.popleft(), self._packets[0]
                # At least 1: an empty slice that is missing is a gap as well.
                gap = first.gap + lost.gap + max(1, len(lost.events))
                self._packets[0] = replace(first, gap=gap)
            self._notify()

    def offer(self, packet: EventPacket) -> None:
        """Adds a partial slice if the queue is empty."""
        with self._changing:
            if not self._ended and not self._packets:
                self._packets.append(packet)
                self._notify()

    def take(self, timeout_s: float) -> EventPacket | None:
        """Returns the oldest slice, or None after ``timeout_s``, when woken, or at the end."""
        while not (self._packets or self._ended or self._woken):
            if not self._ready.acquire(timeout=timeout_s):
                break
        with self._changing:
            if self._packets:
                return self._packets.popleft()
            self._woken = False
            return None

    def wake(self) -> None:
        """Lets the reader know, once it has taken all slices, that it need not wait for one."""
        with self._changing:
            self._woken = True
            self._notify()

    @property
    def is_empty(self) -> bool:
        """Returns True if no slice waits."""
        return not self._packets

    @property
    def has_ended(self) -> bool:
        """Returns True once the queue has ended."""
        return self._ended

    def end(self) -> None:
        """Ends the queue: wakes a waiting reader and discards the slices that are left."""
        with self._changing:
            self._ended = True
            self._packets.clear()
            self._notify()

    def _notify(self) -> None:
        """Lets the reader look, once; the caller has the lock of all changes."""
        if self._ready.locked():
            self._ready.release()

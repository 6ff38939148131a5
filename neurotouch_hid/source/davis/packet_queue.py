"""A short queue of slices from the camera's thread to the line; a slow one loses the oldest."""

import threading
from collections import deque
from dataclasses import replace

from neurotouch_hid.messages import EventPacket


class PacketQueue:
    """Holds the newest slices; what is dropped is counted in the ``gap`` of the next one.

    Args:
        limit: slices that may wait.
    """

    def __init__(self, limit: int) -> None:
        self._limit = limit
        self._packets: deque[EventPacket] = deque()
        self._ready = threading.Condition()
        self._ended = False

    def put(self, packet: EventPacket) -> None:
        """Adds a slice; drops the oldest if there are too many."""
        with self._ready:
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
            self._ready.notify()

    def offer(self, packet: EventPacket) -> None:
        """Adds the head of a slice if whoever takes them has nothing else to do."""
        with self._ready:
            if not self._ended and not self._packets:
                self._packets.append(packet)
                self._ready.notify()

    def take(self, timeout_s: float) -> EventPacket | None:
        """The oldest slice as soon as there is one; None if none comes in time, or at the end."""
        with self._ready:
            if not self._packets and not self._ended:
                self._ready.wait(timeout_s)
            return self._packets.popleft() if self._packets else None

    @property
    def has_ended(self) -> bool:
        """True if nothing comes any more."""
        return self._ended

    def end(self) -> None:
        """Lets go whoever waits; what has not been taken is thrown away."""
        with self._ready:
            self._ended = True
            self._packets.clear()
            self._ready.notify_all()

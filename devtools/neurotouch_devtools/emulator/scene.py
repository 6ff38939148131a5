"""The scene of the emulated camera: packets of another source, read a little ahead of time."""

from collections import deque
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.events import join_events
from neurotouch_hid.messages import EventPacket, Frame

LOOK_AHEAD_US = 100_000
"""The readout of a frame starts before its exposure, but its packet comes after the exposure."""


class Scene:
    """Packets in order, known ``LOOK_AHEAD_US`` before they are due.

    Args:
        packets: the source's packets, read only as far as needed; None means "not yet", and the
            scene does not move.

    Attributes:
        frames: known frames that have not been taken, oldest first.
    """

    def __init__(self, packets: Iterable[EventPacket | None]) -> None:
        self._coming = iter(packets)
        self._known_us = 0
        self._pending: deque[NDArray[np.void]] = deque()
        self._exhausted = False
        self.frames: deque[Frame] = deque()

    @property
    def ended(self) -> bool:
        """True if the scene is over."""
        return self._exhausted and not self._pending and not self.frames

    def begin(self) -> int | None:
        """Returns the first moment, or None while it is unknown."""
        packet = self._pull()
        return packet.t_begin_us if packet else None

    def take(self, until_us: int) -> NDArray[np.void]:
        """Returns the events before a moment that have not been taken: (n,) EVENT_DTYPE."""
        parts = []
        while self._pending:
            events = self._pending[0]
            stop = int(np.searchsorted(events["t"], until_us))
            if stop:
                parts.append(events[:stop])
            if stop < len(events):
                self._pending[0] = events[stop:]
                break
            self._pending.popleft()
        if len(parts) == 1:
            return parts[0]
        return join_events(parts)

    def look_ahead(self, until_us: int) -> int:
        """Reads packets up to soon after a moment.

        Returns how far the scene can go, at most that moment.
        """
        while self._known_us < until_us + LOOK_AHEAD_US and self._pull():
            pass
        if self._exhausted:
            return until_us
        return min(until_us, self._known_us - LOOK_AHEAD_US)

    def _pull(self) -> EventPacket | None:
        if self._exhausted:
            return None
        try:
            packet = next(self._coming)
        except StopIteration:
            self._exhausted = True
            return None
        if packet is None:
            return None
        self._known_us = packet.t_end_us
        if len(packet.events):
            self._pending.append(packet.events)
        self.frames.extend(packet.frames)
        return packet

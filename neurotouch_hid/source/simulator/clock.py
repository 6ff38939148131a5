"""The camera's clock, and what happens to it."""

from collections.abc import Sequence
from dataclasses import replace

from neurotouch_hid.events import shift_packet
from neurotouch_hid.messages import EventPacket
from neurotouch_hid.source.simulator.setup import ClockChange


class Clock:
    """Stamps packets, and leaves those out that never arrive.

    Args:
        changes: in any order.

    Attributes:
        changes: in order of time.
    """

    def __init__(self, changes: Sequence[ClockChange]) -> None:
        self.changes = sorted(changes, key=lambda change: change.at_us)

    def cut(self, begin_us: int, end_us: int) -> int:
        """Returns where a slice ends, so that nothing happens to the clock within it."""
        edges = (at for change in self.changes for at in (change.at_us, _back(change)))
        return min((at for at in edges if begin_us < at < end_us), default=end_us)

    def arrives(self, t_us: int) -> bool:
        """Returns False for a slice that begins while nothing arrives."""
        return not any(change.at_us <= t_us < _back(change) for change in self.changes)

    def stamp(self, packet: EventPacket) -> EventPacket:
        """Returns a packet with the camera's stamps, without frames begun before a change."""
        shift_us = self._shift(packet.t_begin_us)
        since_us = self.find_last_change(packet.t_begin_us)
        frames = tuple(each for each in packet.frames if each.exposure_begin_us >= since_us)
        return shift_packet(replace(packet, frames=frames), shift_us)

    def find_last_change(self, t_us: int) -> int:
        """Returns when the clock began to run as at this moment."""
        return max((_back(change) for change in self.changes if _back(change) <= t_us), default=0)

    def find_moment(self, stamp_us: int) -> int:
        """Returns the time of the simulation that has this stamp."""
        moment_us = stamp_us
        for change in self.changes:
            if stamp_us >= change.at_us + self._shift(change.at_us):
                moment_us = stamp_us - self._shift(change.at_us)
        return moment_us

    def _shift(self, t_us: int) -> int:
        return sum(change.shift_us for change in self.changes if change.at_us <= t_us)


def _back(change: ClockChange) -> int:
    return change.at_us + change.lost_us

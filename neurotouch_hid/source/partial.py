"""The head of a slice comes before its end, so that less is left to do then."""

from typing import Final

import numpy as np

from neurotouch_hid.messages import EventPacket

LEAD_US: Final = 350
"""So long before the end of a slice its head is handed over: as long as a processor needs for it
whose caches have forgotten the line since the slice before. They soon forget it again."""
SHORTEST_US: Final = 2_000
"""A line with shorter slices is busy enough not to be forgotten."""


def cut_partial(packet: EventPacket) -> EventPacket | None:
    """What has happened in a slice ``LEAD_US`` before its end, without frames.

    Args:
        packet: the slice.

    Returns:
        None if the slice is too short for this to be worth while.
    """
    if packet.t_end_us - packet.t_begin_us < SHORTEST_US:
        return None
    return cut(packet, packet.t_end_us - LEAD_US)


def cut(packet: EventPacket, until_us: int) -> EventPacket:
    """What has happened in a slice before a moment in it, without frames."""
    n = int(np.searchsorted(packet.events["t"], until_us))
    return EventPacket(
        packet.t_begin_us, until_us, packet.events[:n], gap=packet.gap, is_partial=True
    )

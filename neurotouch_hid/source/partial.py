"""Cuts partial slices: the pipeline gets them early, so that less work is left at the end."""

from typing import Final

from neurotouch_hid.messages import EventPacket

LEAD_US: Final = 350
"""How long before its end a slice is delivered in part. A processor needs this time if the
pipeline has left its caches since the last slice."""
SHORTEST_US: Final = 2_000
"""With shorter slices the pipeline stays in the caches of the processor."""


def cut_partial(packet: EventPacket) -> EventPacket | None:
    """Returns the events of a slice up to ``LEAD_US`` before its end, without frames.

    Args:
        packet: the slice.

    Returns:
        The partial slice; None if the slice is shorter than ``SHORTEST_US``.
    """
    if packet.t_end_us - packet.t_begin_us < SHORTEST_US:
        return None
    return cut(packet, packet.t_end_us - LEAD_US)


def cut(packet: EventPacket, until_us: int) -> EventPacket:
    """Returns the events of a slice before ``until_us``, without frames."""
    n = int(packet.events["t"].searchsorted(until_us))
    return EventPacket(
        packet.t_begin_us, until_us, packet.events[:n], gap=packet.gap, is_partial=True
    )

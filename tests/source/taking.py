"""Takes packets from a source that is polled."""

import time
from collections.abc import Callable
from typing import Any

from neurotouch_hid.messages import EventPacket
from tests.waiting import LIMIT_S


def take_until(source: Any, is_enough: Callable[[list[EventPacket]], Any]) -> list[EventPacket]:
    """Returns the packets up to the one after which they are enough; the source stays open."""
    packets, deadline = [], time.monotonic() + LIMIT_S
    for packet in source.poll():
        assert time.monotonic() < deadline, source.stats()
        packets += [] if packet is None else [packet]
        if is_enough(packets):
            return packets
    raise AssertionError("the source has ended")


def take(source: Any, n: int) -> list[EventPacket]:
    """Returns the first n packets; the source stays open."""
    return take_until(source, lambda packets: len(packets) >= n)

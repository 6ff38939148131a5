"""Ends a run after a length of sensor time."""

from collections.abc import Iterable, Iterator
from threading import Event

from neurotouch_hid.messages import EventPacket, Step
from neurotouch_hid.runtime import Tap


def stop_after(seconds: float, stop: Event) -> Tap:
    """Returns a tap that sets ``stop`` after this much sensor time.

    The loop itself still sees the source, because a live one must go round while it is silent.
    """
    begin_us: int | None = None

    def check(step: Step) -> None:
        nonlocal begin_us
        begin_us = step.packet.t_begin_us if begin_us is None else begin_us
        if step.packet.t_end_us - begin_us >= seconds * 1e6:
            stop.set()

    return check


def cut_off(packets: Iterable[EventPacket], seconds: float) -> Iterator[EventPacket]:
    """Yields the packets of the first ``seconds`` of sensor time."""
    begin_us: int | None = None
    for packet in packets:
        begin_us = packet.t_begin_us if begin_us is None else begin_us
        yield packet
        if packet.t_end_us - begin_us >= seconds * 1e6:
            return

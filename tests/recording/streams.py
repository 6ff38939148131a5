"""Small streams of events and frames for the tests of recordings and sources."""

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.messages import EVENT_DTYPE, EventPacket, Frame

ORIGIN_US = 1_589_163_147_368_868


def make_events(
    n: int, span_us: int, seed: int = 0, origin_us: int = ORIGIN_US
) -> NDArray[np.void]:
    chance = np.random.default_rng(seed)
    events = np.zeros(n, EVENT_DTYPE)
    events["t"] = np.sort(chance.integers(0, span_us, n)) + origin_us
    events["x"] = chance.integers(0, 346, n)
    events["y"] = chance.integers(0, 260, n)
    events["p"] = chance.integers(0, 2, n)
    return events


def make_frames(n: int, span_us: int, origin_us: int = ORIGIN_US) -> tuple[Frame, ...]:
    chance = np.random.default_rng(n)
    frames = []
    for i in range(n):
        begin_us = origin_us + (2 * i + 1) * span_us // (2 * n)
        pixels = chance.integers(0, 256, (260, 346), np.uint8)
        frames.append(Frame(pixels, begin_us, begin_us + 5_000))
    return tuple(frames)


def make_packets(n_events: int = 20_000, span_us: int = 200_000) -> list[EventPacket]:
    """Packets of 10 ms with five frames, from ``ORIGIN_US`` on."""
    events, frames = make_events(n_events, span_us), make_frames(5, span_us)
    packets = []
    for begin_us in range(ORIGIN_US, ORIGIN_US + span_us, 10_000):
        end_us = begin_us + 10_000
        low, high = np.searchsorted(events["t"], [begin_us, end_us])
        inside = tuple(f for f in frames if begin_us <= f.exposure_end_us < end_us)
        packets.append(EventPacket(begin_us, end_us, events[low:high], inside))
    return packets

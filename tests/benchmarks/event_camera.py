"""From the library's packets to slices at 20 million events/s of 1280x720: share of a core.

    python -m tests.benchmarks.event_camera [MILLION_EVENTS_PER_S]

The packets are made up; the library's own decoding is not in the figures. *Rows* are runs of eight
neighbours, as the sensors send them; *random* pixels are the worst case for the tables. Beside it
is the time in which the bytes of the packets are copied once: the memory's own limit.
"""

import statistics
import sys
import time
from types import SimpleNamespace

import numpy as np

from neurotouch_hid.geometry import PAPER_GEL
from neurotouch_hid.source.events.config import EventsConfig
from neurotouch_hid.source.events.gel_place import place_gel
from neurotouch_hid.source.events.models import MODELS
from neurotouch_hid.source.events.reader import PacketReader
from tests.source.events.fake_library import make_events, make_packet

EVK4 = MODELS[0]
PACKET_US = 1_000
N_PACKETS = 400
VIEWS = {
    "whole picture": EventsConfig(),
    "gel of 8 px/mm": EventsConfig(px_per_mm=8.0),
    "gel of 4 px/mm": EventsConfig(px_per_mm=4.0),
}


def make_stream(kind, per_us):
    """Packets of 1 ms, the same sixteen again and again with later times."""
    rng = np.random.default_rng(1)
    n = per_us * PACKET_US
    packets = []
    for _ in range(16):
        y = rng.integers(0, EVK4.height_px, n // 8)
        x = rng.integers(0, EVK4.width_px - 8, n // 8)
        on = rng.integers(0, 2, n // 8)
        if kind == "rows":
            x, y, on = np.repeat(x, 8) + np.tile(np.arange(8), n // 8), *map(repeat_8, (y, on))
        else:
            x, y = rng.integers(0, EVK4.width_px, n), rng.integers(0, EVK4.height_px, n)
            on = rng.integers(0, 2, n)
        packets.append(make_events(np.arange(n) // per_us, x, y, on))
    return packets


def repeat_8(values):
    return np.repeat(values, 8)


def measure(config, packets):
    """Seconds of processor time for each packet, and what came of it."""
    n_out = 0

    def put(packet):
        nonlocal n_out
        n_out += len(packet.events)

    clock = iter(range(10**9))
    view = place_gel(EVK4, config, PAPER_GEL)
    reader = PacketReader(view, 4_000, 0, put, clock_s=lambda: 1e-6 * PACKET_US * next(clock))
    times, n_in = [], 0
    times_us = packets[0]["t"] - packets[0]["t"][0]
    for k in range(N_PACKETS):
        events = packets[k % len(packets)]
        events["t"] = times_us + PACKET_US * (k + 1)
        ring = SimpleNamespace(current_t=PACKET_US * (k + 2), dropped_packets=0)
        begun = time.thread_time()
        reader.read(ring, make_packet(events))
        times.append(time.thread_time() - begun)
        n_in += len(events)
    assert (reader.n_events, reader.n_lost) == (n_in, 0)
    assert reader.n_shown >= n_out > 0.95 * reader.n_shown  # the last slice is still open
    return times[N_PACKETS // 4 :], n_out / n_in


def main():
    per_us = int(sys.argv[1]) if len(sys.argv) > 1 else 20
    for kind in ("rows", "random"):
        packets = make_stream(kind, per_us)
        plain = packets[0].view(np.uint8)
        copies = []
        for _ in range(50):
            begun = time.thread_time()
            plain.copy()
            copies.append(time.thread_time() - begun)
        copy = 1e6 * statistics.median(copies) / PACKET_US
        for name, config in VIEWS.items():
            times, share = measure(config, packets)
            load = [1e6 * seconds / PACKET_US for seconds in times]
            median, least = statistics.median(load), np.percentile(load, 5)
            print(
                f"{kind}, {name}: {median:.0%} of a core at {per_us} million events/s (at best "
                f"{least:.0%}); {share:.0%} of the events stay; copying the bytes: {copy:.1%}"
            )


if __name__ == "__main__":
    main()

"""Recorded speed: never early, no drift, late loops catch up."""

import numpy as np

from neurotouch_hid.messages import EVENT_DTYPE, EventPacket
from neurotouch_hid.source.pacing import PacedSource

NO_EVENTS = np.empty(0, EVENT_DTYPE)


class Packets:
    """A source of ten empty packets of 10 ms, an hour apart in the middle."""

    name = "packets"
    rig = None

    def __init__(self):
        self.closed = False

    def __iter__(self):
        for i in range(10):
            begin_us = i * 10_000 + (3_600_000_000 if i >= 5 else 0)
            yield EventPacket(begin_us, begin_us + 10_000, NO_EVENTS)

    def close(self):
        self.closed = True


class Clock:
    """Host time that only passes when someone waits (each wait 0.3 ms too long) or works."""

    def __init__(self):
        self.now_ns = 77

    def __call__(self):
        return self.now_ns

    def sleep_s(self, seconds):
        assert seconds > 0
        self.now_ns += int(seconds * 1e9) + 300_000


def test_never_early_and_no_drift():
    clock = Clock()
    arrivals = [clock() for _ in PacedSource(Packets(), clock, clock.sleep_s)]
    lateness_ns = [t - 77 - (i + 1) * 10_000_000 for i, t in enumerate(arrivals)]
    assert lateness_ns == [300_000] * 10


def test_a_late_loop_catches_up():
    clock, arrivals = Clock(), []
    for i, _ in enumerate(PacedSource(Packets(), clock, clock.sleep_s)):
        arrivals.append((clock() - 77) // 1_000_000)
        if i == 1:
            clock.now_ns += 40_000_000
    assert arrivals == [10, 20, 60, 60, 60, 60, 70, 80, 90, 100]


def test_closing_closes_the_source():
    packets = Packets()
    with PacedSource(packets) as source:
        assert source.name == "packets"
    assert packets.closed


def test_the_moment_of_each_packets_end_is_told():
    clock = Clock()
    source = PacedSource(Packets(), clock, clock.sleep_s)
    due_ns = []
    for _ in source:
        due_ns.append(source.due_ns)
        clock.now_ns += 50_000_000  # a loop that is late; what is due does not wait for it
    assert due_ns == [77 + (k + 1) * 10_000_000 for k in range(10)]


def test_what_may_come_as_one_comes_when_all_of_it_has_happened():
    class Quiet(Packets):
        def __iter__(self):
            for i in range(40):
                yield EventPacket(i * 10_000, (i + 1) * 10_000, NO_EVENTS)

    clock = Clock()
    paced = PacedSource(Quiet(), clock, clock.sleep_s)
    paced.doze(is_idle=True)
    lengths_us = []
    for packet in paced:
        lengths_us.append(packet.t_end_us - packet.t_begin_us)
        assert clock() - 77 == packet.t_end_us * 1_000 + 300_000
    assert lengths_us == [10_000] * 10 + [40_000] * 7 + [20_000]

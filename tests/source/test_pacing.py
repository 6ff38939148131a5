"""Recorded speed: never early, no drift, late loops catch up."""

import numpy as np
import pytest

from neurotouch_hid.messages import EVENT_DTYPE, EventPacket
from neurotouch_hid.source.pacing import STOPPED_NS, PacedSource
from neurotouch_hid.source.partial import LEAD_US, SHORTEST_US

NO_EVENTS = np.empty(0, EVENT_DTYPE)


class Packets:
    """A source of ten empty packets, an hour apart in the middle."""

    name = "packets"
    rig = None
    is_live = is_simulated = False

    def __init__(self, length_us=10_000):
        self.closed = False
        self._length_us = length_us

    def __iter__(self):
        for i in range(10):
            begin_us = i * self._length_us + (3_600_000_000 if i >= 5 else 0)
            yield EventPacket(begin_us, begin_us + self._length_us, NO_EVENTS)

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


@pytest.mark.parametrize("where", ["in the loop", "while it waits"])
def test_a_process_that_was_stopped_goes_on_at_recorded_speed(where):
    clock, arrivals = Clock(), []

    def wait(seconds):
        clock.sleep_s(seconds)
        if where == "while it waits" and len(arrivals) == 2:
            clock.now_ns += 60 * STOPPED_NS

    for i, _ in enumerate(PacedSource(Packets(), clock, wait)):
        arrivals.append((clock() - 77) // 1_000_000)
        if where == "in the loop" and i == 1:
            clock.now_ns += 60 * STOPPED_NS
    played = np.diff(arrivals)
    assert played.max() >= 60_000
    assert np.sort(played)[:8].min() >= 9


def test_long_packets_are_not_taken_for_a_stop():
    clock = Clock()
    source = PacedSource(Packets(2 * STOPPED_NS // 1_000), clock, clock.sleep_s)
    arrivals_ns = [clock() for _ in source]
    assert set(np.diff(arrivals_ns)) == {2 * STOPPED_NS}


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
            for i in range(90):
                yield EventPacket(i * 10_000, (i + 1) * 10_000, NO_EVENTS)

    clock = Clock()
    paced = PacedSource(Quiet(), clock, clock.sleep_s)
    paced.set_activity(is_idle=True)
    lengths_us = []
    for packet in paced:
        if packet.is_partial:
            assert packet.t_end_us < 600_000
            continue
        lengths_us.append(packet.t_end_us - packet.t_begin_us)
        assert clock() - 77 == packet.t_end_us * 1_000 + 300_000
    assert lengths_us == [10_000] * 60 + [40_000] * 7 + [20_000]


class Busy(Packets):
    """Ten slices with an event every 100 us."""

    def __init__(self, slice_us):
        super().__init__()
        self.slice_us = slice_us

    def __iter__(self):
        for begin_us in range(0, 10 * self.slice_us, self.slice_us):
            events = np.zeros(self.slice_us // 100, EVENT_DTYPE)
            events["t"] = begin_us + 100 * np.arange(len(events))
            yield EventPacket(begin_us, begin_us + self.slice_us, events, gap=3)


def play_busy(slice_us, late_ns=0):
    """What came and when, in us; the line is awake from the first slice on."""
    clock, came = Clock(), []
    paced = PacedSource(Busy(slice_us), clock, clock.sleep_s)
    for packet in paced:
        came.append((packet, (clock() - 77) // 1_000))
        if not packet.is_partial:
            paced.set_activity(is_idle=False)
            clock.now_ns += late_ns
    return came


def test_the_head_of_a_slice_comes_shortly_before_its_end():
    (first, _), *came = play_busy(4_000)
    assert not first.is_partial
    assert [packet.is_partial for packet, _ in came] == [True, False] * 9
    for (head, head_us), (whole, whole_us) in zip(came[::2], came[1::2], strict=True):
        assert head_us == whole.t_end_us - LEAD_US + 300
        assert whole_us == whole.t_end_us + 300
        assert (head.t_begin_us, head.t_end_us) == (whole.t_begin_us, whole.t_end_us - LEAD_US)
        assert head.events.tolist() == whole.events.tolist()[:37]
        assert head.gap == whole.gap == 3


def test_no_head_comes_of_a_short_slice_or_to_a_line_that_is_late():
    assert not any(packet.is_partial for packet, _ in play_busy(SHORTEST_US - 100))
    assert not any(packet.is_partial for packet, _ in play_busy(4_000, 4_000_000))


class Video(Packets):
    """Forty empty packets of a video."""

    view = None

    def __iter__(self):
        for i in range(40):
            yield EventPacket(i * 10_000, (i + 1) * 10_000, NO_EVENTS)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def pictures(self):
        return iter(())


def test_slices_of_a_video_come_one_by_one():
    clock = Clock()
    paced = PacedSource(Video(), clock, clock.sleep_s)
    paced.set_activity(is_idle=True)
    packets = list(paced)
    assert len(packets) == 40
    assert all(packet.t_end_us - packet.t_begin_us == 10_000 for packet in packets)

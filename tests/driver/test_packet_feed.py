"""What the line sees, handed to others: they may be slow, gone or many; the line never waits."""

import socket
import threading
import time

import numpy as np
import pytest

from neurotouch_hid.driver.packet_feed import MAX_SUBSCRIBERS, QUEUE_BYTES, PacketFeed
from neurotouch_hid.errors import DriverError
from neurotouch_hid.messages import (
    EVENT_DTYPE,
    EventPacket,
    GamepadState,
    GelState,
    MarkerField,
    Step,
    no_gesture,
)
from neurotouch_hid.recording.wire import receive_packets
from tests.recording.streams import make_packets
from tests.waiting import wait_until

LIMIT_S = 60.0
EMPTY = np.empty(0, EVENT_DTYPE)


def step_of(packet):
    empty = MarkerField(0, None, None, None)
    return Step(packet, None, empty, no_gesture(0), GamepadState(0), GelState())


@pytest.fixture
def packet_feed():
    packet_feed = PacketFeed()
    yield packet_feed
    packet_feed.close()


def listen(packet_feed):
    """The far end of a line that is served."""
    here, there = socket.socketpair()
    there.settimeout(LIMIT_S)

    def serve():
        with here:
            packet_feed.serve(here)

    before = len(packet_feed._subscribers)
    thread = threading.Thread(target=serve, daemon=True)
    thread.start()
    wait_until(lambda: len(packet_feed._subscribers) > before)
    return there, thread


def test_subscribers_get_every_packet_and_then_the_end(packet_feed):
    packets = make_packets(2_000)
    (a, first), (b, second) = listen(packet_feed), listen(packet_feed)
    got = {}
    readers = [
        threading.Thread(target=lambda n=n, line=line: got.update({n: list(receive_packets(line))}))
        for n, line in enumerate((a, b))
    ]
    for reader in readers:
        reader.start()
    for packet in packets:
        packet_feed(step_of(packet))
    packet_feed.close()
    for thread in (*readers, first, second):
        thread.join(LIMIT_S)
    for received in got.values():
        assert [p.t_begin_us for p in received] == [p.t_begin_us for p in packets]
        assert sum(len(p.events) for p in received) == 2_000
        assert not any(p.gap for p in received)
    a.close()
    b.close()


def test_a_listener_that_sleeps_loses_the_oldest_and_is_told_how_many(packet_feed):
    line, thread = listen(packet_feed)
    packets = make_packets(1_000_000)
    assert sum(p.events.nbytes for p in packets) < QUEUE_BYTES  # so it is sent several times
    rounds = 4
    for _ in range(rounds):  # nobody reads: this must not wait
        for packet in packets:
            packet_feed(step_of(packet))
    received = []
    reader = threading.Thread(target=lambda: received.extend(receive_packets(line)))
    reader.start()
    packet_feed.close()
    reader.join(LIMIT_S)
    thread.join(LIMIT_S)
    line.close()
    arrived = sum(len(p.events) for p in received)
    lost = sum(p.gap for p in received)
    assert lost > 0
    assert arrived + lost == rounds * 1_000_000
    assert received[-1].t_begin_us == packets[-1].t_begin_us  # the newest is never lost


def test_a_listener_that_was_stopped_goes_on(packet_feed, monkeypatch):
    """As with Ctrl-Z, or a slow disk: it has waited longer than anybody waits at the end."""
    monkeypatch.setattr("neurotouch_hid.driver.packet_feed.PATIENCE_S", 0.2)
    monkeypatch.setattr("neurotouch_hid.driver.packet_feed._LOOK_S", 0.05)
    line, thread = listen(packet_feed)
    packets = [*make_packets(1_000_000), EventPacket(1 << 40, (1 << 40) + 1, EMPTY)]
    for packet in packets:
        packet_feed(step_of(packet))
    [subscriber] = packet_feed._subscribers
    wait_until(lambda: subscriber.is_stuck)
    received = []
    reader = threading.Thread(target=lambda: received.extend(receive_packets(line)))
    reader.start()
    wait_until(lambda: len(received) == len(packets))
    packet_feed.close()
    reader.join(LIMIT_S)
    thread.join(LIMIT_S)
    line.close()
    for sent, got in zip(packets, received, strict=True):
        assert np.array_equal(sent.events, got.events)
        for shown, seen in zip(sent.frames, got.frames, strict=True):
            assert np.array_equal(shown.pixels, seen.pixels)


def test_one_that_stays_stopped_makes_room_and_holds_up_no_end(packet_feed, monkeypatch):
    monkeypatch.setattr("neurotouch_hid.driver.packet_feed.PATIENCE_S", 0.2)
    monkeypatch.setattr("neurotouch_hid.driver.packet_feed._LOOK_S", 0.05)
    served = [listen(packet_feed) for _ in range(MAX_SUBSCRIBERS)]
    for packet in make_packets(1_000_000):
        packet_feed(step_of(packet))
    wait_until(lambda: all(each.is_stuck for each in packet_feed._subscribers))
    packet_feed.require_place()
    assert len(packet_feed._subscribers) == MAX_SUBSCRIBERS - 1
    packet_feed.close()
    for line, thread in served:  # nobody has read anything
        thread.join(LIMIT_S)
        assert not thread.is_alive()
        line.close()


def test_a_listener_that_leaves_is_forgotten(packet_feed):
    line, thread = listen(packet_feed)
    line.close()
    packets = make_packets(1_000)
    deadline = time.monotonic() + LIMIT_S
    while thread.is_alive() and time.monotonic() < deadline:
        packet_feed(step_of(packets[0]))
        time.sleep(0.005)
    assert not thread.is_alive()
    assert packet_feed._subscribers == ()


def test_only_so_many_may_listen(packet_feed):
    lines = [listen(packet_feed)[0] for _ in range(MAX_SUBSCRIBERS - 1)]
    packet_feed.require_place()
    lines.append(listen(packet_feed)[0])
    with pytest.raises(DriverError, match="record or watch already"):
        packet_feed.require_place()
    for line in lines:
        line.close()

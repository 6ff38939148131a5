"""Packets through a socket arrive as they were sent."""

import socket
import threading

import numpy as np
import pytest

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.messages import EVENT_DTYPE, EventPacket
from neurotouch_hid.recording.wire import receive_packets, send_packet
from tests.recording.streams import make_packets


@pytest.fixture
def line():
    here, there = socket.socketpair()
    with here, there:
        there.settimeout(30)
        yield here, there


def test_what_is_sent_is_received(line):
    here, there = line
    sent = [*make_packets(3_000), EventPacket(5, 6, np.empty(0, EVENT_DTYPE), (), 42)]

    def send():
        for packet in sent:
            send_packet(here, packet)
        here.close()

    thread = threading.Thread(target=send)
    thread.start()
    received = list(receive_packets(there))
    thread.join()
    assert len(received) == len(sent)
    for ours, theirs in zip(sent, received, strict=True):
        assert (ours.t_begin_us, ours.t_end_us, ours.gap) == (
            theirs.t_begin_us,
            theirs.t_end_us,
            theirs.gap,
        )
        assert np.array_equal(ours.events, theirs.events)
        for a, b in zip(ours.frames, theirs.frames, strict=True):
            assert (a.exposure_begin_us, a.exposure_end_us) == (
                b.exposure_begin_us,
                b.exposure_end_us,
            )
            assert np.array_equal(a.pixels, b.pixels)


@pytest.mark.parametrize("cut", [1, 30, 39, 41, 500, 90_000])
def test_an_end_in_the_middle_of_a_packet_is_the_end(line, cut):
    here, there = line
    packet = next(p for p in make_packets(3_000) if p.frames)
    data = bytearray()

    class Tape:
        def sendall(self, piece):
            data.extend(piece)

    send_packet(Tape(), packet)
    assert cut < len(data)
    threading.Thread(target=lambda: (here.sendall(data[:cut]), here.close())).start()
    assert list(receive_packets(there)) == []


@pytest.mark.parametrize("nonsense", [b"HTTP/1.1 200 OK" + b" " * 100, b"\0" * 100, b"\xff" * 100])
def test_nonsense_is_refused_before_memory_is_taken_for_it(line, nonsense):
    here, there = line
    here.sendall(nonsense)
    with pytest.raises(RecordingError, match="cannot be read"):
        list(receive_packets(there))

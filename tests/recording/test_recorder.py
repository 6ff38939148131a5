"""The recorder beside the line: it never makes anybody wait who did not ask to, and it counts."""

import os
import threading
from dataclasses import replace

import pytest

from neurotouch_hid.recording import Recorder, Recording, RecordingWriter
from tests.recording.streams import make_packets
from tests.recording.test_writer import expect, largest_file

LIMIT_S = 60.0


@pytest.fixture
def stuck_disk(tmp_path):
    """A file on which writing hangs until ``let_go``: a pipe that nobody empties."""
    path = tmp_path / "stuck.aedat4"
    os.mkfifo(path)
    reader = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    os.set_blocking(reader, True)

    def drain():
        while os.read(reader, 1 << 16):
            pass

    thread = threading.Thread(target=drain)
    yield path, thread.start
    if thread.ident is not None:
        thread.join(LIMIT_S)
    os.close(reader)


def test_all_that_it_takes_is_in_the_file(tmp_path):
    packets = make_packets()
    recorder = Recorder(RecordingWriter(tmp_path / "a.aedat4", in_place=True))
    assert all(recorder.take(packet) for packet in packets)
    recorder.close()
    recorder.close()
    stats = recorder.stats()
    assert (stats.events, stats.frames) == expect(packets)
    assert (stats.lost_before, stats.lost_here) == (0, 0)
    assert stats.seconds == pytest.approx(0.2)
    assert stats.size_bytes == (tmp_path / "a.aedat4").stat().st_size
    batches = list(Recording(tmp_path / "a.aedat4"))
    assert sum(len(events) for events, _ in batches) == stats.events


def test_a_disk_that_hangs_loses_packets_and_nobody_waits(stuck_disk):
    path, let_go = stuck_disk
    packets = make_packets()
    recorder = Recorder(RecordingWriter(path, in_place=True), queue_bytes=200_000)
    taken = [recorder.take(packet) for packet in packets]  # a take that waits hangs the test
    assert not all(taken)
    refused = sum(len(packet.events) for packet, ok in zip(packets, taken, strict=True) if not ok)
    let_go()
    recorder.close()
    stats = recorder.stats()
    assert stats.lost_here == refused > 0
    assert stats.events + refused == expect(packets)[0]


def test_who_asks_to_wait_loses_nothing(stuck_disk):
    path, let_go = stuck_disk
    packets = make_packets()
    recorder = Recorder(RecordingWriter(path, in_place=True), queue_bytes=100_000)
    threading.Timer(0.2, let_go).start()
    assert all(recorder.take(packet, wait=True) for packet in packets)
    recorder.close()
    assert (recorder.stats().events, recorder.stats().frames) == expect(packets)


def test_a_packet_larger_than_the_queue_is_still_taken(tmp_path):
    recorder = Recorder(RecordingWriter(tmp_path / "a.aedat4"), queue_bytes=10)
    assert recorder.take(make_packets()[0])
    recorder.close()


def test_a_full_disk_ends_the_recording_and_says_so(tmp_path):
    packets = make_packets()
    with largest_file(100_000):
        recorder = Recorder(RecordingWriter(tmp_path / "a.aedat4", in_place=True))
        for packet in packets:
            recorder.take(packet, wait=True)
        recorder.close()
    assert recorder.error is not None
    assert "File too large" in recorder.error.message
    stats = recorder.stats()
    batches = list(Recording(tmp_path / "a.aedat4"))
    there = sum(len(events) for events, _ in batches)
    assert 0 < stats.events <= there < expect(packets)[0]
    assert stats.lost_here > 0


def test_a_folder_that_vanishes_ends_the_recording_and_nobody_waits_for_room(tmp_path):
    """As when a stick is pulled out."""
    folder = tmp_path / "stick"
    folder.mkdir()
    packets = make_packets()
    writer = RecordingWriter(folder / "a.aedat4", in_place=True)
    folder.rename(tmp_path / "gone")
    recorder = Recorder(writer, queue_bytes=10)
    taker = threading.Thread(
        target=lambda: [recorder.take(packet, wait=True) for packet in packets], daemon=True
    )
    taker.start()
    taker.join(LIMIT_S)
    assert not taker.is_alive()
    recorder.close()
    assert recorder.error is not None
    assert "cannot be written: No such file or directory" in recorder.error.message
    assert recorder.stats().lost_here > 0


def test_what_was_lost_before_is_told(tmp_path):
    recorder = Recorder(RecordingWriter(tmp_path / "a.aedat4"))
    for packet in make_packets(1_000)[:3]:
        recorder.take(replace(packet, gap=7))
    recorder.close()
    assert recorder.stats().lost_before == 21

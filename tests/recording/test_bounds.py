"""What is in one moment of a recording is bounded, and what no camera gives is said."""

import os
import struct
import tracemalloc

import lz4.frame
import numpy as np
import pytest

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.messages import EVENT_DTYPE, Frame
from neurotouch_hid.recording import Recording
from neurotouch_hid.recording import packing as k
from neurotouch_hid.source.replay import Replay
from tests.recording.streams import make_events

MB = 1 << 20
BLACK = np.zeros((260, 346), np.uint8)


def at(*stamps_us):
    events = np.zeros(len(stamps_us), EVENT_DTYPE)
    events["t"] = stamps_us
    return events


def write(tmp_path, *packets):
    path = tmp_path / "a.aedat4"
    path.write_bytes(k.pack_header() + b"".join(packets))
    return path


def play(path):
    """The slices up to the end or the break, the sentence of the break, and the peak of memory."""
    slices, sentence = 0, ""
    tracemalloc.start()
    try:
        for _ in Replay(path):
            slices += 1
    except RecordingError as error:
        sentence = error.message
    finally:
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
    return slices, sentence, peak


def pack(stream, data):
    packed = lz4.frame.compress(data)
    return struct.pack("<ii", stream, len(packed)) + packed


def unpack(packet):
    return bytearray(lz4.frame.decompress(packet[8:]))


@pytest.mark.parametrize("size", [4_000_000, 1_900_000, 5_000])
def test_more_events_at_one_stamp_than_any_camera_gives(tmp_path, size):
    packet = k.pack_events(at(*[1_000]).repeat(size))
    path = write(tmp_path, k.pack_events(at(5)), packet * -(-3_000_000 // size))
    slices, sentence, peak = play(path)
    assert slices == 1
    assert ("61 MB" if size == 4_000_000 else "more events in one moment") in sentence
    assert peak < 130 * MB


def test_as_many_as_a_camera_gives_are_fine(tmp_path):
    packets = [k.pack_events(make_events(120_000, 10_000, i, i * 10_000)) for i in range(20)]
    slices, sentence, peak = play(write(tmp_path, *packets))
    assert (slices, sentence) == (20, "")
    assert peak < 20 * MB


def test_frames_long_before_the_next_event_go_out_early(tmp_path):
    stamps = range(0, 10_000_000, 10_000)
    frames = [k.pack_frame(Frame(BLACK, t_us, t_us)) for t_us in stamps]
    path = write(tmp_path, *frames, k.pack_events(at(3, 9_999_000)))
    slices, sentence, peak = play(path)
    assert (slices, sentence) == (1_000, "")
    assert peak < 30 * MB
    stamps_seen = [frame.exposure_end_us for packet in Replay(path) for frame in packet.frames]
    assert stamps_seen == list(stamps)


@pytest.mark.parametrize("first_us", [0, 50_000_000])
def test_frames_before_and_after_all_events_go_out_early(tmp_path, first_us):
    stamps = range(10_000_000, 20_000_000, 10_000)
    frames = [k.pack_frame(Frame(BLACK, t_us, t_us)) for t_us in stamps]
    _, sentence, peak = play(write(tmp_path, k.pack_events(at(first_us)), *frames))
    assert sentence == ""
    assert peak < 30 * MB


def test_more_frames_at_one_stamp_than_any_camera_gives(tmp_path):
    frame = k.pack_frame(Frame(BLACK, 1_000, 1_000))
    _, sentence, peak = play(write(tmp_path, k.pack_events(at(5, 2_000)), frame * 1_000))
    assert "more frames in one moment" in sentence
    assert peak < 30 * MB


def test_a_clock_that_goes_back_is_told_without_table_and_frames(tmp_path):
    parts = [10_000_000, 1_000_000, 1_500_000]
    path = write(tmp_path, *(k.pack_events(at(*range(t, t + 9_000, 10))) for t in parts))
    batches = []
    with pytest.raises(RecordingError) as caught:
        batches.extend(Recording(path))
    assert caught.value.message == f"{path}: the stamps go back from 10008990 to 1000000 µs."
    assert [len(events) for events, _ in batches] == [900]


def test_small_steps_back_keep_the_later_stamp(tmp_path):
    path = write(tmp_path, k.pack_events(at(50, 40, 60)), k.pack_events(at(55, 70)))
    assert [events["t"].tolist() for events, _ in Recording(path)] == [[50, 50, 60], [60, 70]]


@pytest.mark.parametrize("t_us", [-1, 1 << 62, -(1 << 63)])
def test_impossible_stamps(tmp_path, t_us):
    path = write(tmp_path, k.pack_events(at(5)), k.pack_events(at(t_us)))
    assert f"has an impossible stamp ({t_us} µs)" in play(path)[1]


def test_frames_that_say_what_is_not_so(tmp_path):
    frame = Frame(BLACK, 1000, 2000)
    end = k._FRAME_HEAD.size - 4
    for change, words in [
        (lambda data: data[: end + 100], "is damaged 0.001 s after"),  # pixels are missing
        (lambda data: data[:end] + bytes(4) + data[end + 4 :], "is damaged 0.001 s after"),
        (lambda data: data[:32] + b"\x07" + data[33:], "pixels of format 1, not"),
    ]:
        data = bytearray(change(unpack(k.pack_frame(frame))))
        data[:4] = struct.pack("<I", len(data) - 4)
        path = write(tmp_path, k.pack_events(at(500, 1_500)), pack(1, bytes(data)))
        assert words in play(path)[1]


@pytest.mark.parametrize("data", [b"\4\0\0\0\0\0\0\0", b"\0\0\0\0", b"", b"\1\0\0\0a"])
def test_packets_that_are_no_flatbuffers(tmp_path, data, capfd):
    path = write(tmp_path, k.pack_events(at(500)), pack(0, data))
    assert "is damaged 0.000 s after its first event" in play(path)[1]
    assert capfd.readouterr() == ("", "")


def test_damage_in_a_frame_does_not_cost_the_events_before_it(tmp_path):
    broken = pack(1, b"\4\0\0\0\0\0\0\0")
    events = [k.pack_events(at(t_us)) for t_us in range(0, 100_000, 1_000)]
    path = write(tmp_path, *events[:60], broken, *events[60:])
    slices, sentence, _ = play(path)
    assert slices == 6
    assert "is damaged 0.059 s after its first event" in sentence


def test_what_is_no_file_is_refused_at_once(tmp_path):
    path = tmp_path / "a.aedat4"
    os.mkfifo(path)
    with pytest.raises(RecordingError, match="it is a pipe, not a file"):
        Recording(path)
    path.unlink()
    path.symlink_to("/dev/zero")
    with pytest.raises(RecordingError, match="it is a device, not a file"):
        Recording(path)
    path.unlink()
    path.write_bytes(k.pack_header() + k.pack_events(at(1, 2)))
    path.with_suffix(".rig.yaml").symlink_to("/dev/zero")
    with pytest.raises(RecordingError, match="it is a device, not a file"):
        Replay(path)


@pytest.mark.parametrize(
    "text",
    [
        '<!DOCTYPE a [<!ENTITY a "aaaaaaaaaa">]><dv>&a;</dv>',
        "<a>" * 80_000,
        "<dv><node name='outInfo'><node name='x'/></node></dv>",
        "<dv><node name='outInfo'><node name='1'><node name='info'><attr key='sizeX'>a</attr>"
        "<attr key='sizeY'>b</attr></node></node></node></dv>",
        "no XML",
    ],
)
def test_texts_that_are_not_read(tmp_path, text):
    whole = bytearray(k.pack_header())
    at_text = len(k.MAGIC) + k._HEADER.size
    whole[at_text - 4 : at_text] = struct.pack("<I", len(text))
    whole[at_text:] = text.encode()
    whole[len(k.MAGIC) : len(k.MAGIC) + 4] = struct.pack("<I", k._HEADER.size - 4 + len(text))
    path = tmp_path / "a.aedat4"
    path.write_bytes(bytes(whole))
    with pytest.raises(RecordingError, match="has a damaged header"):
        Recording(path)

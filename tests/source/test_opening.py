"""Sources by name, and recordings as sources."""

import shutil

import numpy as np
import pytest

from neurotouch_hid.errors import RecordingError, SourceError
from neurotouch_hid.recording import RecordingWriter
from neurotouch_hid.source import open_source
from neurotouch_hid.source.rig_file import rig_path
from neurotouch_hid.vocabulary import SourceKind, find_source_kind
from tests.recording.streams import make_packets


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    path = tmp_path_factory.mktemp("recorded") / "a.aedat4"
    with RecordingWriter(path) as writer:
        for packet in make_packets():
            writer.write(packet)
    return path


def play(path, **options):
    with open_source(f"file:{path}", speed="max", **options) as source:
        return list(source)


def test_a_replay_gives_the_packets_that_were_recorded(recorded):
    packets = play(recorded)
    given = make_packets()
    assert np.array_equal(
        np.concatenate([p.events for p in packets]), np.concatenate([p.events for p in given])
    )
    assert sum(len(p.frames) for p in packets) == 5
    for packet in packets:
        assert packet.t_end_us - packet.t_begin_us == 10_000
        for frame in packet.frames:
            assert packet.t_begin_us <= frame.exposure_end_us < packet.t_end_us


def test_other_slices_and_a_bare_path(recorded):
    assert len(play(recorded, slice_us=50_000)) == 4
    source = open_source(str(recorded), speed="max")
    assert source.name == f"file:{recorded}"
    assert source.rig is None
    assert len(list(source)) == len(list(source)) == 20


def test_recorded_speed_gives_the_same(recorded):
    with open_source(f"file:{recorded}") as source:
        assert [len(p.events) for p in source] == [len(p.events) for p in play(recorded)]


def test_a_mirrored_recording_is_turned_round(recorded, tmp_path):
    path = tmp_path / "b.aedat4"
    shutil.copy(recorded, path)
    rig_path(path).write_text("centre_px: [170, 130]\npx_per_mm: 2.5\nmirrored: true\n")
    for plain, turned in zip(play(recorded), play(path), strict=True):
        assert np.array_equal(turned.events["x"], 345 - plain.events["x"])
        assert np.array_equal(turned.events["y"], plain.events["y"])
        for frame, other in zip(plain.frames, turned.frames, strict=True):
            assert np.array_equal(frame.pixels, other.pixels[:, ::-1])
            assert frame.t_us == other.t_us
    rig = open_source(f"file:{path}").rig
    assert rig is not None
    assert rig.centre_px == (170.0, 130.0)


def test_a_cut_recording_plays_up_to_the_break(recorded, tmp_path):
    path = tmp_path / "b.aedat4"
    path.write_bytes(recorded.read_bytes()[: recorded.stat().st_size // 2])
    packets = []
    with pytest.raises(RecordingError, match="is cut off"):
        packets.extend(open_source(f"file:{path}", speed="max"))
    assert len(packets) >= 8
    for packet, other in zip(packets[:-1], play(recorded), strict=False):
        assert np.array_equal(packet.events, other.events)


def test_a_recording_without_frames(recorded, tmp_path):
    from tests.vendor import dv

    path = tmp_path / "b.aedat4"
    config = dv.io.MonoCameraWriter.Config("camera")
    config.addEventStream((346, 260))
    writer = dv.io.MonoCameraWriter(str(path), config)
    store = dv.EventStore()
    for k in range(100):
        store.push_back(1_000 + 200 * k, 10, 20, True)
    writer.writeEvents(store)
    del writer
    with open_source(f"file:{path}", speed="max") as source:  # events may show the gel
        packets = list(source)
    assert sum(len(packet.events) for packet in packets) == 100
    assert not any(packet.frames for packet in packets)


@pytest.mark.parametrize(
    ("spec", "words", "hint"),
    [
        ("davis:", "No DAVIS camera is plugged in", "sim:tour"),
        (
            "nonsense",
            "'nonsense' is not a source",
            "events:, events:SERIAL, file:NAME.aedat4, file:NAME.mkv, sim:NAME",
        ),
        ("video:", "No video camera is plugged in", "sim:tour"),
        ("events:", "No event camera is plugged in", "sim:tour"),
        ("http://x", "'http://x' is not a source", "sim:NAME"),
        ("file:", "needs the name of a recording", "file:play.aedat4"),
        ("sim:nothing", "nothing", "tour"),
        ("", "The source is empty", "Give one of davis:"),
        ("driver:2", "'driver:2' is not a source", "Write driver: alone"),
    ],
)
def test_unknown_sources(spec, words, hint):
    with pytest.raises(SourceError, match=words) as caught:
        open_source(spec)
    assert hint in (caught.value.hint or "")


def test_a_missing_recording_is_not_an_unknown_source(tmp_path):
    with pytest.raises(RecordingError, match="There is no file"):
        open_source(str(tmp_path / "a.aedat4"))


def test_recordings_keep_the_papers_slices_unless_told_otherwise(recorded):
    lengths = {packet.t_end_us - packet.t_begin_us for packet in play(recorded, slice_us=None)}
    assert lengths == {10_000}


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("davis:", SourceKind.CAMERA),
        ("davis:00000002", SourceKind.CAMERA),
        ("file:a:b.aedat4", SourceKind.RECORDING),
        ("play.aedat4", SourceKind.RECORDING),
        ("sim:tour", SourceKind.SIMULATION),
        ("driver:", SourceKind.DRIVER),
        ("mirrored:sim:tour", SourceKind.OTHER),
        ("mirrored:file:play.aedat4", SourceKind.OTHER),
        ("other-gel:play.mkv", SourceKind.OTHER),
        ("take 12:30.aedat4", SourceKind.RECORDING),
        ("./a:b.aedat4", SourceKind.RECORDING),
        ("sim", SourceKind.OTHER),
        ("", SourceKind.OTHER),
    ],
)
def test_a_name_says_what_a_source_is(name, kind):
    assert find_source_kind(name) is kind

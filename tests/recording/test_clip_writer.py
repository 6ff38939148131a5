"""What the writer writes, other programs' readers read: exactly, and up to every break."""

import os
from contextlib import suppress

import av
import numpy as np
import pytest

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.messages import EVENT_DTYPE, EventPacket, Frame
from neurotouch_hid.recording import (
    Clip,
    ClipWriter,
    Picture,
    Recorder,
    RecordingWriter,
    Simulation,
)
from tests.recording.clips import draw, write_clip

STAMPS_US = [1_000_017, 1_008_018, 1_016_001, 1_050_333, 90_000_001]


def write(path, pictures, **options):
    with ClipWriter(path, **options) as writer:
        for picture in pictures:
            writer.write(picture)
    return path


def grey_pictures(size_px=(640, 480)):
    return [Picture(draw(k, size_px), t, t) for k, t in enumerate(STAMPS_US)]


def test_grey_pictures_come_back_bit_for_bit_with_their_stamps(tmp_path):
    given = grey_pictures()
    path = write(tmp_path / "a.mkv", given)
    read = list(Clip(path))
    assert [p.exposure_end_us for p in read] == [t - STAMPS_US[0] for t in STAMPS_US]
    for before, after in zip(given, read, strict=True):
        assert (before.pixels == after.pixels).all()


def test_ffmpeg_reads_it(tmp_path):
    path = write(tmp_path / "a.mkv", grey_pictures())
    with av.open(str(path)) as container:
        stream = container.streams.video[0]
        assert (stream.width, stream.height) == (640, 480)
        assert container.duration == STAMPS_US[-1] - STAMPS_US[0]
        stamps = [float(frame.pts * frame.time_base) for frame in container.decode(stream)]
    assert stamps == pytest.approx([(t - STAMPS_US[0]) / 1e6 for t in STAMPS_US], abs=1e-9)


def test_a_jpeg_is_written_as_it_came(tmp_path):
    source = write_clip(tmp_path / "a.mkv", [draw(k) for k in range(4)], range(0, 32_000, 8_000))
    given = list(Clip(source))
    read = list(Clip(write(tmp_path / "b.mkv", given)))
    assert [p.jpeg for p in read] == [p.jpeg for p in given]
    assert all(p.jpeg.startswith(b"\xff\xd8") for p in read)
    for before, after in zip(given, read, strict=True):
        assert (before.pixels == after.pixels).all()


@pytest.mark.parametrize("share", [0.3, 0.6, 0.999])
def test_a_writer_that_was_killed_leaves_a_readable_clip(tmp_path, share):
    writer = ClipWriter(tmp_path / "a.mkv")
    for picture in grey_pictures():
        writer.write(picture)
    content = (tmp_path / "a.mkv").read_bytes()  # closed by nobody
    broken = tmp_path / "b.mkv"
    broken.write_bytes(content)
    assert len(list(Clip(broken))) == 5
    os.truncate(broken, int(len(content) * share))
    read = []
    with suppress(RecordingError):  # a picture may end just there
        read.extend(Clip(broken))
    assert 1 <= len(read) <= 4
    writer.close()


def test_a_finished_clip_that_was_cut_off_says_so(tmp_path):
    pictures = [Picture(draw(k), 8_000 * k, 8_000 * k) for k in range(50)]
    path = write(tmp_path / "a.mkv", pictures)
    assert len(list(Clip(path))) == 50
    os.truncate(path, path.stat().st_size // 2)
    with pytest.raises(RecordingError, match=r"(is cut off|is damaged) [0-9.]+ s after"):
        list(Clip(path))


def test_the_mark_of_simulated_data_is_kept(tmp_path):
    mark = Simulation("program 1", "sim:tour", "neurotouch record", 7)
    assert Clip(write(tmp_path / "a.mkv", grey_pictures(), simulation=mark)).simulation == mark
    assert Clip(write(tmp_path / "b.mkv", grey_pictures())).simulation is None


def test_frames_of_packets_are_pictures(tmp_path):
    frame = Frame(draw(1, (346, 260)), 5_000, 9_000)
    packet = EventPacket(0, 10_000, np.empty(0, EVENT_DTYPE), (frame,))
    (picture,) = Clip(write(tmp_path / "a.mkv", [packet]))
    assert (picture.pixels == frame.pixels).all()


def test_what_a_clip_cannot_keep_is_refused(tmp_path):
    with pytest.raises(RecordingError, match="cannot keep events"):
        write(tmp_path / "a.mkv", [EventPacket(0, 10, np.zeros(1, EVENT_DTYPE))])
    with pytest.raises(RecordingError, match="changed their size"):
        write(tmp_path / "b.mkv", [*grey_pictures()[:1], *grey_pictures((320, 240))[1:]])
    with pytest.raises(RecordingError, match="in order of time"):
        write(tmp_path / "c.mkv", grey_pictures()[::-1])
    with (
        pytest.raises(RecordingError, match="cannot keep the pictures"),
        RecordingWriter(tmp_path / "d.aedat4") as writer,
    ):
        writer.write(grey_pictures()[0])


def test_a_full_disk_leaves_what_is_there(tmp_path):
    with pytest.raises(RecordingError, match="the disk is full"):
        write(tmp_path / "a.mkv", grey_pictures(), min_free_bytes=1 << 60)


def test_the_recorder_counts_pictures(tmp_path):
    recorder = Recorder(ClipWriter(tmp_path / "a.mkv"))
    for picture in grey_pictures():
        assert recorder.take(picture, wait=True)
    recorder.close()
    stats = recorder.stats()
    assert recorder.error is None
    assert (stats.frames, stats.events, stats.lost_here) == (5, 0, 0)
    assert stats.seconds == (STAMPS_US[-1] - STAMPS_US[0]) / 1e6
    assert stats.size_bytes == (tmp_path / "a.mkv").stat().st_size

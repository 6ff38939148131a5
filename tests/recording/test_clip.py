"""Clips of other programs: every codec, exact stamps, and every kind of damage."""

import os

import av
import numpy as np
import pytest

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.recording import Clip, labels_path
from neurotouch_hid.recording.clip import check_clip
from tests.recording.clips import US, draw, write_clip

STAMPS_US = [0, 33_000, 50_000, 100_000, 107_000, 200_000, 233_000, 250_000, 300_000, 999_000]


@pytest.mark.parametrize(
    ("ending", "codec", "pixels", "worst"),
    [
        ("mkv", "mjpeg", "yuvj420p", 30),
        ("mkv", "mjpeg", "yuvj422p", 30),
        ("mkv", "ffv1", "gray", 0),
        ("mkv", "ffv1", "yuv420p", 20),  # luma from 16 to 235, as it is
        ("mkv", "ffv1", "gray10le", 2),
        ("mkv", "rawvideo", "gray", 0),
        ("mkv", "rawvideo", "yuyv422", 20),
        ("mkv", "rawvideo", "nv12", 20),
        ("mkv", "libx264", "yuv420p", 60),
        ("mp4", "libx264", "yuv420p", 60),
        ("mp4", "mjpeg", "yuvj420p", 30),
        ("avi", "mjpeg", "yuvj420p", 30),
        ("avi", "rawvideo", "bgr24", 3),  # bottom row first
        ("avi", "rawvideo", "yuyv422", 20),
        ("avi", "mpeg4", "yuv420p", 60),
        ("avi", "ffv1", "gray", 0),
    ],
)
def test_every_codec(tmp_path, ending, codec, pixels, worst):
    pictures = [draw(k) for k in range(10)]
    path = write_clip(tmp_path / f"a.{ending}", pictures, STAMPS_US, codec, pixels)
    clip = Clip(path)
    assert clip.size_px == (640, 480)
    read = list(clip)
    assert len(read) == 10
    stamps = [picture.exposure_end_us for picture in read]
    if ending == "avi":  # it knows a rate only
        assert stamps == [round(k * 1e6 / 30) for k in range(10)]
    else:
        assert stamps == STAMPS_US
    for given, picture in zip(pictures, read, strict=True):
        assert picture.pixels.shape == (480, 640)
        assert np.abs(given.astype(int) - picture.pixels).max() <= worst
        assert (picture.jpeg is not None) == (codec == "mjpeg")
    again = [picture.exposure_end_us for picture in clip]
    assert again == stamps


def test_stamps_of_mp4_are_exact_to_the_microsecond(tmp_path):
    stamps = [7, 33_340, 33_340 + 501, 120_123, 120_124 + 500]
    pictures = [draw(k, (320, 240)) for k in range(5)]
    path = write_clip(tmp_path / "a.mp4", pictures, stamps, "mjpeg")
    assert [picture.exposure_end_us for picture in Clip(path)] == [t - 7 for t in stamps]


def test_a_picture_that_is_not_later_is_left_out(tmp_path):
    stamps = [0, 40_000, 40_100, 80_000]
    pictures = [draw(k, (320, 240)) for k in range(4)]
    clip = Clip(write_clip(tmp_path / "a.mp4", pictures, stamps, "mjpeg"))
    assert [picture.exposure_end_us for picture in clip] == [0, 40_000, 80_000]
    assert clip.n_left_out == 1


@pytest.mark.parametrize(
    "size_px", [(320, 240), (1920, 1200), (480, 640), (1200, 1920), (333, 251)]
)
def test_every_size(tmp_path, size_px):
    pictures = [draw(k, size_px) for k in range(2)]
    clip = Clip(write_clip(tmp_path / "a.mkv", pictures, [0, 8_000], "ffv1", "gray"))
    assert clip.size_px == size_px
    for given, picture in zip(pictures, clip, strict=True):
        assert (given == picture.pixels).all()


@pytest.mark.parametrize("size_px", [(96, 96), (2600, 130)])
def test_impossible_sizes_are_refused(tmp_path, size_px):
    path = write_clip(tmp_path / "a.mkv", [draw(0, size_px)], [0], "ffv1", "gray")
    with pytest.raises(RecordingError, match=f"{size_px[0]}×{size_px[1]} pixels"):
        Clip(path)


def test_another_codec_is_refused_with_its_name(tmp_path):
    path = write_clip(tmp_path / "a.mkv", [draw(0)], [0], "libvpx", "yuv420p")
    with pytest.raises(RecordingError, match="encoded by vp8"):
        Clip(path)


def test_two_video_streams_are_refused(tmp_path):
    path = tmp_path / "a.mkv"
    with av.open(str(path), "w") as container:
        streams = [container.add_stream("ffv1", rate=30) for _ in range(2)]
        for stream in streams:
            stream.width, stream.height, stream.pix_fmt = 320, 240, "gray"
        for stream in streams:
            frame = av.VideoFrame.from_ndarray(draw(0, (320, 240)), format="gray")
            frame.pts, frame.time_base = 0, US
            container.mux(stream.encode(frame))
            container.mux(stream.encode(None))
    with pytest.raises(RecordingError, match="has 2 video streams"):
        Clip(path)


@pytest.mark.parametrize(("ending", "codec"), [("mkv", "ffv1"), ("avi", "mjpeg")])
@pytest.mark.parametrize("share", [0.3, 0.7, 0.9])
def test_a_clip_that_is_cut_off_plays_up_to_there(tmp_path, ending, codec, share):
    pixels = "gray" if codec == "ffv1" else "yuvj420p"
    pictures = [draw(k) for k in range(60)]
    stamps = [k * 33_000 for k in range(60)]
    path = write_clip(tmp_path / f"a.{ending}", pictures, stamps, codec, pixels)
    os.truncate(path, int(path.stat().st_size * share))
    shapes = []
    with pytest.raises(RecordingError, match=r"(is cut off|is damaged) [0-9.]+ s after its first"):
        shapes.extend(picture.pixels.shape for picture in Clip(path))
    assert set(shapes) == {(480, 640)}
    assert len(shapes) == pytest.approx(60 * share, abs=6)


@pytest.mark.parametrize("ending", ["avi", "mkv", "mp4"])
def test_files_that_are_no_clips(tmp_path, ending):
    path = tmp_path / f"a.{ending}"
    with pytest.raises(RecordingError, match="There is no file"):
        check_clip(path)
    for content in (b"", b"x", b"RIFX" * 100, bytes(4) + b"ftyq" * 8):
        path.write_bytes(content)
        with pytest.raises(RecordingError, match=rf"is no \.{ending} file"):
            check_clip(path)
    path.unlink()
    path.mkdir()
    with pytest.raises(RecordingError, match="is a folder"):
        check_clip(path)
    os.mkfifo(tmp_path / f"b.{ending}")
    with pytest.raises(RecordingError, match="it is a pipe"):
        check_clip(tmp_path / f"b.{ending}")


def test_a_head_alone_is_refused(tmp_path):
    pictures = [draw(k) for k in range(3)]
    for ending in ("avi", "mkv", "mp4"):
        path = write_clip(tmp_path / f"a.{ending}", pictures, [0, 33_000, 66_000], "mjpeg")
        os.truncate(path, 40)
        with pytest.raises(RecordingError, match=r"it is (cut off|damaged)|video streams"):
            list(Clip(path))


def test_a_playlist_under_a_clip_s_name_opens_nothing(tmp_path):
    secret = write_clip(tmp_path / "secret.mkv", [draw(0)], [0], "ffv1", "gray")
    for ending in ("avi", "mkv", "mp4"):
        path = tmp_path / f"list.{ending}"
        path.write_text(f"ffconcat version 1.0\nfile '{secret}'\n#EXTM3U\n{secret}\n")
        with pytest.raises(RecordingError):
            Clip(path)


def test_a_clip_whose_data_are_said_to_lie_elsewhere_is_refused(tmp_path):
    """QuickTime's data references can name other files."""
    pictures = [draw(k, (320, 240)) for k in range(3)]
    whole = write_clip(tmp_path / "b.mp4", pictures, [0, 33_000, 66_000], "mjpeg").read_bytes()
    here = b"\x00\x00\x00\x0curl \x00\x00\x00\x01"
    assert here in whole
    # The same number of bytes, so that all places stay.
    begin = whole.index(b"mdat") + 4
    emptied = (
        whole[:begin] + bytes(whole.index(b"moov") - 4 - begin) + whole[whole.index(b"moov") - 4 :]
    )
    path = tmp_path / "a.mp4"
    path.write_bytes(emptied.replace(here, b"\x00\x00\x00\x0curl \x00\x00\x00\x00"))
    with pytest.raises(RecordingError, match="it refers to another file"):
        list(Clip(path))


def test_labels_stand_beside_a_clip(tmp_path):
    assert labels_path(tmp_path / "a.mkv") == tmp_path / "a.labels.csv"

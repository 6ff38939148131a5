"""Clips read by us and by FFmpeg as a whole: the same pictures, bit for bit, at the same times."""

import struct
from fractions import Fraction

import av
import numpy as np
import pytest

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.recording import Clip
from tests.recording.clips import draw, read_by_ffmpeg, write_clip

N = 12
STAMPS_US = [0, 9_000, 33_000, 50_000, 70_000, 107_000, 111_000, 150_000, 152_000, 200_000]
STAMPS_US += [233_000, 999_000]
FRAGMENTS = {"movflags": "frag_keyframe+empty_moov+default_base_moof"}
FRAGMENTS_EDITED = {"movflags": "frag_keyframe+delay_moov"}
"""With an edit list: the first picture comes after it was decoded."""


def make_pictures(size_px):
    chance = np.random.default_rng(0)
    pictures = [draw(k, size_px) + chance.integers(-6, 7, size_px[::-1]) for k in range(N)]
    return [np.clip(picture, 0, 255).astype(np.uint8) for picture in pictures]


def compare(path, worst=0):
    theirs, times_us = read_by_ffmpeg(path)
    ours = list(Clip(path))
    assert [picture.exposure_end_us for picture in ours] == times_us
    for given, picture in zip(theirs, ours, strict=True):
        assert picture.pixels.shape == given.shape
        assert np.abs(given.astype(int) - picture.pixels).max() <= worst


@pytest.mark.parametrize(
    ("ending", "codec", "pixels", "options"),
    [
        ("avi", "png", "gray", {}),
        ("mp4", "png", "gray", {}),
        ("mp4", "png", "gray", {"muxer": {"movflags": "frag_every_frame+empty_moov"}}),
        ("avi", "rawvideo", "gray", {}),
        ("avi", "rawvideo", "bgr24", {}),
        ("avi", "rawvideo", "bgra", {}),
        ("avi", "rawvideo", "yuyv422", {}),
        ("avi", "rawvideo", "uyvy422", {}),
        ("avi", "rawvideo", "nv12", {}),
        ("mkv", "rawvideo", "yuv420p", {}),
        ("mkv", "rawvideo", "yuv422p", {}),
        ("mkv", "rawvideo", "gray", {"muxer": {"live": "1"}}),
        ("mkv", "rawvideo", "gray", {"muxer": {"cluster_time_limit": "40"}}),
        ("mkv", "libx264", "yuv420p", {}),
        ("mkv", "libx264", "yuv444p", {"bf": "0"}),
        ("mkv", "libx264", "yuvj420p", {"muxer": {"write_crc32": "0"}}),
        ("mp4", "libx264", "yuv420p", {"bf": "3", "g": "5"}),
        ("mp4", "libx264", "yuv420p", {"x264-params": "open-gop=1:keyint=5:bframes=3"}),
        ("mp4", "libx264", "yuv420p", {"g": "4", "muxer": FRAGMENTS}),
        ("mp4", "libx264", "yuv420p", {"g": "4", "muxer": FRAGMENTS_EDITED}),
        ("mp4", "libx264", "yuv420p", {"g": "4", "muxer": {"movflags": "hybrid_fragmented"}}),
        ("mp4", "libx264", "yuv420p", {"muxer": {"movflags": "faststart"}}),
        ("avi", "libx264", "yuv420p", {"bf": "0"}),
        ("avi", "mpeg4", "yuv420p", {"bf": "2"}),
        ("mkv", "mpeg4", "yuv420p", {"bf": "2"}),
        ("mp4", "mpeg4", "yuv420p", {"g": "4"}),
        ("mkv", "ffv1", "yuv420p", {"level": "3", "slices": "4"}),
        ("mkv", "ffv1", "yuv422p", {"level": "1"}),
        ("avi", "ffv1", "bgr0", {}),
        ("mp4", "ffv1", "gray", {"strict": "-2"}),
    ],
)
def test_pictures_and_times_are_the_same(tmp_path, ending, codec, pixels, options):
    pictures = make_pictures((250, 130))
    compare(write_clip(tmp_path / f"a.{ending}", pictures, STAMPS_US, codec, pixels, **options))


def change_edit(path, n_entry, *, lasts=None, first=None, speed=None, count=None):
    """Changes an entry of a clip's edit list, as a program that trims does; ms and µs."""
    data = bytearray(path.read_bytes())
    at = data.index(b"elst")
    assert data[at + 4] == 0
    if count is not None:
        data[at + 8 : at + 12] = struct.pack(">I", count)
    for k, value in enumerate((lasts, first, speed)):
        if value is not None:
            place = at + 12 + 12 * n_entry + 4 * k
            data[place : place + 4] = struct.pack(">i", value)
    path.write_bytes(data)


EDITED = [
    ("mjpeg", "yuvj420p", {}),
    ("png", "gray", {}),
    ("libx264", "yuv420p", {"bf": "0", "g": "4"}),
    ("libx264", "yuv420p", {"bf": "3", "g": "5"}),
]


@pytest.mark.parametrize(("codec", "pixels", "options"), EDITED)
def test_a_clip_that_was_cut_begins_and_ends_where_it_should(tmp_path, codec, pixels, options):
    path = tmp_path / "a.mp4"
    write_clip(path, make_pictures((250, 130)), STAMPS_US, codec, pixels, **options)
    whole = [picture.exposure_end_us for picture in Clip(path)]
    (tick,) = {Fraction(s.time_base) for s in av.open(str(path)).streams.video}
    begin = struct.unpack(">i", path.read_bytes()[path.read_bytes().index(b"elst") + 16 :][:4])[0]
    change_edit(path, 0, first=begin + round(Fraction(70_000, 1_000_000) / tick), lasts=170)
    compare(path, worst=codec == "mjpeg")
    assert [p.exposure_end_us for p in Clip(path)] == [t - 70_000 for t in whole[4:11]]


@pytest.mark.parametrize(("codec", "pixels", "options"), EDITED)
def test_a_clip_that_begins_late_is_the_same(tmp_path, codec, pixels, options):
    path, late = tmp_path / "a.mp4", [400_000 + t_us for t_us in STAMPS_US]
    write_clip(path, make_pictures((250, 130)), late, codec, pixels, **options)
    compare(path, worst=codec == "mjpeg")
    assert path.read_bytes()[path.read_bytes().index(b"elst") + 11] == 2  # an empty one first


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"count": 1 << 20}, "is damaged"),
        ({"first": -5}, "is damaged"),
        ({"first": -1}, "is cut in several places"),
        ({"speed": 1 << 17}, "changes its speed"),
        ({"first": 1 << 30}, "has no pictures"),
    ],
)
def test_a_wrong_edit_list_is_one_sentence(tmp_path, change, words):
    path = write_clip(tmp_path / "a.mp4", make_pictures((250, 130)), STAMPS_US, "png", "gray")
    change_edit(path, 0, **change)
    with pytest.raises(RecordingError) as caught:
        list(Clip(path))
    assert words in caught.value.message
    assert caught.value.hint


@pytest.mark.parametrize("size_px", [(333, 251), (121, 2_559), (2_560, 120)])
@pytest.mark.parametrize(
    ("ending", "codec", "pixels"),
    [("avi", "rawvideo", "bgr24"), ("mkv", "ffv1", "gray"), ("mkv", "libx264", "yuv444p")],
)
def test_odd_sizes_are_the_same(tmp_path, size_px, ending, codec, pixels):
    pictures = make_pictures(size_px)
    compare(write_clip(tmp_path / f"a.{ending}", pictures, STAMPS_US, codec, pixels))


@pytest.mark.parametrize("pixels", ["yuvj420p", "yuvj422p", "yuvj444p"])
@pytest.mark.parametrize("ending", ["avi", "mkv", "mp4"])
def test_jpeg_pictures_differ_by_rounding(tmp_path, ending, pixels):
    """Two decoders may round the same JPEG differently, by one."""
    pictures = make_pictures((250, 130))
    compare(write_clip(tmp_path / f"a.{ending}", pictures, STAMPS_US, "mjpeg", pixels), worst=1)


def test_b_frames_in_avi_are_in_order(tmp_path):
    """AVI says when each packet is decoded; FFmpeg itself gives such stamps out of order."""
    pictures = make_pictures((250, 130))
    path = write_clip(tmp_path / "a.avi", pictures, STAMPS_US, "libx264", "yuv420p", bf="2")
    ours = list(Clip(path))
    assert [p.exposure_end_us for p in ours] == [round(k * 1e6 / 30) for k in range(N)]
    for given, picture in zip(read_by_ffmpeg(path)[0], ours, strict=True):
        assert (given == picture.pixels).all()


@pytest.mark.parametrize(("ending", "audio"), [("avi", "pcm_s16le"), ("mkv", "flac")])
def test_sound_is_skipped(tmp_path, ending, audio):
    path = tmp_path / f"a.{ending}"
    base = Fraction(1, 30)
    with av.open(str(path), "w") as container:
        video = container.add_stream("ffv1", rate=30)
        video.width, video.height, video.pix_fmt = 250, 130, "gray"
        sound = container.add_stream(audio, rate=48_000)
        for k, picture in enumerate(make_pictures((250, 130))):
            frame = av.VideoFrame.from_ndarray(picture, format="gray")
            frame.pts, frame.time_base = k, base
            container.mux(video.encode(frame))
            heard = av.AudioFrame.from_ndarray(np.zeros((1, 3_200), np.int16), format="s16")
            heard.rate, heard.pts = 48_000, 1_600 * k
            container.mux(sound.encode(heard))
        container.mux(video.encode(None))
        container.mux(sound.encode(None))
    compare(path)

"""Clips as few programs write them, and the process in which FFmpeg decodes: what it may do."""

import struct
import subprocess
import sys
from contextlib import suppress
from types import SimpleNamespace

import av
import numpy as np
import pytest

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.process.own_command import make_own_python
from neurotouch_hid.recording import Clip, Simulation
from neurotouch_hid.recording.simulation import format_comment
from neurotouch_hid.recording.video import ffmpeg, open_video
from neurotouch_hid.recording.video.ebml import UNKNOWN_SIZE, Name, pack, pack_name, pack_number
from neurotouch_hid.recording.video.matroska_output import make_cluster, make_head
from neurotouch_hid.recording.video.riff import make_bitmap_head
from tests.processes import run_command
from tests.recording.clips import draw, write_clip

MARK = Simulation("program 1", "sim:tour", "neurotouch record", 7)
SIZE = (160, 120)


def read_packets(path):
    """Returns the only track of a clip, and its packets."""
    with path.open("rb") as file:
        video = open_video(file.fileno(), path.suffix)
        return video.tracks[0], list(video.packets())


def make_jpegs(tmp_path, n=3):
    pictures = [draw(k, SIZE) for k in range(n)]
    path = write_clip(tmp_path / "jpegs.mkv", pictures, [8_000 * k for k in range(n)])
    return [packet.data for packet in read_packets(path)[1]]


@pytest.fixture
def started(monkeypatch):
    """Returns the processes that decode, as they are started, and no others."""
    processes = []

    class Noted(subprocess.Popen):
        def __init__(self, *arguments, **options):
            super().__init__(*arguments, **options)
            processes.append(self)

    known = SimpleNamespace(**{**vars(subprocess), "Popen": Noted})
    monkeypatch.setattr(ffmpeg, "subprocess", known)
    return processes


def test_a_comment_behind_the_pictures_is_found(tmp_path):
    """mkvmerge writes the tags last, and says at the begin where they are."""
    head = make_head(b"V_MJPEG", *SIZE).data
    begin = head.index(UNKNOWN_SIZE) + len(UNKNOWN_SIZE)
    clusters = b"".join(make_cluster(8_000 * k, d) for k, d in enumerate(make_jpegs(tmp_path)))
    text = format_comment(MARK).encode()
    simple = pack(Name.TAG_NAME, b"COMMENT") + pack(Name.TAG_STRING, text)
    tags = pack(Name.TAGS, pack(Name.TAG, pack(Name.SIMPLE_TAG, simple)))

    def seek(place):
        where = pack(Name.SEEK_POSITION, place.to_bytes(8, "big"))
        return pack(
            Name.SEEK_HEAD, pack(Name.SEEK, pack(Name.SEEK_ID, pack_name(Name.TAGS)), where)
        )

    place = len(seek(0)) + len(head) - begin + len(clusters)
    path = tmp_path / "a.mkv"
    path.write_bytes(head[:begin] + seek(place) + head[begin:] + clusters + tags)
    assert Clip(path).simulation == MARK
    assert len(list(Clip(path))) == 3
    path.write_bytes(head[:begin] + seek(1 << 60) + head[begin:] + clusters + tags)
    assert Clip(path).simulation is None


@pytest.mark.parametrize("ending", ["avi", "mkv", "mp4"])
def test_the_comment_of_other_writers_is_read(tmp_path, ending):
    path = tmp_path / f"a.{ending}"
    with av.open(str(path), "w") as container:
        container.metadata["comment"] = format_comment(MARK)
        stream = container.add_stream("mjpeg", rate=30)
        stream.width, stream.height, stream.pix_fmt = *SIZE, "yuvj420p"
        frame = av.VideoFrame.from_ndarray(draw(0, SIZE), format="gray").reformat(format="yuvj420p")
        container.mux(stream.encode(frame))
        container.mux(stream.encode(None))
    assert Clip(path).simulation == MARK


def test_what_was_stripped_from_each_packet_is_put_back(tmp_path):
    """mkvmerge can leave out bytes with which every packet begins."""
    jpegs = make_jpegs(tmp_path)
    prefix = jpegs[0][:8]
    assert all(jpeg.startswith(prefix) for jpeg in jpegs)
    head = make_head(b"V_MJPEG", *SIZE).data
    settings = pack(Name.CONTENT_COMPRESSION_SETTINGS, prefix)
    how = pack_number(Name.CONTENT_COMPRESSION_ALGORITHM, 3)
    encoding = pack(Name.CONTENT_ENCODING, pack(Name.CONTENT_COMPRESSION, how, settings))
    at = head.index(pack_name(Name.TRACKS))
    entry = head[at + 12 + 9 :] + pack(Name.CONTENT_ENCODINGS, encoding)
    clusters = b"".join(make_cluster(8_000 * k, d[8:]) for k, d in enumerate(jpegs))
    path = tmp_path / "a.mkv"
    path.write_bytes(head[:at] + pack(Name.TRACKS, pack(Name.TRACK_ENTRY, entry)) + clusters)
    assert [picture.jpeg for picture in Clip(path)] == jpegs


def test_a_raw_picture_with_a_palette(tmp_path):
    """What programs of monochrome cameras write: 8 bits, the bottom row first, grey steps."""

    def chunk(name, data):
        return name + struct.pack("<I", len(data)) + data + bytes(len(data) % 2)

    width, height = 201, 120
    picture = draw(2, (width, height))
    palette = b"".join(bytes((255 - k, 255 - k, 255 - k, 0)) for k in range(256))
    setup = struct.pack("<IiiHH4s5I", 40, width, height, 1, 8, bytes(4), 0, 0, 0, 256, 0) + palette
    head = struct.pack("<4s16x4I", b"vids", 1, 30, 0, 1) + bytes(20)
    stream = chunk(b"LIST", b"strl" + chunk(b"strh", head) + chunk(b"strf", setup))
    header = chunk(b"LIST", b"hdrl" + chunk(b"avih", bytes(56)) + stream)
    rows = np.pad(255 - picture[::-1], ((0, 0), (0, 3))).tobytes()
    movie = chunk(b"LIST", b"movi" + chunk(b"00db", rows))
    path = tmp_path / "a.avi"
    path.write_bytes(chunk(b"RIFF", b"AVI " + header + movie))
    (read,) = Clip(path)
    assert (read.pixels == picture).all()


def test_pictures_that_change_their_size_or_colours_end_in_one_sentence(tmp_path):
    """OpenCV reads beyond the memory of such a picture; that may end its process, not ours."""
    contents = []
    for n, (size, pixels) in enumerate(
        [(SIZE, "yuv444p"), ((1280, 720), "yuv420p"), (SIZE, "gray")]
    ):
        pictures = [draw(k, size) for k in range(3)]
        path = tmp_path / f"{n}.avi"
        write_clip(path, pictures, range(3), "libx264", pixels, bf="0")
        contents += [packet.data for packet in read_packets(path)[1]]
    head = make_head(b"V_MS/VFW/FOURCC", *SIZE, make_bitmap_head(b"H264", *SIZE)).data
    clusters = [make_cluster(33_000 * k, content) for k, content in enumerate(contents)]
    path = tmp_path / "a.mkv"
    path.write_bytes(head + b"".join(clusters))
    read = []
    with suppress(RecordingError):
        read.extend(Clip(path))
    assert len(read) >= 3
    assert {picture.pixels.shape for picture in read} == {(120, 160)}


@pytest.mark.parametrize(
    ("attempt", "error"),
    [
        ("open('/dev/null')", "OSError"),
        ("import socket; socket.socket()", "OSError"),
        ("os.pipe()", "OSError"),
        ("os.write(0, bytes(10))", "OSError"),
        ("bytearray(300 << 20)", "MemoryError"),
    ],
)
def test_what_the_process_that_decodes_may_not_do(tmp_path, attempt, error):
    code = (
        "import os, socket\n"
        "from neurotouch_hid.recording.video import ffmpeg_process\n"
        "ffmpeg_process._limit()\n"
        "os.dup(0)\n"  # FFmpeg's copy of the stream
        f"try:\n    {attempt}\nexcept {error}:\n    os.write(1, b'refused')\n"
    )
    with (tmp_path / "a").open("wb") as file:
        done = run_command(*make_own_python(code), code=None, stdin=file)
    assert done.stdout == "refused", done.stderr


@pytest.mark.parametrize("what", ["os.kill(os.getpid(), 11)", "os._exit(1)", "time.sleep(60)"])
def test_a_process_that_crashes_or_hangs_is_a_damaged_clip(tmp_path, monkeypatch, started, what):
    path = write_clip(
        tmp_path / "a.mkv", [draw(k, SIZE) for k in range(3)], range(3), "ffv1", "gray"
    )
    command = [sys.executable, "-c", f"import os, time; {what}"]
    monkeypatch.setattr(ffmpeg, "make_own_command", lambda **_: command)
    monkeypatch.setattr(ffmpeg, "_LONGEST_S", 2.0)
    with pytest.raises(RecordingError, match="is damaged before its first picture"):
        list(Clip(path))
    assert [process.returncode is None for process in started] == [False]


def test_a_reader_that_stops_early_leaves_no_process(tmp_path, started):
    pictures = [np.random.default_rng(k).integers(0, 255, (480, 640)) for k in range(20)]
    pictures = [picture.astype(np.uint8) for picture in pictures]
    path = write_clip(tmp_path / "a.mkv", pictures, range(0, 160_000, 8_000), "ffv1", "gray")
    reading = iter(Clip(path))
    assert (next(reading).pixels == pictures[0]).all()
    assert [process.poll() for process in started] == [None]
    reading.close()
    assert started[0].returncode is not None


def test_a_png_with_a_wrong_checksum_is_damage(tmp_path):
    pictures = [draw(k, SIZE) for k in range(3)]
    path = write_clip(tmp_path / "a.avi", pictures, range(3), "png", "gray")
    content = bytearray(path.read_bytes())
    at = content.rindex(b"IDAT") + 40
    content[at] ^= 1
    path.write_bytes(content)
    read = []
    with pytest.raises(RecordingError, match=r"is damaged 0\.033 s after its first picture"):
        read.extend(Clip(path))
    assert len(read) == 2


def test_another_codec_is_refused_with_a_command_that_converts_it(tmp_path):
    path = write_clip(tmp_path / "it's.mkv", [draw(0)], [0], "libvpx", "yuv420p")
    with pytest.raises(RecordingError, match="encoded by vp8") as caught:
        Clip(path)
    assert caught.value.hint == (
        f"Convert it: ffmpeg -i '{tmp_path}/it'\"'\"'s.mkv' -an -c:v mjpeg -q:v 2 "
        f"'{tmp_path}/it'\"'\"'s-mjpeg.mp4'"
    )

"""Area of the fuzzing: video clips of a few pictures with bytes changed, cut off or put in."""

import random
from contextlib import suppress
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final
from zlib import crc32

import numpy as np

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.recording import Clip, ClipWriter, Picture, Simulation
from neurotouch_hid.recording.clip import LEAST_PX, MOST_PX
from neurotouch_hid.recording.container import DamageError
from neurotouch_hid.recording.video import open_video
from neurotouch_hid.recording.video.ffmpeg import FFMPEG_CODECS, wrap
from tests.fuzz.area import Area
from tests.recording.clips import draw, write_clip

_KINDS: Final = (
    ("avi", "mjpeg", "yuvj420p", {}),
    ("avi", "rawvideo", "bgr24", {}),
    ("avi", "mpeg4", "yuv420p", {}),
    ("mkv", "mjpeg", "yuvj420p", {}),
    ("mkv", "rawvideo", "nv12", {}),
    ("mkv", "ffv1", "gray", {}),
    ("mkv", "libx264", "yuv420p", {}),
    ("mp4", "libx264", "yuv420p", {}),
    ("mp4", "mjpeg", "yuvj422p", {}),
    ("mp4", "png", "gray", {"muxer": {"movflags": "frag_every_frame+empty_moov"}}),
)
_DECODED: Final = 20
"""Of so many clips that FFmpeg decodes, one is: the process takes as long as a hundred others."""
_ENDINGS: Final = {b"RIFF": ".avi", b"\x1aE\xdf\xa3": ".mkv"}
_BYTES: Final = (0x00, 0x01, 0x7F, 0x80, 0xFF)


@cache
def _whole() -> tuple[bytes, ...]:
    """One sound clip of each kind, of three small pictures."""
    with TemporaryDirectory() as folder:
        pictures, stamps_us = [draw(n, (160, 120)) for n in range(3)], [0, 33_000, 66_000]
        clips = [
            write_clip(Path(folder) / f"{k}.{ending}", pictures, stamps_us, codec, pixels, **more)
            for k, (ending, codec, pixels, more) in enumerate(_KINDS)
        ]
        ours = Path(folder) / "ours.mkv"
        mark = Simulation("program", "sim:tour", "neurotouch record", 7)
        with ClipWriter(ours, simulation=mark) as writer:
            for picture, t_us in zip(pictures, stamps_us, strict=True):
                writer.write(Picture(picture, t_us, t_us))
        return tuple(path.read_bytes() for path in (*clips, ours))


def make_clip(chance: random.Random) -> bytes:
    """Returns a clip with a few faults, most of them in its head."""
    content = bytearray(chance.choice(_whole()))
    for _ in range(chance.choice((1, 1, 2, 5, 20))):
        head = min(len(content), 2000)
        at = chance.randrange(head if chance.random() < 0.7 else len(content))
        match chance.randrange(6):
            case 0 | 1:
                content[at] = chance.choice((*_BYTES, chance.randrange(256)))
            case 2:
                content[at] ^= 1 << chance.randrange(8)
            case 3:
                content[at : at + 4] = chance.choice((b"\xff\xff\xff\x7f", bytes(4), b"\xff" * 4))
            case 4:
                del content[at : at + chance.choice((1, 2, 4, 100))]
            case _:
                content[at:at] = content[at : at + chance.choice((1, 4, 64))]
    if chance.random() < 0.15:
        del content[chance.randint(0, len(content)) :]
    return bytes(content or b"x")


def check_clip(path: Path) -> None:
    """Reads a clip under the name that its first bytes ask for, and checks all that comes out."""
    content = path.read_bytes()
    named = path.with_suffix(_ENDINGS.get(content[:4], ".mp4"))
    named.write_bytes(content)
    try:
        if not _reads_packets(named):
            return
        last_us = -1
        for picture in Clip(named):
            height, width = picture.pixels.shape
            assert min(height, width) >= LEAST_PX, "too small"
            assert max(height, width) <= MOST_PX, "too large"
            assert picture.pixels.dtype == np.uint8, "no bytes"
            assert picture.exposure_end_us > last_us, "order"
            last_us = picture.exposure_end_us
            picture.pixels.sum()
    finally:
        named.unlink()


def _reads_packets(path: Path) -> bool:
    """Returns whether the pictures are wanted; of most clips for FFmpeg reads the packets alone."""
    Clip(path)
    with path.open("rb") as file:
        video = open_video(file.fileno(), path.suffix)
        (track,) = video.tracks
        if track.codec not in FFMPEG_CODECS or not crc32(path.read_bytes()) % _DECODED:
            return True
        with suppress(DamageError):
            for _ in wrap(track, video.packets()):
                pass
    return False


CLIPS: Final = Area(make_clip, check_clip, RecordingError, ".clip")

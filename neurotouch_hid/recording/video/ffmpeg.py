"""Decodes H.264, MPEG-4 and FFV1 by OpenCV's FFmpeg, in a process of its own with limits.

FFmpeg never sees the file. Its packets are put into a plain Matroska stream of ours, and go to the
process through a pipe. What comes back is pictures. A crash there is a damaged clip here.
"""

import contextlib
import os
import select
import subprocess
import threading
from collections.abc import Iterator
from fractions import Fraction
from typing import IO, Final

import numpy as np

from neurotouch_hid.process.own_command import make_own_command
from neurotouch_hid.recording.container import DamageError
from neurotouch_hid.recording.video.ebml import Name, pack
from neurotouch_hid.recording.video.ffmpeg_process import PICTURE_HEAD
from neurotouch_hid.recording.video.matroska_output import make_cluster, make_head
from neurotouch_hid.recording.video.riff import make_bitmap_head
from neurotouch_hid.recording.video.track import MAX_PACKET_BYTES, Packet, Shot, Track

_MATROSKA: Final = {"h264": b"V_MPEG4/ISO/AVC", "mpeg4": b"V_MPEG4/ISO/ASP", "ffv1": b"V_FFV1"}
_LETTERS: Final = {"h264": b"H264", "mpeg4": b"FMP4", "ffv1": b"FFV1"}
FFMPEG_CODECS: Final = tuple(_MATROSKA)

_FIRST_US: Final = 1_000_000
"""Stamp of the first packet; one that is shown before it has a smaller one."""
_MAX_STAMP_US: Final = 1 << 50
_PADDING: Final = pack(Name.VOID, bytes(1 << 18))
"""Comes after the last packet: more than FFmpeg reads in advance. So if it ended before it had read
all packets, something is left in the pipe."""
_LONGEST_S: Final = 30.0
"""A decoder that gives nothing for this time hangs."""


def decode_by_ffmpeg(track: Track, packets: Iterator[Packet]) -> Iterator[Shot]:
    """Gives the pictures of a track, in the order in which they are shown.

    Raises:
        DamageError: the clip breaks off, or FFmpeg could not decode all of it.
    """
    command = make_own_command(module="neurotouch_hid.recording.video.ffmpeg_process")
    process = subprocess.Popen(  # noqa: S603  # our own command
        command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        env={**os.environ, **_ENVIRONMENT},
    )
    assert process.stdin is not None  # noqa: S101  # both are pipes
    assert process.stdout is not None  # noqa: S101
    feeder = _Feeder(track, packets, process.stdin)
    feeder.start()
    try:
        yield from _read_pictures(process.stdout, track, feeder)
        feeder.join()
        if feeder.error is not None:
            raise feeder.error
        if process.wait():
            raise DamageError(0)
    finally:
        process.kill()
        feeder.join()
        process.stdout.close()
        process.wait()


_ENVIRONMENT: Final = {
    "OPENBLAS_NUM_THREADS": "1",
    "OPENCV_FFMPEG_CAPTURE_OPTIONS": "input_format;matroska|protocol_whitelist;pipe",
    "OPENCV_FFMPEG_LOGLEVEL": "-8",
    "OPENCV_LOG_LEVEL": "SILENT",
}
"""No container but ours, nothing but the pipe, and not a word."""


class _Feeder(threading.Thread):
    """Writes the packets of a track as a Matroska stream.

    Attributes:
        error: what ended it early.
        least_ticks: the smallest stamp of the packets so far.
    """

    def __init__(self, track: Track, packets: Iterator[Packet], pipe: IO[bytes]) -> None:
        super().__init__(name="clip", daemon=True)
        self._track, self._packets, self._pipe = track, packets, pipe
        self.error: Exception | None = None
        self.least_ticks = 0

    def run(self) -> None:
        try:
            for data in wrap(self._track, self._note(self._packets)):
                self._pipe.write(data)
        except BrokenPipeError:
            pass  # the process has ended, or nobody wants more pictures
        except Exception as error:  # the reader of the pictures raises it
            self.error = error
        with contextlib.suppress(OSError):
            self._pipe.close()

    def _note(self, packets: Iterator[Packet]) -> Iterator[Packet]:
        for n, packet in enumerate(packets):
            self.least_ticks = min(packet.ticks, self.least_ticks) if n else packet.ticks
            yield packet


def wrap(track: Track, packets: Iterator[Packet]) -> Iterator[bytes]:
    """Gives the parts of a Matroska stream with these packets."""
    codec, private = _MATROSKA[track.codec], track.private
    if track.is_decode_order and track.codec != "ffv1":
        codec = b"V_MS/VFW/FOURCC"
        size = track.width_px, track.height_px
        private = make_bitmap_head(_LETTERS[track.codec], *size, track.private)
    yield make_head(codec, track.width_px, track.height_px, private).data
    first: int | None = None
    for packet in packets:
        first = packet.ticks if first is None else first
        t_us = _FIRST_US + round((packet.ticks - first) * track.tick_s * 1_000_000)
        if not 0 < t_us < _MAX_STAMP_US:
            raise DamageError(0)
        yield make_cluster(t_us, packet.data)
    yield _PADDING


def _read_pictures(pipe: IO[bytes], track: Track, feeder: _Feeder) -> Iterator[Shot]:
    descriptor = pipe.fileno()
    first_us: int | None = None
    before_us = last_us = origin = 0
    while (head := _read(descriptor, PICTURE_HEAD.size)) is not None:
        t_us, width, height = PICTURE_HEAD.unpack(head)
        if width * height > MAX_PACKET_BYTES:
            raise DamageError(0)
        pixels = _read(descriptor, width * height)
        if pixels is None:
            raise DamageError(0)
        if track.is_decode_order and t_us < last_us:  # held back to the end, which has no stamps
            t_us = 2 * last_us - before_us
        before_us, last_us = last_us, t_us
        if first_us is None:  # FFmpeg counts from this one, whose packet it has read
            first_us, origin = t_us, feeder.least_ticks
        ticks = origin + round(Fraction(t_us - first_us, 1_000_000) / track.tick_s)
        grey = np.frombuffer(pixels, np.uint8).reshape(height, width)
        yield Shot(grey, ticks * track.tick_s, None)


def _read(descriptor: int, n: int) -> bytearray | None:
    """Returns ``n`` bytes; None if the process has ended."""
    data = bytearray(n)
    view, done = memoryview(data), 0
    while done < n:
        if not select.select([descriptor], [], [], _LONGEST_S)[0]:
            raise DamageError(0)
        got = os.readv(descriptor, [view[done:]])
        if not got:
            return None
        done += got
    return data

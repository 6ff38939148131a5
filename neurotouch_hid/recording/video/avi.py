"""AVI in: RIFF chunks one after the other, also those of the larger files of OpenDML.

The index is not used: it says nothing that the chunks do not say, and is missing where a program
was killed.
"""

import struct
from collections.abc import Iterator
from fractions import Fraction
from typing import Final

from neurotouch_hid.recording.container import DamageError
from neurotouch_hid.recording.video.riff import parse_bitmap_head
from neurotouch_hid.recording.video.track import (
    MAX_COMMENT_BYTES,
    MAX_TRACKS,
    ClipFile,
    Packet,
    Track,
    Video,
)

_CHUNK: Final = struct.Struct("<4sI")
_MAX_HEAD_BYTES: Final = 1 << 20
_LISTS: Final = (b"RIFF", b"LIST")
_STREAM: Final = struct.Struct("<4s16x4I")
"""Of a stream's header: its kind, the two parts of its rate, its start and its length."""


def read_avi(file: ClipFile) -> Video:
    """Returns the clip in a file.

    Raises:
        DamageError: it has no readable head.
    """
    tracks: list[tuple[int, int, Track]] = []  # with the number of the stream, and its length
    comment, n_streams, movie = "", 0, -1
    for name, begin, size in _walk(file, 0, file.size):
        if name == b"movi":
            movie = begin
            break
        if size > _MAX_HEAD_BYTES or name in (b"RIFF", b"hdrl", b"INFO"):
            continue
        if name == b"strl":
            if n_streams >= MAX_TRACKS:
                raise DamageError(begin)
            found = _read_stream(file, begin, size)
            if found is not None:
                tracks.append((n_streams, *found))
            n_streams += 1
        elif name == b"ICMT":
            comment = _text(file.read(begin, min(size, MAX_COMMENT_BYTES)))
    if movie < 0:
        raise DamageError(file.size, "is cut off")

    def packets() -> Iterator[Packet]:
        number, length, _ = tracks[0]
        yield from _packets(file, movie, number, length)

    return Video(tuple(track for *_, track in tracks), comment, packets)


def _walk(file: ClipFile, at: int, end: int) -> Iterator[tuple[bytes, int, int]]:
    """Gives each chunk's name, begin and size; a list is entered, and named by its kind."""
    while at + _CHUNK.size <= end:
        name, size = _CHUNK.unpack(file.read(at, _CHUNK.size))
        at += _CHUNK.size
        if name in _LISTS and size >= 4:
            yield file.read(at, 4), at + 4, size - 4
            at += 4
        else:
            yield name, at, size
            at += size + size % 2


def _read_stream(file: ClipFile, at: int, size: int) -> tuple[int, Track] | None:
    """Returns the length of a video stream, and its track; None for any other stream."""
    head = setup = b""
    for name, begin, n in _walk(file, at, at + size):
        if name == b"strh":
            head = file.read(begin, min(n, _STREAM.size))
        elif name == b"strf":
            setup = file.read(begin, min(n, _MAX_HEAD_BYTES))
    if head[:4] != b"vids":
        return None
    if len(head) < _STREAM.size:
        raise DamageError(at)
    _, scale, rate, _, length = _STREAM.unpack(head)
    if not (scale and rate):
        raise DamageError(at)
    return length, parse_bitmap_head(setup, Fraction(scale, rate))


def _packets(file: ClipFile, at: int, number: int, length: int) -> Iterator[Packet]:
    ids = tuple(f"{number:02d}{kind}".encode() for kind in ("dc", "db"))
    n = 0
    for name, begin, size in _walk(file, at, file.size):
        if name in ids:
            data = file.read_packet(begin, size)
            if data:  # an empty one repeats the picture before
                yield Packet(data, n)
            n += 1
        elif not name.isascii() or not name.strip(b" ").isalnum():
            raise DamageError(begin)
        elif begin + size > file.size and name not in _UNFINISHED:
            raise DamageError(begin, "is cut off")
    if n < length:
        raise DamageError(file.size, "is cut off")


_UNFINISHED: Final = (b"movi", b"rec ", b"AVI ", b"AVIX")
"""Lists whose size is unknown until they are complete."""


def _text(data: bytes) -> str:
    return data.split(b"\0", 1)[0].decode("utf-8", "replace")

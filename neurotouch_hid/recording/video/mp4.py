"""MP4 in: the tables of its head say where each packet is; fragments have tables of their own."""

import struct
from collections.abc import Generator, Iterator
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import repeat
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.recording.container import DamageError
from neurotouch_hid.recording.video.riff import find_codec
from neurotouch_hid.recording.video.track import (
    MAX_COMMENT_BYTES,
    MAX_PRIVATE_BYTES,
    MAX_TRACKS,
    ClipFile,
    Packet,
    Track,
    Video,
)

_MAX_HEAD_BYTES: Final = 48 << 20
"""Tables of two hours at 125 pictures a second have 22 MB."""
_OBJECT_TYPES: Final = {0x20: "mpeg4", 0x6C: "mjpeg", 0x6D: "png"}
_ENTRY_BYTES: Final = 86
"""Of the description of a video codec, before the boxes in it."""
_EMPTY: Final = -1
"""Place of an edit that shows nothing: the clip begins later."""
_USUAL_SPEED: Final = 1 << 16
_HERE: Final = 1
"""Flag of a data reference: the data are in this file."""


class _Box(NamedTuple):
    kind: bytes
    begin: int
    end: int


@dataclass
class _Samples:
    """The tables of a track: times, sizes and places of its packets."""

    number: int = 0
    times: bytes = b""
    offsets: bytes = b""
    sizes: bytes = b""
    chunk_runs: bytes = b""
    chunks: NDArray[np.uint64] = field(default_factory=lambda: np.empty(0, np.uint64))


class _Usual(NamedTuple):
    """Values for the packets of a fragment that have none of their own."""

    duration: int = 0
    size: int = 0


def read_mp4(file: ClipFile) -> Video:
    """Returns the clip in a file.

    Raises:
        DamageError: it has no readable head.
    """
    for box in _list_file_boxes(file, 0):
        if box.kind == b"moov":
            break
    else:
        raise DamageError(file.size, "is cut off")
    if box.end - box.begin > _MAX_HEAD_BYTES:
        raise DamageError(box.begin)
    head = file.read(box.begin, box.end - box.begin)
    movie_rate = _read_rate(_boxes(head).get(b"mvhd", b""))
    tracks: list[tuple[_Samples, Track]] = []
    usual: dict[int, _Usual] = {}
    comment = ""
    for n, (kind, content) in enumerate(_list_boxes(head)):
        if n >= MAX_TRACKS:
            raise DamageError(box.begin)
        if kind == b"trak":
            found = _read_track(content, movie_rate)
            if found is not None:
                tracks.append(found)
        elif kind == b"mvex":
            usual = _read_usual(content)
        elif kind == b"udta":
            comment = _find_comment(content)

    def packets() -> Iterator[Packet]:
        samples = tracks[0][0]
        end = yield from _packets(file, samples)
        if usual:
            yield from _fragments(file, box.end, samples.number, usual, end)

    shown = (replace(t, first_tick=None, end_tick=None) if usual else t for _, t in tracks)
    return Video(tuple(shown), comment, packets)


def _find_comment(udta: memoryview) -> str:
    """Returns the comment as iTunes and FFmpeg write it: in the list of a box ``meta``."""
    meta = _boxes(udta).get(b"meta", memoryview(b""))
    items = _boxes(_boxes(meta[4:]).get(b"ilst", b""))
    text = _boxes(items.get(b"\xa9cmt", b"")).get(b"data", memoryview(b""))
    return bytes(text[8 : 8 + MAX_COMMENT_BYTES]).decode("utf-8", "replace")


def _list_file_boxes(file: ClipFile, at: int) -> Iterator[_Box]:
    while at + 8 <= file.size:
        size, kind = struct.unpack(">I4s", file.read(at, 8))
        n = 8
        if size == 1:
            (size,) = struct.unpack(">Q", file.read(at + 8, 8))
            n = 16
        elif size == 0:
            size = file.size - at
        if size < n:
            raise DamageError(at)
        yield _Box(kind, at + n, at + size)
        at += size
    if at > file.size:
        raise DamageError(file.size, "is cut off")


def _list_boxes(data: bytes | memoryview) -> Iterator[tuple[bytes, memoryview]]:
    view, at = memoryview(data), 0
    while at + 8 <= len(view):
        size, kind = struct.unpack_from(">I4s", view, at)
        if size < 8 or at + size > len(view):
            raise DamageError(at)
        yield kind, view[at + 8 : at + size]
        at += size


def _boxes(data: bytes | memoryview) -> dict[bytes, memoryview]:
    """Returns the boxes in a box; of several of one kind the first."""
    found: dict[bytes, memoryview] = {}
    for kind, content in _list_boxes(data):
        found.setdefault(kind, content)
    return found


def _take(data: memoryview | bytes, form: str, at: int = 0) -> tuple[int, ...]:
    try:
        return struct.unpack_from(form, data, at)
    except struct.error as error:
        raise DamageError(at) from error


def _read_rate(head: memoryview | bytes) -> int:
    """Returns the ticks a second that a movie's or a track's head tells."""
    (rate,) = _take(head, ">I", 20 if _take(head, ">B")[0] == 1 else 12)
    if not rate:
        raise DamageError(0)
    return rate


def _read_cut(elst: memoryview | bytes, movie_rate: int, rate: int) -> tuple[int, int | None]:
    """Returns the first tick that an edit list shows, and the end; None if it is the clip's own.

    Empty edits delay the whole clip, whose first picture is at 0 s anyway.
    """
    is_long, n = _take(elst, ">B3xI")
    form = ">QqI" if is_long else ">IiI"
    edits = [_take(elst, form, 8 + k * struct.calcsize(form)) for k in range(n)]
    shown = [edit for edit in edits if edit[1] != _EMPTY]
    if len(shown) != 1 or edits[-1][1] == _EMPTY:
        raise DamageError(0, "is cut in several places")
    ((lasts, first, speed),) = shown
    if first < 0:
        raise DamageError(0)
    if speed != _USUAL_SPEED:
        raise DamageError(0, "changes its speed")
    return first, first + lasts * rate // movie_rate if lasts else None


def _read_track(trak: memoryview, movie_rate: int) -> tuple[_Samples, Track] | None:
    """Returns where a video track's packets are, and what they are; None for any other track."""
    outer = _boxes(trak)
    media = _boxes(outer.get(b"mdia", b""))
    if bytes(media.get(b"hdlr", b"")[8:12]) != b"vide":
        return None
    information = _boxes(media.get(b"minf", b""))
    tables = _boxes(information.get(b"stbl", b""))
    rate = _read_rate(media.get(b"mdhd", b""))
    (number,) = _take(
        outer.get(b"tkhd", b""), ">I", 20 if _take(outer.get(b"tkhd", b""), ">B")[0] == 1 else 12
    )
    track = _read_description(tables.get(b"stsd", b""), Fraction(1, rate))
    elst = _boxes(outer.get(b"edts", b"")).get(b"elst")
    if elst is not None and _take(elst, ">I", 4)[0]:
        first, end = _read_cut(elst, movie_rate, rate)
        track = replace(track, first_tick=first, end_tick=end)
    _check_is_here(information.get(b"dinf", b""))
    samples = _Samples(
        number,
        bytes(tables.get(b"stts", bytes(8))),
        bytes(tables.get(b"ctts", b"")),
        bytes(tables.get(b"stsz", bytes(12))),
        bytes(tables.get(b"stsc", bytes(8))),
        _read_chunks(tables),
    )
    return samples, track


def _read_description(stsd: memoryview | bytes, tick_s: Fraction) -> Track:
    entries = list(_list_boxes(stsd[8:]))
    if len(entries) != 1:  # several codecs in turn, or none
        return Track(f"{len(entries)} codecs", 0, 0, tick_s)
    kind, entry = entries[0]
    width, height = _take(entry, ">HH", 24)
    setup = _boxes(entry[_ENTRY_BYTES - 8 :])
    private, codec = b"", find_codec(kind)
    if kind in (b"avc1", b"avc3"):
        codec, private = "h264", bytes(setup.get(b"avcC", b""))
    elif kind == b"mp4v":
        codec, private = _parse_elementary(bytes(setup.get(b"esds", b"")))
    elif codec == "ffv1":
        private = bytes(setup.get(b"glbl", b""))
    if len(private) > MAX_PRIVATE_BYTES:
        raise DamageError(0)
    return Track(codec, width, height, tick_s, private)


def _parse_elementary(esds: bytes) -> tuple[str, bytes]:
    """Returns the codec in an elementary stream descriptor, and what its decoder must know."""
    codec, private, at = "", b"", 4
    while at < len(esds):
        tag, size = esds[at], 0
        at += 1
        for _ in range(4):
            (byte,) = _take(esds, ">B", at)
            at += 1
            size = size << 7 | byte & 0x7F
            if not byte & 0x80:
                break
        if tag == 3:  # the stream: its number and flags, then what is in it
            (flags,) = _take(esds, ">B", at + 2)
            at += 3 + 2 * (flags >> 7) + 2 * (flags >> 5 & 1)
            if flags & 0x40:
                at += 1 + _take(esds, ">B", at)[0]
        elif tag == 4:  # its decoder
            (kind,) = _take(esds, ">B", at)
            codec = _OBJECT_TYPES.get(kind, f"object type {kind:#04x}")
            at += 13
        else:
            if tag == 5:
                private = esds[at : at + size]
            at += size
    return codec, private


def _check_is_here(dinf: memoryview | bytes) -> None:
    """Raises where the packets are said to be in another file; none is ever opened."""
    references = _boxes(dinf).get(b"dref", b"")
    for _, reference in _list_boxes(references[8:]):
        if not _take(reference, ">I")[0] & _HERE:
            raise DamageError(0, "refers to another file")


def _read_chunks(tables: dict[bytes, memoryview]) -> NDArray[np.uint64]:
    """Returns where each group of packets begins in the file, (n,) uint64."""
    name, form = (b"co64", ">u8") if b"co64" in tables else (b"stco", ">u4")
    table = tables.get(name, memoryview(bytes(8)))
    (n,) = _take(table, ">I", 4)
    places = np.frombuffer(table[8:], np.uint8)
    width = int(form[-1])
    if n * width > len(places):
        raise DamageError(0)
    return places[: n * width].view(form).astype(np.uint64)


def _packets(file: ClipFile, samples: _Samples) -> Generator[Packet, None, int]:
    """Gives the packets of the head's tables; returns the time after the last one."""
    times, shifts = _expand(samples.times, ">II"), _expand(samples.offsets, ">Ii")
    sizes, t = _sizes(samples.sizes), 0
    for first, n in _chunks(samples):
        place = first
        for _ in range(n):
            size = next(sizes, None)
            if size is None:
                return t
            if size:
                yield Packet(file.read_packet(place, size), t + next(shifts, 0))
            else:
                next(shifts, 0)
            place += size
            t += next(times, 0)
    if next(sizes, None) is not None:
        raise DamageError(0)
    return t


def _chunks(samples: _Samples) -> Iterator[tuple[int, int]]:
    """Gives the place of each group of packets, and how many are in it."""
    (n_runs,) = _take(samples.chunk_runs, ">I", 4)
    n_chunks, run, n, first_of_next = len(samples.chunks), 0, 0, 1
    for k in range(n_chunks):
        while run < n_runs and k + 1 == first_of_next:
            _, n, description = _take(samples.chunk_runs, ">III", 8 + 12 * run)
            if description != 1:
                raise DamageError(0, "changes its codec")
            run += 1
            if run < n_runs:
                (first_of_next,) = _take(samples.chunk_runs, ">I", 8 + 12 * run)
        yield int(samples.chunks[k]), n


def _expand(table: bytes, form: str) -> Iterator[int]:
    """Gives the values of a table of how often each one follows."""
    n = _take(table, ">I", 4)[0] if table else 0
    for k in range(n):
        count, value = _take(table, form, 8 + 8 * k)
        yield from repeat(value, count)


def _sizes(table: bytes) -> Iterator[int]:
    size, n = _take(table, ">II", 4)
    if size:
        yield from repeat(size, n)
        return
    for k in range(n):
        yield _take(table, ">I", 12 + 4 * k)[0]


def _read_usual(mvex: memoryview) -> dict[int, _Usual]:
    usual = {}
    for kind, content in _list_boxes(mvex):
        if kind == b"trex":
            number, _, duration, size = _take(content, ">IIII", 4)
            usual[number] = _Usual(duration, size)
    return usual


def _fragments(
    file: ClipFile, at: int, number: int, usual: dict[int, _Usual], t: int
) -> Iterator[Packet]:
    """Gives the packets of the fragments behind the head."""
    for box in _list_file_boxes(file, at):
        if box.kind != b"moof":
            continue
        if box.end - box.begin > _MAX_HEAD_BYTES:
            raise DamageError(box.begin)
        moof = file.read(box.begin, box.end - box.begin)
        for kind, traf in _list_boxes(moof):
            if kind == b"traf" and _take(_boxes(traf).get(b"tfhd", b""), ">II")[1] == number:
                t = yield from _fragment(file, traf, box.begin - 8, usual.get(number, _Usual()), t)


def _fragment(
    file: ClipFile, traf: memoryview, moof_at: int, usual: _Usual, t: int
) -> Generator[Packet, None, int]:
    """Gives the packets of one fragment; returns the time after the last one."""
    boxes = _boxes(traf)
    flags, _ = _take(boxes[b"tfhd"], ">II")
    at, base, (duration, size) = 8, moof_at, usual
    if flags & 0x01:
        (base,) = _take(boxes[b"tfhd"], ">Q", at)
        at += 8
    at += 4 * (flags >> 1 & 1)
    if flags & 0x08:
        (duration,) = _take(boxes[b"tfhd"], ">I", at)
        at += 4
    if flags & 0x10:
        (size,) = _take(boxes[b"tfhd"], ">I", at)
    if b"tfdt" in boxes:
        is_long = _take(boxes[b"tfdt"], ">B")[0] == 1
        (t,) = _take(boxes[b"tfdt"], ">Q" if is_long else ">I", 4)
    place = base
    for kind, run in _list_boxes(traf):
        if kind != b"trun":
            continue
        flags, n = _take(run, ">II")
        at = 8
        if flags & 0x01:
            place = base + _take(run, ">i", at)[0]
            at += 4
        at += 4 * (flags >> 2 & 1)
        known = [flags >> bit & 1 for bit in (8, 9, 10, 11)]
        if not any(known[:2]) and not size and n:
            raise DamageError(place)
        for _ in range(n):
            values = iter(_take(run, f">{sum(known)}i", at))
            at += 4 * sum(known)
            lasts = next(values) if known[0] else duration
            n_bytes = next(values) if known[1] else size
            if known[2]:
                next(values)
            shift = next(values) if known[3] else 0
            if n_bytes:
                yield Packet(file.read_packet(place, n_bytes), t + shift)
            place += n_bytes
            t += lasts
    return t

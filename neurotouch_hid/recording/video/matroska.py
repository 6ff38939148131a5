"""Matroska in: one element after the other; the index is not needed."""

import struct
from collections.abc import Iterator
from fractions import Fraction
from typing import Final, NamedTuple

from neurotouch_hid.recording.container import DamageError
from neurotouch_hid.recording.video.ebml import Name
from neurotouch_hid.recording.video.riff import find_codec, parse_bitmap_head
from neurotouch_hid.recording.video.track import (
    MAX_COMMENT_BYTES,
    MAX_PRIVATE_BYTES,
    MAX_TRACKS,
    ClipFile,
    Packet,
    Track,
    Video,
)

_MAX_HEAD_BYTES: Final = 1 << 20
_UNKNOWN: Final = -1
_OUTER: Final = (Name.SEGMENT, Name.CLUSTER)
"""Elements that are entered; what is in them is in no other."""
_VIDEO_TYPE: Final = 1
_HEADER_STRIPPING: Final = 3
_CODECS: Final = {
    "V_MJPEG": "mjpeg",
    "V_MPEG4/ISO/AVC": "h264",
    "V_MPEG4/ISO/SP": "mpeg4",
    "V_MPEG4/ISO/ASP": "mpeg4",
    "V_MPEG4/ISO/AP": "mpeg4",
    "V_FFV1": "ffv1",
    "V_VP8": "vp8",
    "V_VP9": "vp9",
    "V_AV1": "av1",
    "V_MPEGH/ISO/HEVC": "hevc",
}


class _Element(NamedTuple):
    name: int
    begin: int
    size: int


class _Coded(NamedTuple):
    """A track, its number in the blocks, and what was stripped from the start of each packet."""

    number: int
    prefix: bytes
    track: Track


def read_matroska(file: ClipFile) -> Video:
    """Returns the clip in a file.

    Raises:
        DamageError: it has no readable head.
    """
    scale, entries, comment, begin = 1_000_000, b"", "", -1
    segment_at, tags_at, end = 0, -1, file.size
    for element in _walk(file, 0):
        if element.name == Name.SEGMENT:
            segment_at = element.begin
            if element.size != _UNKNOWN:
                end = element.begin + element.size
        elif element.name == Name.SEEK_HEAD:
            tags_at = _find_tags(_read(file, element))
        elif element.name == Name.INFO:
            scale = _number(_children(_read(file, element)).get(Name.TIMESTAMP_SCALE), scale)
        elif element.name == Name.TRACKS:
            entries = _read(file, element)
        elif element.name == Name.TAGS:
            comment = comment or _find_comment(_read(file, element))
        elif element.name == Name.CLUSTER:
            begin = element.begin
            break
    if not comment and begin >= 0 and tags_at >= 0 and segment_at + tags_at > begin:
        comment = _read_late_comment(file, segment_at + tags_at)
    tracks = _read_tracks(entries, Fraction(scale, 1_000_000_000))

    def packets() -> Iterator[Packet]:
        return _packets(file, begin if begin >= 0 else file.size, end, tracks[0])

    return Video(tuple(coded.track for coded in tracks), comment, packets)


def _walk(file: ClipFile, at: int) -> Iterator[_Element]:
    """Gives the elements from a place on, from outside to inside."""
    while at < file.size:
        head = file.read(at, min(12, file.size - at))
        name, size, n = _parse_head(head, 0, at)
        at += n
        yield _Element(name, at, size)
        if name in _OUTER:
            continue
        if size == _UNKNOWN:
            raise DamageError(at)
        at += size


def _parse_head(data: bytes, at: int, place: int) -> tuple[int, int, int]:
    """Returns name and size of an element, and how many bytes tell them."""
    if at >= len(data) or not data[at] >> 4:
        raise DamageError(place, "is damaged" if at < len(data) else "is cut off")
    n_name = 9 - data[at].bit_length()
    if at + n_name >= len(data) or not data[at + n_name]:
        raise DamageError(place, "is damaged" if at + n_name < len(data) else "is cut off")
    n_size = 9 - data[at + n_name].bit_length()
    n = n_name + n_size
    if at + n > len(data):
        raise DamageError(place, "is cut off")
    most = (1 << 7 * n_size) - 1
    size = int.from_bytes(data[at + n_name : at + n], "big") & most
    name = int.from_bytes(data[at : at + n_name], "big")
    return name, _UNKNOWN if size == most else size, n


def _read(file: ClipFile, element: _Element) -> bytes:
    if element.size > _MAX_HEAD_BYTES:
        raise DamageError(element.begin)
    return file.read(element.begin, element.size)


def _list_children(data: bytes) -> Iterator[tuple[int, bytes]]:
    at = 0
    while at < len(data):
        name, size, n = _parse_head(data, at, at)
        at += n
        if size == _UNKNOWN or at + size > len(data):
            raise DamageError(at)
        yield name, data[at : at + size]
        at += size


def _list_named(data: bytes, name: Name) -> Iterator[bytes]:
    return (content for found, content in _list_children(data) if found == name)


def _children(data: bytes) -> dict[int, bytes]:
    """Returns the elements in an element; of several with one name the first."""
    found: dict[int, bytes] = {}
    for name, content in _list_children(data):
        found.setdefault(name, content)
    return found


def _number(data: bytes | None, default: int = 0) -> int:
    if data is None:
        return default
    if len(data) > 8:
        raise DamageError(0)
    return int.from_bytes(data, "big")


def _read_tracks(entries: bytes, tick_s: Fraction) -> list[_Coded]:
    tracks = []
    for n, entry in enumerate(_list_named(entries, Name.TRACK_ENTRY)):
        if n >= MAX_TRACKS or not tick_s:
            raise DamageError(0)
        items = _children(entry)
        if _number(items.get(Name.TRACK_TYPE)) == _VIDEO_TYPE:
            tracks.append(_read_track(items, tick_s))
    return tracks


def _read_track(items: dict[int, bytes], tick_s: Fraction) -> _Coded:
    video = _children(items.get(Name.VIDEO, b""))
    width, height = (_number(video.get(n)) for n in (Name.PIXEL_WIDTH, Name.PIXEL_HEIGHT))
    private = items.get(Name.CODEC_PRIVATE, b"")
    name = items.get(Name.CODEC_ID, b"").rstrip(b"\0").decode("latin-1")
    if len(private) > MAX_PRIVATE_BYTES:
        raise DamageError(0)
    if name == "V_MS/VFW/FOURCC":
        track = parse_bitmap_head(private, tick_s)
    elif name == "V_UNCOMPRESSED":
        letters = video.get(Name.COLOUR_SPACE, b"")[:4]
        track = Track(find_codec(letters), width, height, tick_s)
    else:
        track = Track(_CODECS.get(name, name), width, height, tick_s, private)
    prefix = b""
    for encoding in _list_named(items.get(Name.CONTENT_ENCODINGS, b""), Name.CONTENT_ENCODING):
        packed = _children(_children(encoding).get(Name.CONTENT_COMPRESSION, b""))
        if _number(packed.get(Name.CONTENT_COMPRESSION_ALGORITHM)) != _HEADER_STRIPPING:
            track = Track(f"compressed {track.codec}", width, height, tick_s)
        prefix = packed.get(Name.CONTENT_COMPRESSION_SETTINGS, b"")
    return _Coded(_number(items.get(Name.TRACK_NUMBER)), prefix, track)


def _find_tags(seek_head: bytes) -> int:
    """Returns where the tags are, in bytes from the start of the segment; -1 if it is not said."""
    for seek in _list_named(seek_head, Name.SEEK):
        items = _children(seek)
        if _number(items.get(Name.SEEK_ID)) == Name.TAGS:
            return _number(items.get(Name.SEEK_POSITION), -1)
    return -1


def _read_late_comment(file: ClipFile, at: int) -> str:
    """Returns the comment of tags behind the pictures; none of a file that is cut off before."""
    try:
        element = next(_walk(file, at), None)
        if element is None or element.name != Name.TAGS:
            return ""
        return _find_comment(_read(file, element))
    except DamageError:
        return ""


def _find_comment(tags: bytes) -> str:
    for tag in _list_named(tags, Name.TAG):
        for content in _list_named(tag, Name.SIMPLE_TAG):
            items = _children(content)
            if items.get(Name.TAG_NAME, b"").rstrip(b"\0").upper() == b"COMMENT":
                text = items.get(Name.TAG_STRING, b"")[:MAX_COMMENT_BYTES]
                return text.rstrip(b"\0").decode("utf-8", "replace")
    return ""


def _packets(file: ClipFile, at: int, end: int, coded: _Coded) -> Iterator[Packet]:
    cluster = 0
    for element in _walk(file, at):
        if element.name == Name.TIMESTAMP:
            cluster = _number(_read(file, element))
        elif element.name in (Name.SIMPLE_BLOCK, Name.BLOCK_GROUP):
            block = file.read_packet(element.begin, element.size)
            if element.name == Name.BLOCK_GROUP:
                block = _children(block).get(Name.BLOCK, b"")
            packet = _parse_block(block, cluster, coded, element.begin)
            if packet is not None:
                yield packet
    if end > file.size:
        raise DamageError(file.size, "is cut off")


def _parse_block(block: bytes, cluster: int, coded: _Coded, place: int) -> Packet | None:
    """Returns the packet in a block; None if it is of another track or empty."""
    if not block or not block[0]:
        raise DamageError(place)
    n = 9 - block[0].bit_length()
    if len(block) < n + 3:
        raise DamageError(place)
    if int.from_bytes(block[:n], "big") & (1 << 7 * n) - 1 != coded.number:
        return None
    since, flags = struct.unpack_from(">hB", block, n)
    if flags & 0x06:  # several packets in one block; nobody does so with pictures
        raise DamageError(place)
    data = coded.prefix + block[n + 3 :]
    return Packet(data, cluster + since) if data else None

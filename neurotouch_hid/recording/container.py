r"""Checks the framing of an AEDAT4 file, because no library survives every damaged file.

Measured on files with single flipped bits: ``dv-processing`` never returns from some of them, and
``faery`` panics (and prints) on a damaged header. Both do well once the framing below is sound.

A file is ``#!AER-DAT4.0\r\n``, a size-prefixed FlatBuffer ``IOHE`` (compression, position of the
table at the end or -1, an XML text that names the streams), then packets: stream number and size,
both int32, and that many bytes.
"""

import difflib
import struct
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import IO

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.recording.compression import MAX_BYTES, bound_lz4, bound_zstd

MAGIC = b"#!AER-DAT4.0\r\n"
_AEDAT = b"#!AER-DAT"
_MAX_HEADER_BYTES = 16 << 20
_COMPRESSION_SLOT, _TABLE_SLOT, _TEXT_SLOT = 4, 6, 8  # bytes into the vtable
_COMPRESSIONS = range(5)  # none, LZ4, LZ4 high, Zstandard, Zstandard high
_LZ4 = (1, 2)
_ZSTD = (3, 4)
_MIN_PACKET_BYTES = 12  # the smallest FlatBuffer with a size and a name
_MAX_STREAMS = 1 << 16


def check_recording(path: Path) -> None:
    """Checks that a file is there and has the header of a recording.

    Raises:
        RecordingError: the file is missing, a folder, empty, of another format or damaged.
    """
    if path.is_dir():
        raise RecordingError(
            f"'{path}' is a folder.", hint=f"Give a recording in it: {path}/NAME.aedat4"
        )
    if not path.exists():
        raise RecordingError(f"There is no file '{path}'.", hint=_name_near(path))
    next(packet_sizes(path))


def _name_near(path: Path) -> str:
    """Returns a hint with a recording of nearly the same name, or what else can be done."""
    with suppress(OSError):
        stems = [file.stem for file in path.parent.glob("*.aedat4")]
        near = difflib.get_close_matches(path.stem, stems, 1)
        if near:
            return f"Did you mean {path.with_name(near[0])}.aedat4?"
    return "Check the name. To record one: neurotouch record NAME.aedat4"


def packet_sizes(path: Path) -> Iterator[int]:
    """Checks the header at once, then each packet's frame before the reader comes to it.

    Yields:
        The size of each packet in bytes, up to the end of the packets or of the file.

    Raises:
        RecordingError: the file is missing, empty, of another format or damaged.
    """
    try:
        with path.open("rb", buffering=0) as file:
            yield from _walk(path, file)
    except OSError as error:
        raise RecordingError(f"'{path}' cannot be read: {error.strerror}.") from error


def _walk(path: Path, file: IO[bytes]) -> Iterator[int]:
    end = file.seek(0, 2)
    file.seek(0)
    position, compression, table = _read_header(path, file, end)
    stop = end if table < 0 else min(table, end)
    _check_size(path, stop, _bound(file, compression, stop, end))  # the table
    yield 0  # the header is sound
    while position + 8 <= stop:
        file.seek(position)
        stream, size = struct.unpack("<ii", file.read(8))
        position += 8
        if size < _MIN_PACKET_BYTES or not 0 <= stream < _MAX_STREAMS:
            raise RecordingError(f"'{path}' is damaged at byte {position - 8}.")
        if position + size > end:
            return  # cut off: the library says so
        most = _bound(file, compression, position, position + size)
        if most < 0:
            raise RecordingError(f"'{path}' is damaged at byte {position}.")
        _check_size(path, position, most)
        yield size
        position += size


def _bound(file: IO[bytes], compression: int, begin: int, end: int) -> int:
    """Returns the most that these bytes decompress to; -1 if they are damaged."""

    def read(position: int, n: int) -> bytes:
        file.seek(position)
        return file.read(n)

    if compression in _LZ4:
        return bound_lz4(read, begin, end)
    return bound_zstd(read, begin, end) if compression in _ZSTD else end - begin


def _check_size(path: Path, begin: int, most: int) -> None:
    if most > MAX_BYTES:
        raise RecordingError(
            f"'{path}' has {most >> 20} MB in one piece at byte {begin}, far more than any camera "
            "gives.",
            hint="It is damaged, or made to do harm.",
        )


def _read_header(path: Path, file: IO[bytes], end: int) -> tuple[int, int, int]:
    """Returns the first packet's position, compression, and the table's (-1: never closed)."""
    if end == 0:
        raise RecordingError(f"'{path}' is empty (0 bytes).", hint="Record it again.")
    magic = file.read(len(MAGIC))
    if magic != MAGIC:
        raise _not_aedat4(path, magic)
    cut = RecordingError(f"'{path}' is cut off inside its header.", hint="Copy or record it again.")
    damaged = RecordingError(
        f"'{path}' has a damaged header.", hint="Copy it again from its origin."
    )
    prefix = file.read(4)
    if len(prefix) < 4:
        raise cut
    (size,) = struct.unpack("<I", prefix)
    if size > _MAX_HEADER_BYTES:
        raise damaged
    header = file.read(size)
    if len(header) < size:
        raise cut
    try:
        compression, table = _parse_header(header)
    except (struct.error, ValueError) as error:
        raise damaged from error
    return len(MAGIC) + 4 + size, compression, table


def _not_aedat4(path: Path, magic: bytes) -> RecordingError:
    if MAGIC.startswith(magic):
        return RecordingError(f"'{path}' is cut off inside its header.", hint="Record it again.")
    if magic.startswith(_AEDAT):
        version = magic[len(_AEDAT) :].decode("ascii", "replace").strip()
        return RecordingError(
            f"'{path}' is an AEDAT {version} file, not AEDAT4.",
            hint="Convert it to AEDAT4 with the camera maker's software.",
        )
    return RecordingError(f"'{path}' is not an AEDAT4 recording.", hint="Give a file NAME.aedat4.")


def _parse_header(header: bytes) -> tuple[int, int]:
    """Returns the compression and the table's position.

    Raises:
        ValueError, struct.error: a field points outside the header.
    """

    def read(kind: str, at: int) -> int:
        if at < 0:
            raise ValueError(at)
        return int(struct.unpack_from(kind, header, at)[0])

    if header[4:8] != b"IOHE":
        raise ValueError(header[4:8])
    root = read("<I", 0)
    vtable = root - read("<i", root)
    length = read("<H", vtable)

    def field(slot: int) -> int:
        offset = read("<H", vtable + slot) if slot + 2 <= length else 0
        return root + offset if offset else -1

    at = field(_COMPRESSION_SLOT)
    compression = read("<i", at) if at >= 0 else 0
    if compression not in _COMPRESSIONS:
        raise ValueError(compression)
    text = field(_TEXT_SLOT)
    begin = text + read("<I", text) + 4
    stop = begin + read("<I", begin - 4)
    if stop > len(header):
        raise ValueError(stop)
    header[begin:stop].decode("utf-8")
    table = field(_TABLE_SLOT)
    return compression, read("<q", table) if table >= 0 else -1

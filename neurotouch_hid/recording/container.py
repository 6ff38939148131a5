r"""The outside of an AEDAT4 file, checked here because no library survives every damaged one.

Measured on files with single flipped bits: ``dv-processing`` never returns from some of them, and
``faery`` panics (and prints) on a damaged header. Both do well once the framing below is sound.

A file is ``#!AER-DAT4.0\r\n``, a size-prefixed FlatBuffer ``IOHE`` (compression, position of the
table at the end or -1, an XML text that names the streams), then packets: stream number and size,
both int32, and so many bytes.
"""

import struct
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from neurotouch_hid.errors import RecordingError

MAGIC = b"#!AER-DAT4.0\r\n"
_AEDAT = b"#!AER-DAT"
_MAX_HEADER_BYTES = 16 << 20
_TABLE_SLOT, _TEXT_SLOT = 6, 8  # bytes from the vtable's start to the fields' places
_COMPRESSIONS = range(5)  # none, LZ4, LZ4 high, Zstandard, Zstandard high


def packet_sizes(path: Path) -> Iterator[int]:
    """Check the header at once, then each packet's frame before the reader comes to it.

    Yields:
        The size of each packet in bytes, up to the end of the packets or of the file.

    Raises:
        RecordingError: the file is missing, empty, of another format or damaged.
    """
    try:
        with path.open("rb") as file:
            yield from _walk(path, file)
    except OSError as error:
        raise RecordingError(f"{path} cannot be read: {error.strerror}") from error


def _walk(path: Path, file: BinaryIO) -> Iterator[int]:
    end = file.seek(0, 2)
    file.seek(0)
    position, table = _read_header(path, file, end)
    yield 0  # the header is sound
    n_streams_max = 1 << 16
    while position < (end if table < 0 else min(table, end)):
        file.seek(position)
        frame = file.read(8)
        if len(frame) < 8:
            return  # cut off: the library says so
        stream, size = struct.unpack("<ii", frame)
        if size <= 8 or not 0 <= stream < n_streams_max:
            raise RecordingError(f"{path} is damaged at byte {position}")
        if position + 8 + size > end:
            return
        yield size
        position += 8 + size


def _read_header(path: Path, file: BinaryIO, end: int) -> tuple[int, int]:
    """Position of the first packet, and of the table (-1: the file was never closed)."""
    if end == 0:
        raise RecordingError(f"{path} is empty (0 bytes)", hint="record it again")
    magic = file.read(len(MAGIC))
    if magic != MAGIC:
        raise _not_aedat4(path, magic)
    cut = RecordingError(f"{path} is cut off inside its header", hint="copy or record it again")
    damaged = RecordingError(f"{path} has a damaged header", hint="copy it again from its origin")
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
        table = _parse_header(header)
    except (struct.error, ValueError) as error:
        raise damaged from error
    return len(MAGIC) + 4 + size, table


def _not_aedat4(path: Path, magic: bytes) -> RecordingError:
    if MAGIC.startswith(magic):
        return RecordingError(f"{path} is cut off inside its header", hint="record it again")
    if magic.startswith(_AEDAT):
        version = magic[len(_AEDAT) :].decode("ascii", "replace").strip()
        return RecordingError(
            f"{path} is an AEDAT {version} file, not AEDAT4",
            hint="convert it to AEDAT4 with the camera maker's software",
        )
    return RecordingError(f"{path} is not an AEDAT4 recording", hint="give a file NAME.aedat4")


def _parse_header(header: bytes) -> int:
    """The table's position.

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

    compression = field(4)
    if compression >= 0 and read("<i", compression) not in _COMPRESSIONS:
        raise ValueError(compression)
    text = field(_TEXT_SLOT)
    begin = text + read("<I", text) + 4
    stop = begin + read("<I", begin - 4)
    if stop > len(header):
        raise ValueError(stop)
    header[begin:stop].decode("utf-8")
    table = field(_TABLE_SLOT)
    return read("<q", table) if table >= 0 else -1

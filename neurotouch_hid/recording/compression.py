"""The size of a decompressed packet, read from its framing before anything is decompressed.

The formats: LZ4 frame format 1.6.4 and RFC 8878 (Zstandard). Both cut their content in blocks. A
small file can mean a gigabyte of memory, but only with many blocks.
"""

import struct
from collections.abc import Callable
from typing import Final

MAX_BYTES: Final = 256 << 20
"""No packet is larger: 16 million events, or 2 900 frames. Writers put some thousand events or one
frame in a packet."""

_LZ4_MAGIC: Final = 0x184D2204
_LZ4_BLOCK_BYTES: Final = {4: 64 << 10, 5: 256 << 10, 6: 1 << 20, 7: 4 << 20}
_ZSTD_MAGIC: Final = 0xFD2FB528
_ZSTD_SKIPPABLE: Final = range(0x184D2A50, 0x184D2A60)
_ZSTD_BLOCK_BYTES: Final = 128 << 10
_ZSTD_RUN: Final = 1  # of the block types: one byte, repeated

Read = Callable[[int, int], bytes]
"""Returns this many bytes from a position; fewer at the end."""


def bound_lz4(read: Read, begin: int, end: int) -> int:
    """Returns the most that an LZ4 frame which fills these bytes exactly decompresses to.

    -1 if none does.

    A frame that ends early decompresses to nothing, which no reader expects: it counts as none.

    Args:
        read: returns bytes of the file.
        begin: position of the first byte.
        end: position after the last.
    """
    head = read(begin, 6)
    if len(head) < 6 or struct.unpack_from("<I", head)[0] != _LZ4_MAGIC:
        return -1
    flags, largest = head[4], _LZ4_BLOCK_BYTES.get(head[5] >> 4 & 7, 0)
    position = begin + 7 + (8 if flags & 8 else 0) + (4 if flags & 1 else 0)
    n_blocks = 0
    while position + 4 <= end:
        (block,) = struct.unpack("<I", read(position, 4))
        position += 4
        if block == 0:
            whole = n_blocks > 0 and position + (4 if flags & 4 else 0) == end
            return n_blocks * largest if whole else -1
        position += (block & 0x7FFFFFFF) + (4 if flags & 16 else 0)
        n_blocks += 1
    return -1


def bound_zstd(read: Read, begin: int, end: int) -> int:
    """Returns the most that the Zstandard frames in these bytes decompress to.

    Other data counts as 0.

    The library itself reports an incomplete frame.
    """
    most, position = 0, begin
    while position + 8 <= end:
        (magic,) = struct.unpack("<I", read(position, 4))
        if magic in _ZSTD_SKIPPABLE:
            position += 8 + int(struct.unpack("<I", read(position + 4, 4))[0])
        elif magic == _ZSTD_MAGIC:
            size, position = _walk_zstd(read, position, end)
            most += size
        else:
            break
    return most


def _walk_zstd(read: Read, begin: int, end: int) -> tuple[int, int]:
    """Returns the most that one frame decompresses to, and the position after it."""
    flags = read(begin + 4, 1)[0]
    single, size_code = flags >> 5 & 1, flags >> 6
    size_bytes = (single, 2, 4, 8)[size_code]
    position = begin + 5 + (1 - single) + (0, 1, 2, 4)[flags & 3] + size_bytes
    most = 0
    while position + 3 <= end:
        block = int.from_bytes(read(position, 3), "little")
        is_last, kind, size = block & 1, block >> 1 & 3, block >> 3
        position += 3 + (1 if kind == _ZSTD_RUN else size)
        most += max(size, _ZSTD_BLOCK_BYTES)
        if is_last:
            break
    return most, position + (4 if flags & 4 else 0)

"""Decompresses packets, never to more than a limit, whatever their bytes say."""

import struct
import sys
from typing import Any, Final

import lz4.frame

MAX_BYTES: Final = 32 << 20
"""No packet is larger: 2 million events, or 370 frames. Writers put some thousand events or one
frame in a packet."""

NONE, LZ4, LZ4_HIGH, ZSTD, ZSTD_HIGH = range(5)
COMPRESSIONS: Final = range(5)
"""The compressions of the format, by their number."""

_USUAL_BYTES: Final = 1 << 17  # most packets are read at once, which is quicker
_SIZE: Final = struct.Struct("<I")
_WINDOW_LOG: Final = MAX_BYTES.bit_length() - 1  # what the decoder of Zstandard itself may take


class TooLargeError(ValueError):
    """A packet says that it has more than ``MAX_BYTES``; ``size`` has how many."""

    def __init__(self, size: int) -> None:
        super().__init__(size)
        self.size = size


def decompress(data: bytes, compression: int) -> bytes | memoryview:
    """Returns the FlatBuffer in a packet, without the size in front of it.

    The size is read first, so no more memory is taken than the packet says and ``MAX_BYTES``.

    Args:
        data: the packet as it is in the file.
        compression: one of ``COMPRESSIONS``.

    Raises:
        ValueError: it is damaged, or larger than ``MAX_BYTES``.
    """
    if compression == NONE:
        size = _read_size(data)
        if size != len(data) - _SIZE.size:
            raise ValueError("the size is not that of the packet")
        return memoryview(data)[_SIZE.size :]
    decoder, failures = _make_decoder(compression)
    try:
        content = decoder.decompress(data, _USUAL_BYTES)
        end = _SIZE.size + _read_size(content)
        if not decoder.eof:  # one byte more, which must not be there
            content += decoder.decompress(b"", max(end + 1 - len(content), 1))
    except failures as error:
        raise ValueError(str(error)) from error
    if len(content) != end or not decoder.eof or decoder.unused_data:
        raise ValueError("the compressed data do not end with the packet")
    return memoryview(content)[_SIZE.size :]


def _read_size(head: bytes) -> int:
    if len(head) < _SIZE.size:
        raise ValueError("there is no size")
    size = int(_SIZE.unpack_from(head)[0])
    if size > MAX_BYTES:
        raise TooLargeError(size)
    return size


def _make_decoder(compression: int) -> tuple[Any, tuple[type[Exception], ...]]:
    """Returns a decoder with the interface of ``bz2``, and what it raises for damaged data."""
    if compression in (LZ4, LZ4_HIGH):
        return lz4.frame.LZ4FrameDecompressor(), (RuntimeError, EOFError)
    if sys.version_info >= (3, 14):
        from compression import zstd  # noqa: PLC0415 - few recordings need it
    else:
        from backports import zstd  # noqa: PLC0415
    options: dict[int, int] = {zstd.DecompressionParameter.window_log_max: _WINDOW_LOG}
    return zstd.ZstdDecompressor(options=options), (zstd.ZstdError, EOFError)

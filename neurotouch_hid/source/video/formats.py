"""Grey pictures of the formats that cameras send."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.source.video.capture import PictureFormat

COMPRESSED: Final = ("MJPG", "JPEG")
_FIRST_BYTE: Final = {"YUYV": (2, 0), "UYVY": (2, 1)}
"""Formats with colours between the grey values: bytes per pixel, and the offset of the first."""
_GREY_FIRST: Final = ("GREY", "NV12", "NV21", "YU12", "YV12")
"""Formats that begin with all grey values, a byte each."""
KNOWN: Final = (*_GREY_FIRST, *_FIRST_BYTE, *COMPRESSED)
"""The formats that can be read, by V4L2's four letters."""

_START: Final = b"\xff\xd8"
_END: Final = b"\xff\xd9"
_MOST_PADDING: Final = 64
"""Bytes after the end of a JPEG picture that are looked through for its end mark."""
_MOST_SEGMENTS: Final = 64
_SIZES: Final = frozenset((0xC0, 0xC1, 0xC2))
"""Segments of a JPEG picture that state its size: baseline, extended, progressive."""
_SCAN: Final = 0xDA


class GreyReader:
    """Makes grey pictures of the bytes of one format, in memory of its own.

    Args:
        picture: the format; its four letters must be in ``KNOWN``.
    """

    def __init__(self, picture: PictureFormat) -> None:
        self._size = picture.width, picture.height
        self._is_compressed = picture.fourcc in COMPRESSED
        self._n_bytes, self._offset = _FIRST_BYTE.get(picture.fourcc, (1, 0))
        row_bytes = self._n_bytes * picture.width
        self._stride = max(picture.stride, row_bytes)
        self._n_needed = self._stride * (picture.height - 1) + row_bytes
        self._grey = np.empty((picture.height, picture.width), np.uint8)

    def read(self, data: NDArray[np.uint8]) -> NDArray[np.uint8] | None:
        """Returns the grey picture (h, w) uint8 of some bytes (n,) uint8; None if it is damaged.

        The picture is valid until the next call.
        """
        width, height = self._size
        if self._is_compressed:
            return _decode_jpeg(data, width, height)
        if len(data) < self._n_needed:
            return None
        values = np.lib.stride_tricks.as_strided(
            data[self._offset :], (height, width), (self._stride, self._n_bytes), writeable=False
        )
        np.copyto(self._grey, values)
        return self._grey


def _decode_jpeg(data: NDArray[np.uint8], width: int, height: int) -> NDArray[np.uint8] | None:
    import cv2  # noqa: PLC0415  # 0.1 s, which a camera without compression does not need

    if not _is_whole(data) or _find_size(data) != (width, height):
        return None
    try:
        grey = cv2.imdecode(data, cv2.IMREAD_GRAYSCALE | cv2.IMREAD_IGNORE_ORIENTATION)
    except cv2.error:
        return None
    return None if grey is None or grey.shape != (height, width) else np.asarray(grey, np.uint8)


def _is_whole(data: NDArray[np.uint8]) -> bool:
    """Returns whether both ends of a JPEG picture are there; a decoder fills up what is missing."""
    return data[:2].tobytes() == _START and _END in data[-_MOST_PADDING:].tobytes()


def _find_size(data: NDArray[np.uint8]) -> tuple[int, int] | None:
    """Returns the size (width, height) that a JPEG picture states, before any memory is taken."""
    at = 2
    for _ in range(_MOST_SEGMENTS):
        head = data[at : at + 9].tobytes()
        if len(head) < 9 or head[0] != 0xFF or head[1] == _SCAN:
            return None
        if head[1] in _SIZES:
            return int.from_bytes(head[7:9], "big"), int.from_bytes(head[5:7], "big")
        at += 2 + int.from_bytes(head[2:4], "big")
    return None

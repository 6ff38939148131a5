"""Grey pictures of the formats that cameras send."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.recording.jpeg import decode_jpeg
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
            return decode_jpeg(data, width, height) if _is_whole(data) else None
        if len(data) < self._n_needed:
            return None
        values = np.lib.stride_tricks.as_strided(
            data[self._offset :], (height, width), (self._stride, self._n_bytes), writeable=False
        )
        np.copyto(self._grey, values)
        return self._grey


def _is_whole(data: NDArray[np.uint8]) -> bool:
    """Returns whether both ends of a JPEG picture are there; a decoder fills up what is missing."""
    return data[:2].tobytes() == _START and _END in data[-_MOST_PADDING:].tobytes()

"""Grey pictures of JPEG bytes, from a camera or a clip; their size is checked before."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

_MOST_SEGMENTS: Final = 64
_SIZES: Final = frozenset((0xC0, 0xC1, 0xC2))
"""Segments of a JPEG picture that state its size: baseline, extended, progressive."""
_SCAN: Final = 0xDA


def decode_jpeg(data: NDArray[np.uint8], width: int, height: int) -> NDArray[np.uint8] | None:
    """Returns the grey picture (h, w) uint8 of a JPEG; None if it is damaged or of another size.

    Args:
        data: (n,) uint8.
        width: that the picture must have, in px.
        height: that the picture must have, in px.
    """
    if _find_size(data) != (width, height):
        return None
    return decode_grey(data, width, height)


def decode_grey(data: NDArray[np.uint8], width: int, height: int) -> NDArray[np.uint8] | None:
    """Returns the same of any compressed picture whose size has been checked."""
    import cv2  # noqa: PLC0415  # 0.1 s, which a camera without compression does not need

    try:
        grey = cv2.imdecode(data, cv2.IMREAD_GRAYSCALE | cv2.IMREAD_IGNORE_ORIENTATION)
    except cv2.error:
        return None
    return None if grey is None or grey.shape != (height, width) else np.asarray(grey, np.uint8)


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

"""The pictures that the camera offers: formats, sizes and rates, and how each format is written."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

_JPEG_QUALITY = 80
_NO_COLOUR = 128


class PixelFormat(StrEnum):
    """Pixel formats, by their four characters in V4L2."""

    GREY = "GREY"
    YUYV = "YUYV"
    NV12 = "NV12"
    MJPEG = "MJPG"

    @property
    def bits_per_pixel(self) -> int:
        """Bits of a pixel; of MJPEG, the most that a picture may need."""
        return {PixelFormat.GREY: 8, PixelFormat.NV12: 12}.get(self, 16)


@dataclass(frozen=True, slots=True)
class Mode:
    """One way to send pictures.

    Attributes:
        pixel_format: how pixels are written.
        width: pixels of a row.
        height: rows.
        intervals: times from picture to picture that can be chosen, in units of 100 ns.
    """

    pixel_format: PixelFormat
    width: int
    height: int
    intervals: tuple[int, ...] = (80_000, 166_666)

    @property
    def max_bytes(self) -> int:
        """The most bytes of a picture."""
        return self.width * self.height * self.pixel_format.bits_per_pixel // 8

    def write(self, grey: NDArray[np.uint8]) -> bytes:
        """Returns the bytes of a picture.

        Args:
            grey: (h, w) uint8, scaled if its size is another one.
        """
        size = (self.width, self.height)
        if grey.shape != size[::-1]:
            import cv2  # noqa: PLC0415 - takes long, and not every picture needs it

            grey = cv2.resize(grey, size, interpolation=cv2.INTER_LINEAR).astype(np.uint8)
        match self.pixel_format:
            case PixelFormat.GREY:
                return grey.tobytes()
            case PixelFormat.YUYV:
                return np.dstack([grey, np.full_like(grey, _NO_COLOUR)]).tobytes()
            case PixelFormat.NV12:
                return grey.tobytes() + bytes([_NO_COLOUR]) * (grey.size // 2)
            case PixelFormat.MJPEG:
                return _write_jpeg(grey)


SIZES = ((640, 480), (320, 240), (1280, 800))
MODES = tuple(
    Mode(pixel_format, width, height) for pixel_format in PixelFormat for width, height in SIZES
)
"""All that the camera can offer, those of a format together."""


def _write_jpeg(grey: NDArray[np.uint8]) -> bytes:
    """Returns a JPEG with colour at half the width (4:2:2), as cameras send it."""
    import cv2  # noqa: PLC0415 - as above

    options = [
        *(cv2.IMWRITE_JPEG_QUALITY, _JPEG_QUALITY),
        *(cv2.IMWRITE_JPEG_SAMPLING_FACTOR, cv2.IMWRITE_JPEG_SAMPLING_FACTOR_422),
    ]
    return cv2.imencode(".jpg", cv2.cvtColor(grey, cv2.COLOR_GRAY2BGR), options)[1].tobytes()

"""The words that AVI files have for codecs and raw pictures; Matroska takes them over."""

import struct
from fractions import Fraction
from typing import Final

from neurotouch_hid.recording.container import DamageError
from neurotouch_hid.recording.video.track import MAX_PRIVATE_BYTES, Track

_HEAD: Final = struct.Struct("<IiiHH4s5I")
"""A BITMAPINFOHEADER: size, width, height, planes, bits of a pixel, four letters of the codec."""
_CODECS: Final = {
    **dict.fromkeys(("MJPG", "JPEG", "AVRN", "DMB1"), "mjpeg"),
    **dict.fromkeys(("MPNG", "PNG ", "PNG1"), "png"),
    **dict.fromkeys(("H264", "X264", "AVC1", "DAVC", "VSSH"), "h264"),
    **dict.fromkeys(("FMP4", "XVID", "DIVX", "DX50", "MP4V", "M4S2", "MP4S"), "mpeg4"),
    "FFV1": "ffv1",
    **dict.fromkeys(("HEVC", "HVC1", "HEV1"), "hevc"),  # names for the error
    **dict.fromkeys(("VP80", "VP08"), "vp8"),
    **dict.fromkeys(("VP90", "VP09"), "vp9"),
    "AV01": "av1",
}
_BGR: Final = {8: "PAL8", 24: "BGR3", 32: "BGR4"}
"""Raw pictures without four letters, by their bits of a pixel."""


def find_codec(letters: bytes) -> str:
    """Returns the name of a codec, or of a raw format, from its four letters."""
    text = letters.decode("latin-1").upper()
    return _CODECS.get(text, text)


def parse_bitmap_head(head: bytes, tick_s: Fraction) -> Track:
    """Returns the track that a BITMAPINFOHEADER describes.

    Raises:
        DamageError: it is none.
    """
    if not _HEAD.size <= len(head) <= MAX_PRIVATE_BYTES:
        raise DamageError(0)
    _, width, height, _, bits, letters, *_ = _HEAD.unpack_from(head)
    codec, is_bottom_up = find_codec(letters), False
    if letters == bytes(4):
        codec, is_bottom_up = _BGR.get(bits, f"RGB{bits}"), height > 0
    return Track(
        codec,
        width,
        abs(height),
        tick_s,
        private=head[_HEAD.size :],
        is_bottom_up=is_bottom_up,
        is_decode_order=True,
    )


def make_bitmap_head(letters: bytes, width_px: int, height_px: int, private: bytes = b"") -> bytes:
    """Returns a BITMAPINFOHEADER of a compressed picture."""
    size = _HEAD.size + len(private)
    n_bytes = 3 * width_px * height_px
    head = _HEAD.pack(size, width_px, height_px, 1, 24, letters, n_bytes, 0, 0, 0, 0)
    return head + private

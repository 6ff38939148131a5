"""Grey pictures of a clip's packets: JPEG and PNG by OpenCV, raw ones as they are.

H.264, MPEG-4 and FFV1 go to FFmpeg, in a process of its own.
"""

from collections.abc import Callable, Iterator
from typing import Final
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.recording.container import DamageError
from neurotouch_hid.recording.jpeg import decode_grey, decode_jpeg
from neurotouch_hid.recording.video.ffmpeg import FFMPEG_CODECS, decode_by_ffmpeg
from neurotouch_hid.recording.video.track import Packet, Shot, Track, Video

_Decoder = Callable[[bytes, Track], NDArray[np.uint8] | None]

_GREY_FIRST: Final = (
    *("Y800", "Y8  ", "GREY", "I420", "IYUV", "YV12", "NV12", "NV21"),
    *("Y42B", "422P", "444P"),
)
"""Raw formats that begin with all grey values, a byte each."""
_PACKED: Final = {"YUY2": 0, "YUYV": 0, "YUNV": 0, "YVYU": 0, "UYVY": 1, "UYNV": 1, "HDYC": 1}
"""First grey value of raw formats with two bytes a pixel."""
_PNG_MAGIC_BYTES: Final = 8
_PNG_HEAD: Final = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR"
_PALETTE_BYTES: Final = 1024


def decode(video: Video) -> Iterator[Shot]:
    """Gives the pictures of a clip with one track, in the order in which they are shown.

    Raises:
        DamageError: the clip breaks off, or a picture cannot be decoded.
    """
    (track,) = video.tracks
    if track.codec in FFMPEG_CODECS:
        shots = decode_by_ffmpeg(track, video.packets())
    else:
        decode_picture = _DECODERS[track.codec]
        shots = (_decode(packet, track, decode_picture) for packet in video.packets())
    return (shot for shot in shots if track.shows(shot.time_s))


def _decode(packet: Packet, track: Track, decode_picture: _Decoder) -> Shot:
    pixels = decode_picture(packet.data, track)
    if pixels is None:
        raise DamageError(0)
    jpeg = packet.data if track.codec == "mjpeg" else None
    return Shot(pixels, packet.ticks * track.tick_s, jpeg)


def _decode_jpeg(data: bytes, track: Track) -> NDArray[np.uint8] | None:
    return decode_jpeg(np.frombuffer(data, np.uint8), track.width_px, track.height_px)


def _decode_png(data: bytes, track: Track) -> NDArray[np.uint8] | None:
    size = track.width_px.to_bytes(4, "big") + track.height_px.to_bytes(4, "big")
    if not data.startswith(_PNG_HEAD + size) or not _is_whole_png(data):
        return None
    return decode_grey(np.frombuffer(data, np.uint8), track.width_px, track.height_px)


def _is_whole_png(data: bytes) -> bool:
    """Returns whether all checksums are right; the decoder would print a line about a wrong one."""
    view, at = memoryview(data), _PNG_MAGIC_BYTES
    while at + 12 <= len(view):
        end = at + 8 + int.from_bytes(view[at : at + 4], "big")
        kind = data[at + 4 : at + 8]
        if crc32(view[at + 4 : end]).to_bytes(4, "big") != data[end : end + 4]:
            return False
        if kind == b"IEND":
            return True
        at = end + 4
    return False


def _take_grey(data: bytes, track: Track) -> NDArray[np.uint8] | None:
    return _view(data, track, 1, track.width_px)


def _take_every_second(data: bytes, track: Track) -> NDArray[np.uint8] | None:
    rows = _view(data, track, 2, 2 * track.width_px)
    return None if rows is None else rows[:, _PACKED[track.codec] :: 2]


def _mix_colours(data: bytes, track: Track) -> NDArray[np.uint8] | None:
    import cv2  # noqa: PLC0415  # as in decode_grey

    n = int(track.codec[3])
    rows = _view(data, track, n, -(-n * track.width_px // 4) * 4)
    if rows is None:
        return None
    grey = cv2.cvtColor(rows.reshape(track.height_px, -1, n), cv2.COLOR_BGR2GRAY)
    return np.asarray(grey, np.uint8)


def _look_up(data: bytes, track: Track) -> NDArray[np.uint8] | None:
    rows = _view(data, track, 1, -(-track.width_px // 4) * 4)
    if rows is None:
        return None
    colours = np.frombuffer(track.private[:_PALETTE_BYTES].ljust(_PALETTE_BYTES, b"\0"), np.uint8)
    blue, green, red, _ = colours.reshape(256, 4).T.astype(np.float64)
    table = np.rint(0.114 * blue + 0.587 * green + 0.299 * red).astype(np.uint8)
    return table[rows]


def _view(data: bytes, track: Track, n_bytes: int, stride: int) -> NDArray[np.uint8] | None:
    """Returns the rows of a raw picture, (h, w * n_bytes) uint8, the top one first."""
    if len(data) < stride * (track.height_px - 1) + n_bytes * track.width_px:
        return None
    whole = np.frombuffer(data.ljust(stride * track.height_px, b"\0"), np.uint8)
    rows = whole[: stride * track.height_px].reshape(track.height_px, stride)
    rows = rows[:, : n_bytes * track.width_px]
    return rows[::-1] if track.is_bottom_up else rows


_DECODERS: Final[dict[str, _Decoder]] = {
    "mjpeg": _decode_jpeg,
    "png": _decode_png,
    **dict.fromkeys(_GREY_FIRST, _take_grey),
    **dict.fromkeys(_PACKED, _take_every_second),
    "BGR3": _mix_colours,
    "BGR4": _mix_colours,
    "PAL8": _look_up,
}
"""How the picture in a packet is made, by codec; None where it is damaged."""
CODECS: Final = frozenset((*_DECODERS, *FFMPEG_CODECS))
"""Codecs and raw formats that are decoded."""

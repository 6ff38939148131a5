"""Cuts a picture into payloads, each with a header of its own (UVC 1.1, 2.4.3)."""

import struct
from collections.abc import Iterator
from dataclasses import dataclass

from neurotouch_devtools.emulator.uvc.negotiation import CLOCK_HZ

_HEADER = struct.Struct("<BBIIH")
_PICTURE, _END, _HAS_TIME, _HAS_CLOCK, _ERROR, _END_OF_HEADER = 1, 2, 4, 8, 0x40, 0x80
_CLOCK_MASK, _FRAME_NUMBER_MASK = 0xFFFFFFFF, 0x7FF
_NS_PER_TICK = 1_000_000_000 // CLOCK_HZ


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture on its way to the host.

    Attributes:
        data: its bytes, in the format of the mode.
        number: pictures sent before it.
        exposed_ns: camera time when its exposure began.
        faulty: the camera says that it is.
    """

    data: bytes
    number: int
    exposed_ns: int
    faulty: bool = False


def cut(picture: Picture, payload_bytes: int, now_ns: int) -> Iterator[bytes]:
    """Yields the payloads of a picture, none longer than ``payload_bytes``; the last may be short.

    A payload that is shorter than a transfer ends it; one of exactly this size is told by its
    header, so no empty transfer follows.
    """
    room = payload_bytes - _HEADER.size
    flags = _END_OF_HEADER | _HAS_TIME | _HAS_CLOCK | picture.number & _PICTURE
    flags |= _ERROR if picture.faulty else 0
    exposed = picture.exposed_ns // _NS_PER_TICK & _CLOCK_MASK
    now = now_ns // _NS_PER_TICK & _CLOCK_MASK
    frame_number = now_ns // 1_000_000 & _FRAME_NUMBER_MASK
    for start in range(0, max(len(picture.data), 1), room):
        end = _END if start + room >= len(picture.data) else 0
        header = _HEADER.pack(_HEADER.size, flags | end, exposed, now, frame_number)
        yield header + picture.data[start : start + room]

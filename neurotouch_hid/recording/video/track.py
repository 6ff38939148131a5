"""Tracks of pictures and packets with stamps, as all three containers have them."""

import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.recording.container import DamageError

MAX_PACKET_BYTES: Final = 32 << 20
"""A raw picture of the largest size has 26 MB."""
MAX_PRIVATE_BYTES: Final = 1 << 16
"""Limit of what a container says to a decoder."""
MAX_TRACKS: Final = 64
MAX_COMMENT_BYTES: Final = 16_000


@dataclass(frozen=True, slots=True)
class Track:
    """A series of pictures in a container.

    Attributes:
        codec: ``mjpeg``, ``png``, ``h264``, ``mpeg4``, ``ffv1``, the four letters of a raw format,
            or the container's own name of any other codec.
        width_px: of its pictures, as the container says.
        height_px: likewise.
        tick_s: the unit of its stamps.
        private: what the decoder must know before the first packet.
        is_bottom_up: raw pictures begin with the bottom row.
        is_decode_order: the stamps tell when a packet is decoded, not when it is shown.
        first_tick: pictures before it are only decoded, as others may need them.
        end_tick: so are those from it on; None if the clip is not cut at its end.
    """

    codec: str
    width_px: int
    height_px: int
    tick_s: Fraction
    private: bytes = b""
    is_bottom_up: bool = False
    is_decode_order: bool = False
    first_tick: int | None = None
    end_tick: int | None = None

    def shows(self, time_s: Fraction) -> bool:
        """Returns whether a picture with this stamp belongs to the clip."""
        is_cut_off = self.end_tick is not None and time_s >= self.end_tick * self.tick_s
        return not is_cut_off and (
            self.first_tick is None or time_s >= self.first_tick * self.tick_s
        )


class Packet(NamedTuple):
    """The bytes of one picture, and its stamp in ticks of the track."""

    data: bytes
    ticks: int


class Shot(NamedTuple):
    """A picture, (h, w) uint8, its time in s from any origin, and its JPEG if it came as one."""

    pixels: NDArray[np.uint8]
    time_s: Fraction
    jpeg: bytes | None


@dataclass(frozen=True, slots=True)
class Video:
    """An open container.

    Attributes:
        tracks: its tracks of pictures.
        comment: its comment; empty without one.
        packets: gives the packets of its first track, in the order of decoding; raises
            ``DamageError`` where the file breaks off or makes no sense.
    """

    tracks: tuple[Track, ...]
    comment: str
    packets: Callable[[], Iterator[Packet]]


class ClipFile:
    """Reads at any place of an open file, never beyond its end.

    Args:
        descriptor: of a regular file; stays the caller's.
    """

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self.size = os.fstat(descriptor).st_size

    def read(self, at: int, n: int) -> bytes:
        """Returns exactly ``n`` bytes.

        Raises:
            DamageError: the file does not have them.
            OSError: the disk cannot be read.
        """
        if n < 0 or at < 0 or at + n > self.size:
            raise DamageError(min(at, self.size), "is cut off")
        data = os.pread(self._descriptor, n, at)
        if len(data) < n:  # a program has made the file shorter
            raise DamageError(at + len(data), "is cut off")
        return data

    def read_packet(self, at: int, n: int) -> bytes:
        """Returns a packet; raises also where it is larger than any picture."""
        if n > MAX_PACKET_BYTES:
            raise DamageError(at, "is damaged" if at + n <= self.size else "is cut off")
        return self.read(at, n)

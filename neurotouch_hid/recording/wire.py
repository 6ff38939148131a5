"""Sends packets through a socket to another process on the same machine."""

import socket
import struct
from collections.abc import Iterator
from typing import Final, Protocol

import numpy as np

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.messages import (
    EVENT_DTYPE,
    SENSOR_HEIGHT_PX,
    SENSOR_WIDTH_PX,
    EventPacket,
    Frame,
)

_PACKET: Final = struct.Struct("=4sqqqII")  # mark, begin and end in µs, gap, events, frames
_MARK: Final = b"NTp1"
_FRAME: Final = struct.Struct("=qq")  # exposure
_PIXELS: Final = SENSOR_WIDTH_PX * SENSOR_HEIGHT_PX
_MAX_EVENTS: Final = 1 << 24
_MAX_FRAMES: Final = 1 << 10


class Line(Protocol):
    """Takes the bytes of packets, as a socket does."""

    def sendall(self, data: bytes | memoryview, /) -> None:
        """Sends all of it."""
        ...


def send_packet(line: Line, packet: EventPacket) -> None:
    """Sends a packet whole.

    Raises:
        OSError: the other end is gone, or takes nothing.
    """
    counts = (len(packet.events), len(packet.frames))
    line.sendall(_PACKET.pack(_MARK, packet.t_begin_us, packet.t_end_us, packet.gap, *counts))
    line.sendall(np.ascontiguousarray(packet.events).view(np.uint8).data)  # no copy
    for frame in packet.frames:
        line.sendall(_FRAME.pack(frame.exposure_begin_us, frame.exposure_end_us))
        line.sendall(np.ascontiguousarray(frame.pixels).data)


def receive_packets(line: socket.socket) -> Iterator[EventPacket]:
    """Yields the packets that arrive, until the other end closes, also in the middle of one.

    Raises:
        RecordingError: the data is no packet.
    """
    while head := _read(line, _PACKET.size):
        mark, begin_us, end_us, gap, n_events, n_frames = _PACKET.unpack(head)
        if mark != _MARK or n_events > _MAX_EVENTS or n_frames > _MAX_FRAMES:
            raise RecordingError("The data from the driver cannot be read.")
        data = _read(line, n_events * EVENT_DTYPE.itemsize)
        if len(data) < n_events * EVENT_DTYPE.itemsize:
            return
        frames = []
        for _ in range(n_frames):
            picture = _read(line, _FRAME.size + _PIXELS)
            if not picture:
                return
            pixels = np.frombuffer(picture, np.uint8, _PIXELS, _FRAME.size)
            shaped = pixels.reshape(SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX)
            frames.append(Frame(shaped, *_FRAME.unpack_from(picture)))
        events = np.frombuffer(data, EVENT_DTYPE)
        yield EventPacket(begin_us, end_us, events, tuple(frames), gap)


def _read(line: socket.socket, n: int) -> bytes:
    """Returns this many bytes, or none if the other end closes first."""
    data = bytearray(n)
    filled = 0
    while filled < n:
        got = line.recv_into(memoryview(data)[filled:])
        if not got:
            return b""
        filled += got
    return bytes(data)

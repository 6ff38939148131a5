"""The bytes of an AEDAT4 file: header, packets of events or frames, and the table at its end.

Each of them is a FlatBuffer with its size in front, always of the same shape here, so what is in
front of the data is written down byte for byte; the layout is that of the maker's own writer
(``dv-processing`` 2.0), field for field and with the same alignment.
"""

import struct
from typing import Final

import lz4.frame
import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.messages import EVENT_DTYPE, SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX, Frame
from neurotouch_hid.recording.header import MAGIC
from neurotouch_hid.recording.sensor import DAVIS346, Sensor
from neurotouch_hid.recording.simulation import Simulation, format_simulation

EVENTS, FRAMES = 0, 1
"""The numbers of the two streams."""

_LZ4: Final = 1
_GREY_SENSOR: Final = 1

_PACKET_HEAD: Final = struct.Struct("<ii")  # stream, bytes that follow
_EVENTS_HEAD: Final = struct.Struct("<I I4s 2x3H iI I")
"""Size; root, name; vtable (its size, the table's, elements); table (vtable, elements); count."""

_FRAME_HEAD: Final = struct.Struct("<I I4s 6x15H i3xB2hI4q4x I")
"""Size; root, name; vtable of 13 fields; table: vtable, source, width, height, pixels, stamp,
exposure begin and end, exposure length; count."""
_FRAME_FIELDS: Final = (30, 52, 16, 0, 0, 24, 32, 0, 8, 10, 0, 0, 12, 40, 7)

_TABLE_HEAD: Final = struct.Struct("<I I4s 6x3H iI I")
_ENTRY_FIELDS: Final = struct.pack("<7H", 14, 44, 12, 4, 20, 28, 36)
_ENTRY: Final = np.dtype(
    {
        "names": ["vtable", "stream", "size", "offset", "n", "begin", "end"],
        "formats": ["<i4", "<i4", "<i4", "<i8", "<i8", "<i8", "<i8"],
        "offsets": [0, 4, 8, 12, 20, 28, 36],
        "itemsize": 48,
    }
)
_HEADER: Final = struct.Struct("<I I4s 6x5H iiIq I")
TABLE_POSITION_AT: Final = len(MAGIC) + 40
"""Where in the file the position of the table is; -1 until there is one."""


def pack_header(simulation: Simulation | None = None, sensor: Sensor = DAVIS346) -> bytes:
    """Returns the beginning of a file whose table is not written yet.

    Args:
        simulation: where simulated data come from; None for a sensor's data.
        sensor: what it is a recording of.
    """
    text = _describe(simulation, sensor).encode()
    padded = text + bytes(4 - len(text) % 4)  # one 0 at least
    fields = (10, 20, 4, 12, 8)  # vtable: its size, the table's, compression, position, text
    size = _HEADER.size - 4 + len(padded)
    head = _HEADER.pack(size, 24, b"IOHE", *fields, 10, _LZ4, 12, -1, len(text))
    return MAGIC + head + padded


def pack_events(events: NDArray[np.void]) -> bytes:
    """Returns a packet of (n,) EVENT_DTYPE, compressed, ready to be appended."""
    # The record is the format's own struct; its padding bytes are whatever was in memory.
    clean = np.zeros(len(events), EVENT_DTYPE)
    for name in ("t", "x", "y", "p"):
        clean[name] = events[name]
    size = _EVENTS_HEAD.size - 4 + clean.nbytes
    head = _EVENTS_HEAD.pack(size, 16, b"EVTS", 6, 8, 4, 6, 4, len(clean))
    return _frame_packet(EVENTS, head, clean.tobytes())


def pack_frame(frame: Frame) -> bytes:
    """Returns a packet of one frame, compressed, ready to be appended."""
    begin_us, end_us = frame.exposure_begin_us, frame.exposure_end_us
    pixels = np.ascontiguousarray(frame.pixels).tobytes()
    head = _FRAME_HEAD.pack(
        _FRAME_HEAD.size - 4 + len(pixels),
        *(44, b"FRME", *_FRAME_FIELDS),
        *(30, _GREY_SENSOR, SENSOR_WIDTH_PX, SENSOR_HEIGHT_PX, 40),
        *(begin_us, begin_us, end_us, end_us - begin_us),
        len(pixels),
    )
    return _frame_packet(FRAMES, head, pixels)


def pack_table(entries: NDArray[np.int64]) -> bytes:
    """Returns the table at the end of the file.

    Args:
        entries: (n, 6), a row for each packet: stream, size, position of its data, number of
            events or frames, first and last stamp in µs.
    """
    n = len(entries)
    vtable_at = _TABLE_HEAD.size - 4 + 4 * n
    first_at = -(-(vtable_at + len(_ENTRY_FIELDS)) // 8) * 8
    at = first_at + _ENTRY.itemsize * np.arange(n)
    rows = np.zeros(n, _ENTRY)
    rows["vtable"] = at - vtable_at
    for column, name in enumerate(("stream", "size", "offset", "n", "begin", "end")):
        rows[name] = entries[:, column]
    offsets = (at - (_TABLE_HEAD.size - 4 + 4 * np.arange(n))).astype("<u4").tobytes()
    gap = bytes(first_at - vtable_at - len(_ENTRY_FIELDS))
    body = offsets + _ENTRY_FIELDS + gap + rows.tobytes()
    size = _TABLE_HEAD.size - 4 + len(body)
    head = _TABLE_HEAD.pack(size, 20, b"FTAB", 6, 8, 4, 6, 4, n)
    return bytes(lz4.frame.compress(head + body))


def _frame_packet(stream: int, head: bytes, data: bytes) -> bytes:
    packed = lz4.frame.compress(head + data)
    return bytes(_PACKET_HEAD.pack(stream, len(packed)) + packed)


def _describe(simulation: Simulation | None, sensor: Sensor) -> str:
    """Returns the text in the header by which readers know the streams."""
    streams = ((EVENTS, "events", "EVTS"), (FRAMES, "frames", "FRME"))
    nodes = "".join(_describe_stream(*stream, simulation, sensor) for stream in streams)
    return f'<dv version="2.0"><node name="outInfo" path="/outInfo/">{nodes}</node></dv>\n'


def _describe_stream(
    number: int, name: str, identifier: str, simulation: Simulation | None, sensor: Sensor
) -> str:
    def say(kind: str, key: str, value: str | int) -> str:
        return f'<attr key="{key}" type="{kind}">{value}</attr>'

    path = f"/outInfo/{number}/"
    about = (
        say("string", "compression", "LZ4"),
        say("string", "originalModuleName", "neurotouch"),
        say("string", "originalOutputName", name),
        say("string", "typeDescription", "Events." if number == EVENTS else "Frames."),
        say("string", "typeIdentifier", identifier),
        f'<node name="info" path="{path}info/">',
        say("int", "sizeX", sensor.width_px),
        say("int", "sizeY", sensor.height_px),
        say("string", "source", sensor.name),
        "</node>",
        "" if simulation is None or number != EVENTS else format_simulation(simulation, path),
    )
    return f'<node name="{number}" path="{path}">{"".join(about)}</node>'

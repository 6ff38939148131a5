"""Events and frames out of the packets of an AEDAT4 file, which any writer may have made.

The counterpart of ``packing``. What is returned lies within what the types can hold; whether events
are in the picture and in order is checked where their neighbours are known.
"""

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.messages import EVENT_DTYPE, SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX, Frame
from neurotouch_hid.recording.flatbuffer import FlatTable

MAX_STAMP_US: Final = 1 << 62
"""Stamps beyond this are damage: differences of smaller ones fit 64 bits."""

_CHANNELS: Final = {0: 1, 16: 3, 24: 4}
"""Of the frame formats with 8 bits: grey, blue-green-red, and the same with transparency."""

_STAMP, _EXPOSURE_BEGIN, _EXPOSURE_END, _FORMAT, _WIDTH, _HEIGHT, _PIXELS = 0, 3, 4, 5, 6, 7, 10
"""The fields of a frame that are read, by their number."""


class UnfitError(ValueError):
    """A packet is sound, but not of a DAVIS-346; says in words what it has."""


def unpack_events(data: bytes | memoryview) -> NDArray[np.void]:
    """Returns the events of a packet, (n,) ``EVENT_DTYPE``, as a view of its bytes.

    Raises:
        ValueError: the packet is damaged.
    """
    begin, n = FlatTable(data, b"EVTS").vector(0, EVENT_DTYPE.itemsize)
    return np.frombuffer(data, EVENT_DTYPE, n, begin) if n else np.empty(0, EVENT_DTYPE)


def unpack_frame(data: bytes | memoryview) -> Frame:
    """Returns the frame of a packet; colours become grey.

    Raises:
        UnfitError: it is of another size or format, or its stamp is impossible.
        ValueError: the packet is damaged.
    """
    table = FlatTable(data, b"FRME")
    width, height = table.number(_WIDTH, "<h"), table.number(_HEIGHT, "<h")
    kind = table.number(_FORMAT, "<b")
    if (width, height) != (SENSOR_WIDTH_PX, SENSOR_HEIGHT_PX) or kind not in _CHANNELS:
        what = "" if kind in _CHANNELS else f" of format {kind}"
        raise UnfitError(f"a frame of {width}×{height} pixels{what}, not 346×260 of 8 bit")
    begin, n = table.vector(_PIXELS, 1)
    shape = (height, width, _CHANNELS[kind])
    if n != math.prod(shape):
        raise ValueError("a frame has fewer or more pixels than its size says")
    pixels = np.frombuffer(data, np.uint8, n, begin).reshape(shape)
    # Of a colour camera: the gel is black and white.
    grey = pixels[..., :3].mean(axis=2).astype(np.uint8) if kind else pixels[..., 0].copy()
    begin_us, end_us = (table.number(field, "<q") for field in (_EXPOSURE_BEGIN, _EXPOSURE_END))
    if begin_us == 0 and end_us == 0:
        begin_us = end_us = table.number(_STAMP, "<q")
    if max(abs(begin_us), abs(end_us)) > MAX_STAMP_US:
        raise UnfitError(f"a frame with an impossible stamp ({begin_us} µs)")
    return Frame(grey, begin_us, max(begin_us, end_us))

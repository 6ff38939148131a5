"""Shows one sensor a scene that was made for a DAVIS-346: its part of it, through its filter."""

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX, EventPacket, Frame

FILTERS: Final = (
    *("", "RGBG", "GRGB", "GBGR", "BGRG"),
    *("RGBW", "GRWB", "WBGR", "BWRG"),
)
"""Colour filters by the value of their register: clockwise from the top left pixel, as libcaer's
``frame.h`` names them."""
SHARES: Final = {"R": 0.7, "G": 1.0, "B": 0.6, "W": 1.0}
"""Share of the light that passes; that of a real filter depends on the lamp."""


def see(
    packets: Iterable[EventPacket | None],
    size: tuple[int, int],
    colour: int = 0,
    shares: dict[str, float] | None = None,
) -> Iterator[EventPacket | None]:
    """Gives a scene as a sensor sees it: the middle of the picture, through its filter.

    Events stay as they are behind a filter: they follow ratios of light.

    Args:
        packets: the scene; None means "not yet".
        size: of the sensor, width and height, px.
        colour: the value of its register.
        shares: share of the light that passes each filter; those above without.
    """
    left, top = (SENSOR_WIDTH_PX - size[0]) // 2, (SENSOR_HEIGHT_PX - size[1]) // 2
    light = make_filter(size, colour, shares or SHARES)
    is_whole = (left, top) == (0, 0)
    for packet in packets:
        if packet is None or (is_whole and light is None):
            yield packet
            continue
        events = packet.events if is_whole else _cut(packet.events, left, top, size)
        frames = tuple(_show(frame, left, top, size, light) for frame in packet.frames)
        yield replace(packet, events=events, frames=frames)


def make_filter(
    size: tuple[int, int], colour: int, shares: dict[str, float]
) -> NDArray[np.float64] | None:
    """Returns the share of light that reaches each pixel, (height, width); None without filter."""
    if not colour:
        return None
    top_left, top_right, bottom_right, bottom_left = (shares[name] for name in FILTERS[colour])
    tile = np.array([[top_left, top_right], [bottom_left, bottom_right]])
    return np.tile(tile, (size[1] // 2 + 1, size[0] // 2 + 1))[: size[1], : size[0]]


def _cut(events: NDArray[np.void], left: int, top: int, size: tuple[int, int]) -> NDArray[np.void]:
    events = events.copy()
    events["x"] -= left
    events["y"] -= top
    x, y = events["x"], events["y"]
    return events[(x >= 0) & (x < size[0]) & (y >= 0) & (y < size[1])]


def _show(
    frame: Frame, left: int, top: int, size: tuple[int, int], light: NDArray[np.float64] | None
) -> Frame:
    pixels = frame.pixels[top : top + size[1], left : left + size[0]]
    if light is not None:
        pixels = np.rint(pixels * light).astype(np.uint8)
    return replace(frame, pixels=pixels)

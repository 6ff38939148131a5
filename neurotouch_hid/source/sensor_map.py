"""Brings the events and frames of a sensor of any size to the canonical picture."""

from collections.abc import Iterable
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.events import copy_events
from neurotouch_hid.messages import EVENT_DTYPE, SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX, Frame
from neurotouch_hid.source.kernels import view as kernels
from neurotouch_hid.source.view import View, ViewTable

_BLOCK: Final = 1 << 16
"""Events that are mapped at once: what they become stays in the processor's cache."""


class SensorMap:
    """Events by a table of places, frames by a table of weights.

    Where a canonical pixel stands for several of the sensor, it makes as many events of an edge as
    one of them does: later stages know no other rates.

    Args:
        view: the map from the sensor's picture.
        begin_us: no event is older.
        keeps_size: events and frames stay in the sensor's picture, as a recording needs them.

    Attributes:
        view: the same.
        last_us: time of the last event.
        n_back: events so far whose time was before that of the one before; they have its time.
    """

    def __init__(self, view: View, begin_us: int = 0, *, keeps_size: bool = False) -> None:
        self.view = view
        self.last_us, self.n_back = begin_us, 0
        self._keeps_size = keeps_size
        self._columns, self._rows = _keep_places(view) if keeps_size else find_places(view)
        shape = (SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX)
        if keeps_size:
            shape = (view.height_px, view.width_px)
        self._sums = np.zeros((*shape, 2), np.int16)
        self._sums[..., 1] = _count_pixels(self._columns, self._rows, shape)
        self._out = np.empty(_BLOCK, EVENT_DTYPE)
        self._table: ViewTable | None = None

    def map_events(self, events: NDArray[np.void], shift_us: int = 0) -> list[NDArray[np.void]]:
        """Returns the events that the canonical picture shows, as arrays in order of time.

        Args:
            events: (n,) records with ``t``, ``x``, ``y`` and ``p``, in pixels of the sensor.
            shift_us: is added to their times.
        """
        parts = []
        for begin in range(0, len(events), _BLOCK):
            n, self.last_us, n_back = kernels.map_events(
                events[begin : begin + _BLOCK],
                shift_us,
                self.last_us,
                self._columns,
                self._rows,
                self._sums,
                self._out,
            )
            self.n_back += n_back
            if n:
                parts.append(copy_events(self._out[:n]))
        return parts

    def map_frames(self, frames: Iterable[Frame]) -> list[Frame]:
        """Returns canonical frames of frames in the sensor's size."""
        if self._keeps_size:
            return list(frames)
        mapped = []
        for frame in frames:
            self._table = self._table or ViewTable(self.view)
            pixels = np.empty((SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX), np.uint8)
            self._table.draw(frame.pixels, pixels)
            mapped.append(replace(frame, pixels=pixels))
        return mapped


def find_places(view: View) -> tuple[NDArray[np.int16], NDArray[np.int16]]:
    """Returns the canonical pixel of each pixel of a sensor, as ``kernels.map_events`` takes it.

    Returns:
        Columns, (height, width) or (1, width), and rows, (height, width) or (height, 1), int16.
    """
    x, y = np.arange(float(view.width_px)), np.arange(float(view.height_px))
    if view.is_straight:  # a row and a column say it all
        row = view.to_canonical(np.stack([x, np.zeros_like(x)], axis=1))
        column = view.to_canonical(np.stack([np.zeros_like(y), y], axis=1))
        across, down = row[None, :, 0], column[:, 1:]
    else:
        points = view.to_canonical(np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2))
        across, down = points.T.reshape(2, view.height_px, view.width_px)
    return _round_to(across, SENSOR_WIDTH_PX), _round_to(down, SENSOR_HEIGHT_PX)


def _round_to(at: NDArray[np.float64], size: int) -> NDArray[np.int16]:
    """Returns the nearest of ``size`` pixels, or ``NOWHERE``, of each place."""
    nearest = np.floor(at + 0.5)
    is_shown = (nearest >= 0) & (nearest < size)
    return np.where(is_shown, nearest, kernels.NOWHERE).astype(np.int16)


def _keep_places(view: View) -> tuple[NDArray[np.int16], NDArray[np.int16]]:
    """Returns columns and rows of pixels that stay where they are."""
    columns = np.arange(view.width_px, dtype=np.int16)
    return columns[None], np.arange(view.height_px, dtype=np.int16)[:, None]


def _count_pixels(
    columns: NDArray[np.int16], rows: NDArray[np.int16], shape: tuple[int, int]
) -> NDArray[np.int64]:
    """Returns how many pixels of the sensor each pixel of a picture stands for, ``shape``."""
    height, width = shape
    flat = (rows.astype(np.int64) * width + columns)[(columns >= 0) & (rows >= 0)]
    return np.bincount(flat, minlength=width * height).reshape(height, width)


def make_middle_map(width_px: int, height_px: int, begin_us: int) -> SensorMap | None:
    """Returns the map of a sensor that sees the gel in the same scale; None if none is needed.

    The pixels of a DAVIS240 are as large as those of a DAVIS346: behind the same lens, its picture
    is the middle of the canonical one.

    Args:
        width_px: width of the sensor's picture.
        height_px: height of it.
        begin_us: no event is older.
    """
    if (width_px, height_px) == (SENSOR_WIDTH_PX, SENSOR_HEIGHT_PX):
        return None
    middle = ((width_px - 1) / 2.0, (height_px - 1) / 2.0)
    return SensorMap(View(width_px, height_px, middle, 1.0), begin_us)

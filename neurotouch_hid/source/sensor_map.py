"""Brings the events and frames of a sensor of any size to the canonical picture."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.messages import EVENT_DTYPE, SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX, Frame
from neurotouch_hid.source.kernels import view as kernels
from neurotouch_hid.source.view import View, ViewTable


class SensorMap:
    """Events by a table of places, frames by a table of weights.

    Args:
        view: the map from the sensor's picture.

    Attributes:
        view: the same.
    """

    def __init__(self, view: View) -> None:
        self.view = view
        self._places = find_places(view)
        self._table: ViewTable | None = None

    def map_events(self, events: NDArray[np.void]) -> NDArray[np.void]:
        """Returns the events that the canonical picture shows, (m,) EVENT_DTYPE.

        Args:
            events: (n,) EVENT_DTYPE, in pixels of the sensor.
        """
        out = np.empty(len(events), EVENT_DTYPE)
        return out[: kernels.map_events(events, self._places, out)]

    def map_frames(self, frames: Iterable[Frame]) -> list[Frame]:
        """Returns canonical frames of frames in the sensor's size."""
        mapped = []
        for frame in frames:
            self._table = self._table or ViewTable(self.view)
            pixels = np.empty((SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX), np.uint8)
            self._table.draw(frame.pixels, pixels)
            mapped.append(replace(frame, pixels=pixels))
        return mapped


def find_places(view: View) -> NDArray[np.int32]:
    """Returns the canonical pixel of each pixel of a sensor, as ``kernels.map_events`` takes it.

    Returns:
        (height, width) int32.
    """
    x, y = np.meshgrid(np.arange(view.width_px), np.arange(view.height_px))
    points = view.to_canonical(np.stack([x.ravel(), y.ravel()], axis=1))
    columns, rows = np.floor(points + 0.5).astype(np.int64).T
    is_shown = (columns >= 0) & (columns < SENSOR_WIDTH_PX)
    is_shown &= (rows >= 0) & (rows < SENSOR_HEIGHT_PX)
    places = np.where(is_shown, columns | rows << 16, kernels.NOWHERE)
    return places.reshape(view.height_px, view.width_px).astype(np.int32)


def make_middle_map(width_px: int, height_px: int) -> SensorMap | None:
    """Returns the map of a sensor that sees the gel in the same scale; None if none is needed.

    The pixels of a DAVIS240 are as large as those of a DAVIS346: behind the same lens, its picture
    is the middle of the canonical one.
    """
    if (width_px, height_px) == (SENSOR_WIDTH_PX, SENSOR_HEIGHT_PX):
        return None
    middle = ((width_px - 1) / 2.0, (height_px - 1) / 2.0)
    return SensorMap(View(width_px, height_px, middle, 1.0))

"""Name and size of the sensor that a recording is of."""

from typing import Final, NamedTuple

from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX


class Sensor(NamedTuple):
    """A sensor.

    Attributes:
        name: its camera.
        width_px: width of its picture.
        height_px: height of it.
    """

    name: str
    width_px: int
    height_px: int

    @property
    def size_px(self) -> tuple[int, int]:
        """Width and height of its picture."""
        return self.width_px, self.height_px


DAVIS346: Final = Sensor("DAVIS346", SENSOR_WIDTH_PX, SENSOR_HEIGHT_PX)
LARGEST_PX: Final = 8192
"""Largest width and height of a sensor whose recording is read."""

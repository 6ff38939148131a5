"""The sensors behind the one product id of the DAVIS: size, biases, samples."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX
from neurotouch_hid.source.davis.registers import (
    CHIP_SETTINGS,
    CURRENTS,
    CURRENTS_240,
    FIXED_CHIP,
    FIXED_CHIP_240,
    FIXED_CURRENTS,
    FIXED_CURRENTS_240,
    CoarseFine,
    Current,
    Register,
)

UPDATE_PAGE: Final = "https://inivation.gitlab.io/dv/dv-docs/docs/update-firmware/"
"""The maker's page about other versions, as libcaer names it."""


@dataclass(frozen=True, slots=True, eq=False)
class Chip:
    """A sensor that this driver knows.

    Attributes:
        name: the maker's name.
        width_px, height_px: size of its picture.
        currents: its biases that are currents, by the maker's names.
        fixed_currents: those that are never tuned to the light.
        fixed: voltages and settings, by their registers.
        sample_shift: its samples are shifted left by so many bits, as its ADC uses only a half of
            its range [libcaer ``davis_common.h``].
    """

    name: str
    width_px: int
    height_px: int
    currents: Mapping[str, Current]
    fixed_currents: Mapping[str, CoarseFine]
    fixed: Mapping[Register, int]
    sample_shift: int = 0


def _describe_346(name: str) -> Chip:
    fixed = CHIP_SETTINGS | FIXED_CHIP
    return Chip(name, SENSOR_WIDTH_PX, SENSOR_HEIGHT_PX, CURRENTS, FIXED_CURRENTS, fixed)


def _describe_240(name: str) -> Chip:
    fixed = CHIP_SETTINGS | FIXED_CHIP_240
    return Chip(name, 240, 180, CURRENTS_240, FIXED_CURRENTS_240, fixed, sample_shift=1)


NAMES: Final = {
    0: "DAVIS240A",
    1: "DAVIS240B",
    2: "DAVIS240C",
    3: "DAVIS128",
    4: "DAVIS346A",
    5: "DAVIS346B",
    6: "DAVIS640",
    7: "DAVIS640H",
    8: "DAVIS208",
    9: "DAVIS346C",
}
"""Names of all sensors by their numbers [libcaer ``davis.h``]."""

KNOWN: Final = {
    0: _describe_240(NAMES[0]),
    1: _describe_240(NAMES[1]),
    2: _describe_240(NAMES[2]),
    4: _describe_346(NAMES[4]),
    5: _describe_346(NAMES[5]),
    9: _describe_346(NAMES[9]),
}
"""The sensors that this driver plays, by their numbers."""

FILTERS: Final = {
    0: "monochrome",
    1: "colour, filter RGBG",
    2: "colour, filter GRGB",
    3: "colour, filter GBGR",
    4: "colour, filter BGRG",
    5: "colour, filter RGBW",
    6: "colour, filter GRWB",
    7: "colour, filter WBGR",
    8: "colour, filter BWRG",
}
"""Colour filters by their numbers, clockwise from the top left pixel [libcaer ``frame.h``]."""

"""Directions of a push and zones of the gel, kept until they are clearly left."""

import math
from collections.abc import Mapping
from typing import Final

from neurotouch_hid.profile.schema.conditions import Zone
from neurotouch_hid.profile.schema.targets import EightWay

Vector = tuple[float, float]

_HALF: Final = math.sqrt(0.5)
FOUR_WAYS: Final[Mapping[EightWay, Vector]] = {
    "left": (-1.0, 0.0),
    "right": (1.0, 0.0),
    "up": (0.0, -1.0),
    "down": (0.0, 1.0),
}
"""The middle of each sector of 90°, in gel coordinates: x right, y down, towards the user."""

EIGHT_WAYS: Final[Mapping[EightWay, Vector]] = {
    **FOUR_WAYS,
    "up_left": (-_HALF, -_HALF),
    "up_right": (_HALF, -_HALF),
    "down_left": (-_HALF, _HALF),
    "down_right": (_HALF, _HALF),
}
"""The middle of each sector of 45°."""

_KEEP_COS: Final = {4: math.cos(math.radians(45.0 + 15.0)), 8: math.cos(math.radians(22.5 + 10.0))}
"""A push keeps its sector until it has left it by 15° (of 90) or 10° (of 45). A tremor of 2 mm at
4 Hz across a push of 5 mm, of which the medium filter leaves half, sways it by 11°."""

CENTRE_MM: Final = 9.0
SIDE_MM: Final = 13.0
"""A zone for the centre and four around it: five are the most an error of 3.4 mm of a contact
point [NT, "Results"] allows, with 4 mm between them."""

_GUARD_MM: Final = 2.0
"""Half of the band between two side zones."""


def choose_direction(way: Vector | None, before: EightWay | None, sectors: int) -> EightWay | None:
    """Returns the sector of a push: the one before as long as it nearly fits, else the nearest."""
    if way is None:
        return None
    ways = FOUR_WAYS if sectors == 4 else EIGHT_WAYS
    if before is not None:
        x, y = ways[before]
        if x * way[0] + y * way[1] >= _KEEP_COS[sectors]:
            return before
    return max(ways, key=lambda name: ways[name][0] * way[0] + ways[name][1] * way[1])


def find_zone(x_mm: float, y_mm: float) -> Zone | None:
    """Returns the zone of a point of the gel; None in the bands between them."""
    radius_mm = math.hypot(x_mm, y_mm)
    if radius_mm <= CENTRE_MM:
        return "centre"
    if radius_mm < SIDE_MM:
        return None
    if abs(abs(x_mm) - abs(y_mm)) < _GUARD_MM / _HALF:
        return None
    if abs(x_mm) > abs(y_mm):
        return "left" if x_mm < 0.0 else "right"
    return "up" if y_mm < 0.0 else "down"

"""The eight movements that are measured one by one."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

from neurotouch_hid.profile.engine.reading import Reading
from neurotouch_hid.vocabulary import GestureKind


@dataclass(frozen=True, slots=True)
class Movement:
    """One of the eight.

    Attributes:
        name: its key in the user's file.
        words: what people call it.
        request: what one is asked to do, as far as is comfortable.
        partner: the movement the other way; the two are compared.
    """

    name: str
    words: str
    request: str
    partner: str


MOVEMENTS: Final[Mapping[str, Movement]] = MappingProxyType(
    {
        movement.name: movement
        for movement in (
            Movement("push_left", "push left", "Push to the left", "push_right"),
            Movement("push_right", "push right", "Push to the right", "push_left"),
            Movement("push_up", "push up", "Push up, away from you", "push_down"),
            Movement("push_down", "push down", "Push down, towards you", "push_up"),
            Movement("pinch", "pinch", "Bring your fingers together", "zoom"),
            Movement("zoom", "zoom", "Spread your fingers", "pinch"),
            Movement("twist_cw", "twist clockwise", "Turn your hand clockwise", "twist_ccw"),
            Movement(
                "twist_ccw",
                "twist counter-clockwise",
                "Turn your hand counter-clockwise",
                "twist_cw",
            ),
        )
    }
)


def name_movement(reading: Reading) -> str | None:
    """The movement a reading belongs to; None at rest."""
    if reading.kind == GestureKind.NONE:
        return None
    if reading.kind == GestureKind.PUSH:
        return f"push_{reading.four}" if reading.four is not None else None
    return reading.kind.label

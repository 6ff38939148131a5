"""The eight movements that people make, can or cannot: measured, left out, compared."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, Literal

from neurotouch_hid.vocabulary import GestureKind

MovementName = Literal[
    "push_left",
    "push_right",
    "push_up",
    "push_down",
    "pinch",
    "zoom",
    "twist_cw",
    "twist_ccw",
]


@dataclass(frozen=True, slots=True)
class Movement:
    """One of the eight.

    Attributes:
        name: its key in the user's file.
        words: what people call it.
        request: what one is asked to do, as far as is comfortable.
        partner: the movement the other way; the two are compared.
    """

    name: MovementName
    words: str
    request: str
    partner: MovementName


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


def name_movement(kind: GestureKind, four: str | None) -> str | None:
    """Returns the movement a gesture is; None at rest, or of a push that goes nowhere.

    Args:
        kind: the gesture.
        four: of a push, its direction of four.
    """
    if kind == GestureKind.NONE:
        return None
    if kind == GestureKind.PUSH:
        return f"push_{four}" if four is not None else None
    return kind.label

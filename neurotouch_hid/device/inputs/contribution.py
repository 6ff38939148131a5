"""What each of several hands does with one pad, and what they do together."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final, Literal

from neurotouch_hid.messages import Axis, Button

Priority = Literal["equal", "gel", "helper"]

_GROUPS: Final = (
    # What is moved as one: nobody gets the x of one hand and the y of the other.
    (Axis.LEFT_X, Axis.LEFT_Y),
    (Axis.RIGHT_X, Axis.RIGHT_Y),
    (Axis.DPAD_X, Axis.DPAD_Y),
    (Axis.LEFT_TRIGGER,),
    (Axis.RIGHT_TRIGGER,),
)

_MOVES: Final = 0.1
"""From where on a person moves a stick who has priority: worn sticks rest a few per cent off their
centre, and would take it from the other for ever."""


@dataclass(frozen=True, slots=True)
class Contribution:
    """What one of several hands does with the pad.

    Attributes:
        buttons: the buttons it holds.
        axes: the axes it moves; an axis that is not named is at rest.
    """

    buttons: frozenset[Button] = frozenset()
    axes: Mapping[Axis, float] = field(default_factory=dict)


def merge(gel: Contribution, helper: Contribution, priority: Priority = "equal") -> Contribution:
    """Returns what both hands do together.

    Buttons are down if either holds them. A stick, and the D-pad, is where the one that moves it
    further has it; a trigger as far as the one that pulls it further. The one with priority decides
    alone about what he moves.

    Args:
        gel: what the gel does.
        helper: what the physical device does.
        priority: ``equal``, ``gel`` or ``helper``.
    """
    first, second = gel.axes, helper.axes
    axes: dict[Axis, float] = {}
    for group in _GROUPS:
        reach_gel, reach_helper = (
            math.hypot(*(values.get(axis, 0.0) for axis in group)) for values in (first, second)
        )
        if priority == "helper" and reach_helper > _MOVES:
            chosen = second
        elif (priority == "gel" and reach_gel > _MOVES) or reach_gel >= reach_helper:
            chosen = first
        else:
            chosen = second
        axes.update((axis, chosen[axis]) for axis in group if chosen.get(axis))
    return Contribution(gel.buttons | helper.buttons, axes)

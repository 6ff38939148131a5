"""Contributions of the gel and of a helper to one pad, and their merging."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final, Literal

from neurotouch_hid.messages import Axis, Button

Priority = Literal["equal", "gel", "helper"]

_GROUPS: Final = (
    # Axes that belong together: the x and the y of a stick come from the same hand.
    (Axis.LEFT_X, Axis.LEFT_Y),
    (Axis.RIGHT_X, Axis.RIGHT_Y),
    (Axis.DPAD_X, Axis.DPAD_Y),
    (Axis.LEFT_TRIGGER,),
    (Axis.RIGHT_TRIGGER,),
)

_MOVES: Final = 0.1
"""Deflection above which the side with priority takes a stick: worn sticks rest a few per cent off
their centre, and would otherwise take it for ever."""


@dataclass(frozen=True, slots=True)
class Contribution:
    """Buttons and axes of one of the hands on a pad.

    Attributes:
        buttons: the buttons that are down.
        axes: the axes it moves; an axis that is not named is at rest.
    """

    buttons: frozenset[Button] = frozenset()
    axes: Mapping[Axis, float] = field(default_factory=dict)


def merge(gel: Contribution, helper: Contribution, priority: Priority = "equal") -> Contribution:
    """Returns the merged contribution of both hands.

    A button is down if either hand presses it. A stick, the D-pad and a trigger follow the hand
    that moves it further. A hand with priority decides alone about the controls it moves.

    Args:
        gel: contribution of the gel.
        helper: contribution of the physical device.
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

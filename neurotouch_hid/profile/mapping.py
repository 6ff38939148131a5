"""From gestures to the pad: a pure function of the gesture stream.

The only memory is what hysteresis needs: which bindings are held, and which way a push goes. Host
time never enters, so the same gestures give the same pad, whatever the speed.
"""

import math
from collections.abc import Callable, Iterable
from typing import Final, assert_never

from neurotouch_hid.messages import Axis, Button, GamepadState, Gesture, GestureKind
from neurotouch_hid.profile.curves import make_response
from neurotouch_hid.profile.schema import Binding, Profile
from neurotouch_hid.profile.targets import (
    AxisTarget,
    ButtonTarget,
    Direction,
    DpadTarget,
    StickTarget,
    TriggerTarget,
)

Vector = tuple[float, float]
Drive = Callable[[float, Vector | None], Iterable[tuple[Axis, float]]]

DIRECTIONS: Final[dict[Direction, Vector]] = {
    "left": (-1.0, 0.0),
    "right": (1.0, 0.0),
    "up": (0.0, -1.0),
    "down": (0.0, 1.0),
}
"""The middle of each sector of 90°, in gel coordinates: x right, y down, towards the user."""

KEEP_COS: Final = math.cos(math.radians(45.0 + 10.0))
"""A push keeps its sector until it has left it by 10°, so that a diagonal does not flicker."""

_DPAD_AXES: Final = (Axis.DPAD_X, Axis.DPAD_Y)
_STICK_AXES: Final = {
    "left": (Axis.LEFT_X, Axis.LEFT_Y),
    "right": (Axis.RIGHT_X, Axis.RIGHT_Y),
}
_TRIGGER_AXES: Final = {"left": Axis.LEFT_TRIGGER, "right": Axis.RIGHT_TRIGGER}


class Mapping:
    """Carries out a profile.

    Every gesture gives the whole pad. Where two bindings move one axis, the larger magnitude wins;
    where they are equal, the binding that stands earlier in the profile. A button is down as long
    as one of its bindings holds it. No gesture, or a measurement that is not a number, is exactly
    neutral.
    """

    def __init__(self, profile: Profile) -> None:
        self._rules = tuple(_Rule(binding) for binding in profile.bindings)
        self._direction: Direction | None = None

    def update(self, gesture: Gesture) -> GamepadState:
        """The pad for this gesture, given what was held before it."""
        way = _find_way(gesture)
        self._direction = _choose_direction(way, self._direction)
        present = gesture.kind != GestureKind.NONE and math.isfinite(gesture.intensity_mm)
        buttons = set()
        axes: dict[Axis, float] = {}
        for rule in self._rules:
            rule.held = present and rule.holds(gesture, self._direction)
            if not rule.held:
                continue
            if rule.button is not None:
                buttons.add(rule.button)
            for axis, value in rule.drive(gesture.intensity_mm, way):
                if abs(value) > abs(axes.get(axis, 0.0)):
                    axes[axis] = value
        return GamepadState(gesture.t_us, frozenset(buttons), axes)


class _Rule:
    """A binding made ready for use, and whether it is held."""

    __slots__ = ("button", "contacts", "direction", "drive", "held", "kind", "off_mm", "on_mm")

    def __init__(self, binding: Binding) -> None:
        condition = binding.condition
        self.kind = condition.kind
        self.direction = condition.direction
        self.contacts = condition.contacts
        self.on_mm, self.off_mm = binding.thresholds_mm
        self.button: Button | None = None
        if isinstance(binding.do, ButtonTarget):
            self.button = Button(binding.do.button)
        self.drive = _make_drive(binding)
        self.held = False

    def holds(self, gesture: Gesture, direction: Direction | None) -> bool:
        """True if the binding acts on this gesture: pressed anew, or not yet let go."""
        return (
            gesture.kind == self.kind
            and gesture.intensity_mm >= (self.off_mm if self.held else self.on_mm)
            and (self.direction is None or self.direction == direction)
            and (self.contacts is None or self.contacts == len(gesture.contacts_mm))
        )


def _find_way(gesture: Gesture) -> Vector | None:
    """The direction of a push as a unit vector; None for anything else or if it has none."""
    x, y = gesture.translation_mm
    length = math.hypot(x, y)
    if gesture.kind != GestureKind.PUSH or not math.isfinite(length) or length == 0.0:
        return None
    return x / length, y / length


def _choose_direction(way: Vector | None, before: Direction | None) -> Direction | None:
    """The sector of a push: the one before as long as it nearly fits, else the nearest."""
    if way is None:
        return None

    def closeness(direction: Direction) -> float:
        x, y = DIRECTIONS[direction]
        return x * way[0] + y * way[1]

    if before is not None and closeness(before) >= KEEP_COS:
        return before
    return max(DIRECTIONS, key=closeness)


def _make_drive(binding: Binding) -> Drive:
    """What the binding does to the axes, given the intensity and the way of the push."""
    target = binding.do
    match target:
        case ButtonTarget():
            return lambda _intensity_mm, _way: ()
        case DpadTarget():
            presses = tuple(zip(_DPAD_AXES, DIRECTIONS[target.dpad], strict=True))
            return lambda _intensity_mm, _way: presses
        case StickTarget():
            return _make_stick_drive(binding, target)
        case AxisTarget():
            axis = Axis(target.axis)
            sign = 1.0 if target.sign == "+" else -1.0
        case TriggerTarget():
            axis = _TRIGGER_AXES[target.trigger]
            sign = 1.0
        case _:
            assert_never(target)
    respond = make_response(binding.range_mm, target.deadzone, target.curve)
    return lambda intensity_mm, _way: ((axis, sign * respond(intensity_mm)),)


def _make_stick_drive(binding: Binding, target: StickTarget) -> Drive:
    x_axis, y_axis = _STICK_AXES[target.stick]
    x_sign = -1.0 if target.invert_x else 1.0
    y_sign = -1.0 if target.invert_y else 1.0
    respond = make_response(binding.range_mm, target.deadzone, target.curve)

    def drive(intensity_mm: float, way: Vector | None) -> Iterable[tuple[Axis, float]]:
        if way is None:
            return ()
        reach = respond(intensity_mm)
        return (x_axis, x_sign * reach * way[0]), (y_axis, y_sign * reach * way[1])

    return drive

"""Turns a binding's target into outputs: buttons that are down, and axes that move."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Final

from neurotouch_hid.messages import Axis, Button, GestureKind
from neurotouch_hid.profile.engine.conditioned_gesture import ConditionedGesture
from neurotouch_hid.profile.engine.regions import EIGHT_WAYS
from neurotouch_hid.profile.engine.response import Response, make_response
from neurotouch_hid.profile.schema.conditions import KINDS
from neurotouch_hid.profile.schema.keyboard_keys import MOUSE_BUTTONS
from neurotouch_hid.profile.schema.profile import Binding
from neurotouch_hid.profile.schema.shaping import Planar, Shaped
from neurotouch_hid.profile.schema.targets import (
    AxisTarget,
    ButtonTarget,
    DpadTarget,
    KeyTarget,
    MouseButtonTarget,
    MouseMotionTarget,
    MouseWheelTarget,
    StickTarget,
    Target,
    TriggerTarget,
)

STICK_AXES: Final = {
    "left": (Axis.LEFT_X, Axis.LEFT_Y),
    "right": (Axis.RIGHT_X, Axis.RIGHT_Y),
}
TRIGGER_AXES: Final = {"left": Axis.LEFT_TRIGGER, "right": Axis.RIGHT_TRIGGER}
_BACKWARDS: Final = (GestureKind.PINCH, GestureKind.TWIST_CCW)
"""The negative sides of ``scale`` and ``twist``."""


@dataclass(slots=True)
class Outputs:
    """All outputs of one moment while the bindings add to them."""

    buttons: set[Button] = field(default_factory=set)
    axes: dict[Axis, float] = field(default_factory=dict)
    keys: set[str] = field(default_factory=set)
    mouse_buttons: set[str] = field(default_factory=set)
    pointer: tuple[float, float] = (0.0, 0.0)
    wheel: float = 0.0

    def move(self, axis: Axis, value: float) -> None:
        """Moves an axis; the larger magnitude counts, and the earlier of two equal ones."""
        if abs(value) > abs(self.axes.get(axis, 0.0)):
            self.axes[axis] = value


class Slew:
    """Limits how fast values grow or change sides; they shrink at once."""

    def __init__(self, per_s: float) -> None:
        self._per_us = per_s * 1e-6
        self._before: dict[Axis | str, tuple[int, float]] = {}

    def limit(self, name: Axis | str, value: float, t_us: int) -> float:
        """Returns the value that can be reached by now."""
        before_us, before = self._before.get(name, (t_us - 10_000, 0.0))
        if before * value < 0.0:
            before = 0.0
        if abs(value) > abs(before):
            most = self._per_us * min(max(t_us - before_us, 0), 50_000)
            value = before + min(max(value - before, -most), most)
        self._before[name] = (t_us, value)
        return value

    def rest(self) -> None:
        """Begins at 0 again."""
        self._before.clear()


Put = Callable[[Outputs, ConditionedGesture], None]


def make_output(binding: Binding) -> tuple[Put | None, Slew | None]:
    """Returns the binding's action on the outputs while it is down, and its slew limit, if any.

    None for a layer or a command, which are no outputs.
    """
    target = binding.do
    if not isinstance(target, Shaped) or not binding.is_followed:
        return _press(target), None
    slew = Slew(target.slew_per_s) if target.slew_per_s is not None else None
    if isinstance(target, StickTarget | MouseMotionTarget):
        return _follow_plane(binding, target, slew), slew
    return _follow_line(binding, target, slew), slew


def _press(target: Target) -> Put | None:
    """Returns the action of a target that is either down or not."""
    put: Put | None = None
    match target:
        case ButtonTarget():
            button = Button(target.button)
            put = lambda outputs, _: outputs.buttons.add(button)  # noqa: E731
        case DpadTarget():
            x, y = EIGHT_WAYS[target.dpad]
            put = _set_axes((Axis.DPAD_X, float(round(x))), (Axis.DPAD_Y, float(round(y))))
        case KeyTarget():
            keys = target.kernel_names
            put = lambda outputs, _: outputs.keys.update(keys)  # noqa: E731
        case MouseButtonTarget():
            name = MOUSE_BUTTONS[target.mouse]
            put = lambda outputs, _: outputs.mouse_buttons.add(name)  # noqa: E731
        case AxisTarget(value=float(value)):
            put = _set_axes((Axis(target.axis), value if target.sign == "+" else -value))
        case TriggerTarget(value=float(value)):
            put = _set_axes((TRIGGER_AXES[target.trigger], value))
    return put


def _set_axes(*values: tuple[Axis, float]) -> Put:
    def put(outputs: Outputs, _reading: ConditionedGesture) -> None:
        for axis, value in values:
            outputs.move(axis, value)

    return put


def _follow_plane(
    binding: Binding, target: StickTarget | MouseMotionTarget, slew: Slew | None
) -> Put:
    read = _read_plane(binding, target)
    x_sign = -1.0 if target.invert_x else 1.0
    y_sign = -1.0 if target.invert_y else 1.0

    def find(reading: ConditionedGesture) -> tuple[float, float]:
        x, y = read(reading)
        if slew is not None:
            x, y = slew.limit("x", x, reading.t_us), slew.limit("y", y, reading.t_us)
        return x_sign * x, y_sign * y

    if isinstance(target, StickTarget):
        x_axis, y_axis = STICK_AXES[target.stick]

        def put(outputs: Outputs, reading: ConditionedGesture) -> None:
            x, y = find(reading)
            outputs.move(x_axis, x)
            outputs.move(y_axis, y)

        return put
    speed_px_s = target.speed_px_s

    def put_pointer(outputs: Outputs, reading: ConditionedGesture) -> None:
        x, y = find(reading)
        outputs.pointer = (outputs.pointer[0] + speed_px_s * x, outputs.pointer[1] + speed_px_s * y)

    return put_pointer


def _read_plane(
    binding: Binding, target: Planar
) -> Callable[[ConditionedGesture], tuple[float, float]]:
    """Returns x and y of -1..1 of a reading, by the dead zone's shape."""
    responses = _make_responses(binding)
    centre_x, centre_y = target.centre_mm
    follows_push = target.follow == "push"
    round_ = target.deadzone_shape == "radial"

    def read(reading: ConditionedGesture) -> tuple[float, float]:
        if follows_push:
            if reading.way is None:
                return 0.0, 0.0
            x, y = reading.mm * reading.way[0], reading.mm * reading.way[1]
        elif reading.position_mm is not None:
            x, y = reading.position_mm
        else:
            return 0.0, 0.0
        x, y = x - centre_x, y - centre_y
        respond = responses[reading.kind]
        if not round_:
            return _signed(respond, x), _signed(respond, y)
        length = (x * x + y * y) ** 0.5
        if length == 0.0:
            return 0.0, 0.0
        reach = respond(length) / length
        return reach * x, reach * y

    return read


def _follow_line(
    binding: Binding, target: AxisTarget | TriggerTarget | MouseWheelTarget, slew: Slew | None
) -> Put:
    read = _read_line(binding, target)
    factor = -1.0 if target.invert else 1.0
    if isinstance(target, AxisTarget | MouseWheelTarget) and target.sign == "-":
        factor = -factor
    if isinstance(target, MouseWheelTarget):
        factor *= target.clicks_per_s

    def find(reading: ConditionedGesture) -> float:
        value = read(reading)
        return factor * (value if slew is None else slew.limit("x", value, reading.t_us))

    if isinstance(target, MouseWheelTarget):

        def put_wheel(outputs: Outputs, reading: ConditionedGesture) -> None:
            outputs.wheel += find(reading)

        return put_wheel
    if isinstance(target, TriggerTarget):
        trigger = TRIGGER_AXES[target.trigger]
        return lambda outputs, reading: outputs.move(trigger, max(0.0, find(reading)))
    axis = Axis(target.axis)
    return lambda outputs, reading: outputs.move(axis, find(reading))


def _read_line(
    binding: Binding, target: AxisTarget | TriggerTarget | MouseWheelTarget
) -> Callable[[ConditionedGesture], float]:
    """Returns -1..1 of a reading: the measure the target follows, shaped."""
    responses = _make_responses(binding)
    two_sided = binding.condition.gesture in ("twist", "scale")
    if isinstance(target, TriggerTarget):
        two_sided = False  # a trigger has one side: either way pulls it
    match target.follow:
        case "intensity":
            if not two_sided:
                return lambda reading: responses[reading.kind](reading.mm)
            return lambda reading: (
                (-1.0 if reading.kind in _BACKWARDS else 1.0) * responses[reading.kind](reading.mm)
            )
        case "speed":
            return lambda reading: responses[reading.kind](abs(reading.speed_mm_s))
        case "push_x" | "push_y":
            part = 0 if target.follow == "push_x" else 1
            return lambda reading: (
                0.0
                if reading.way is None
                else _signed(responses[reading.kind], reading.mm * reading.way[part])
            )
        case _:
            part = 0 if target.follow == "position_x" else 1
            return lambda reading: (
                0.0
                if reading.position_mm is None
                else _signed(responses[reading.kind], reading.position_mm[part])
            )


def _make_responses(binding: Binding) -> dict[GestureKind, Response]:
    return {
        kind: make_response(binding.range_for(kind), binding.do)  # type: ignore[arg-type]
        for kind in KINDS[binding.condition.gesture]
    }


def _signed(respond: Response, measure: float) -> float:
    return respond(measure) if measure >= 0.0 else -respond(-measure)

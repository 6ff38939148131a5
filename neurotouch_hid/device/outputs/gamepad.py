"""The controls of a pad: their codes and ranges, and from a state to their values.

SDL, Steam, Wine, browsers and RetroArch recognise a pad by its ids and map it by the *order* of its
codes, so a layout is data (``identities.toml``) and tests pin it.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from evdev import ecodes

from neurotouch_hid.device.outputs.spec import Control, make_key
from neurotouch_hid.messages import Axis, Button, GamepadState

PHYS = "neurotouch/pad0"
"""Physical path of the first player's pad; this program finds its own devices by it."""

_TO_BOTH_SIDES = {Axis.LEFT_X, Axis.LEFT_Y, Axis.RIGHT_X, Axis.RIGHT_Y, Axis.DPAD_X, Axis.DPAD_Y}


@dataclass(frozen=True)
class ControlLayout:
    """Maps each control of the pad to a control of the kernel.

    Attributes:
        buttons: the buttons, in the order of the report.
        trigger_buttons: buttons that are down as soon as a trigger is pulled; after the buttons.
        axes: the axes, last.
    """

    buttons: Mapping[Button, Control]
    trigger_buttons: Mapping[Axis, Control]
    axes: Mapping[Axis, Control]

    @classmethod
    def parse(cls, table: Mapping[str, Mapping[str, object]]) -> "ControlLayout":
        """Returns the layout that a table of ``identities.toml`` describes."""
        return cls(
            {Button(name): _make_key(code) for name, code in table["buttons"].items()},
            {
                Axis(name): _make_key(code)
                for name, code in table.get("trigger_buttons", {}).items()
            },
            {Axis(name): _make_axis(axis) for name, axis in table["axes"].items()},
        )

    @property
    def controls(self) -> tuple[Control, ...]:
        """The controls whose values a report contains, in this order."""
        return (*self.buttons.values(), *self.trigger_buttons.values(), *self.axes.values())

    def encode(self, state: GamepadState) -> tuple[int, ...]:
        """Returns the report of a state: the value of every control, in order."""
        report = self._rest.copy()
        for button in state.buttons:
            if button in self.buttons:
                report[self._button_places[button]] = 1
        for axis, value in state.axes.items():
            if value and axis in self.axes:
                control = self.axes[axis]
                level = _scale(value, control, signed=axis in _TO_BOTH_SIDES)
                report[self._axis_places[axis]] = level
                if axis in self.trigger_buttons:
                    report[self._trigger_places[axis]] = int(level != control.rest)
        return tuple(report)

    @cached_property
    def _rest(self) -> list[int]:
        return [control.rest for control in self.controls]

    @cached_property
    def _button_places(self) -> dict[Button, int]:
        return {button: place for place, button in enumerate(self.buttons)}

    @cached_property
    def _trigger_places(self) -> dict[Axis, int]:
        return {axis: place for place, axis in enumerate(self.trigger_buttons, len(self.buttons))}

    @cached_property
    def _axis_places(self) -> dict[Axis, int]:
        n_keys = len(self.buttons) + len(self.trigger_buttons)
        return {axis: place for place, axis in enumerate(self.axes, n_keys)}

    def decode(self, report: tuple[int, ...]) -> tuple[frozenset[Button], dict[Axis, float]]:
        """Returns the content of a report: the buttons that are down, and the axes off rest."""
        n_keys = len(self.buttons) + len(self.trigger_buttons)
        down = zip(self.buttons, report, strict=False)
        moved = zip(self.axes.items(), report[n_keys:], strict=True)
        return (
            frozenset(button for button, value in down if value),
            {
                # A wide axis has one value more on the left, which no pad of ours sends.
                axis: max((value - control.rest) / (control.maximum - control.rest), -1.0)
                for (axis, control), value in moved
                if value != control.rest
            },
        )


def _make_key(code: object) -> Control:
    return make_key(ecodes.ecodes[code])


def _make_axis(axis: object) -> Control:
    assert isinstance(axis, dict)  # noqa: S101  # our own file
    code = ecodes.ecodes[axis["code"]]
    return Control(ecodes.EV_ABS, code, axis["minimum"], axis["maximum"], axis.get("rest", 0))


def _scale(value: float, control: Control, *, signed: bool) -> int:
    """Scales -1..1 or 0..1 to the control's integers, alike on both sides; NaN is at rest.

    The kernel does not clamp, so a value out of range would reach the games.
    """
    if math.isnan(value):
        return control.rest
    lowest = -1.0 if signed else 0.0
    reach = control.maximum - control.rest
    return control.rest + round(min(max(value, lowest), 1.0) * reach)

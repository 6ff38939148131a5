"""Translates the codes of another pad, keyboard or switch into controls of our pad."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, TypeVar

from evdev import ecodes

from neurotouch_hid.device.inputs.contribution import Contribution
from neurotouch_hid.device.inputs.nodes import Input
from neurotouch_hid.device.outputs.identity import load_identities
from neurotouch_hid.messages import Axis, Button

Meaning = TypeVar("Meaning")

_BY_PLACE: Final = {0x054C, 0x057E}
"""Sony and Nintendo, whose drivers name buttons by their place, not by the label of an Xbox pad."""

_IN_ORDER: Final = tuple(Button)
"""Our buttons for the numbered buttons of joysticks and switch boxes, first to last."""

_DPAD_KEYS: Final = {
    "BTN_DPAD_UP": (Axis.DPAD_Y, -1.0),
    "BTN_DPAD_DOWN": (Axis.DPAD_Y, 1.0),
    "BTN_DPAD_LEFT": (Axis.DPAD_X, -1.0),
    "BTN_DPAD_RIGHT": (Axis.DPAD_X, 1.0),
    "KEY_UP": (Axis.DPAD_Y, -1.0),
    "KEY_DOWN": (Axis.DPAD_Y, 1.0),
    "KEY_LEFT": (Axis.DPAD_X, -1.0),
    "KEY_RIGHT": (Axis.DPAD_X, 1.0),
}
_KEYS: Final = {
    # Keyboards, switch interfaces (which mostly send space, enter or a mouse's buttons).
    "KEY_SPACE": Button.A,
    "KEY_ENTER": Button.A,
    "BTN_LEFT": Button.A,
    "KEY_BACKSPACE": Button.B,
    "KEY_ESC": Button.B,
    "BTN_RIGHT": Button.B,
    "KEY_X": Button.X,
    "KEY_Y": Button.Y,
    "KEY_Q": Button.LB,
    "KEY_E": Button.RB,
    "KEY_TAB": Button.BACK,
    "KEY_F1": Button.START,
}
_TRIGGER_KEYS: Final = {"BTN_TL2": Axis.LEFT_TRIGGER, "BTN_TR2": Axis.RIGHT_TRIGGER}


@dataclass(frozen=True, slots=True)
class AxisRange:
    """The integers of an axis.

    Attributes:
        axis: the axis of our pad.
        minimum: the smallest.
        maximum: the largest.
        flat: values nearer to rest than this count as rest, as the device says.
    """

    axis: Axis
    minimum: int
    maximum: int
    flat: int

    def scale(self, value: int) -> float:
        """Returns -1..1 for a stick or D-pad, 0..1 for a trigger."""
        span = self.maximum - self.minimum
        if span <= 0:
            return 0.0
        if self.axis in (Axis.LEFT_TRIGGER, Axis.RIGHT_TRIGGER):
            level = value - self.minimum
            return 0.0 if level <= self.flat else min(level / span, 1.0)
        # Of an even number of steps the upper middle is rest: 128 of 0..255, 0 of -32768..32767.
        middle = (self.minimum + self.maximum + 1) // 2
        level = value - middle
        if abs(level) <= self.flat:
            return 0.0
        reach = self.maximum - middle if level > 0 else middle - self.minimum
        return max(min(level / reach, 1.0), -1.0)


class Translation:
    """Turns the keys and axes of a device into a contribution to our pad.

    Args:
        device: its description by the kernel.
        ranges: minimum, maximum and flat of its axes, by code.
        keys: the person's own choices, before ours: buttons by the kernel's names of keys.
    """

    def __init__(
        self,
        device: Input,
        ranges: Mapping[int, tuple[int, int, int]],
        keys: Mapping[str, Button] | None = None,
    ) -> None:
        self._axes = {
            code: AxisRange(axis, *ranges[code])
            for code, axis in _find_axes(ranges).items()
            if code in ranges
        }
        self._buttons = {**_find_buttons(device), **_name_codes(keys or {})}
        pulled = {axis.axis for axis in self._axes.values()}
        self._steps = {
            **_name_codes(_DPAD_KEYS),
            **_name_codes({k: (a, 1.0) for k, a in _TRIGGER_KEYS.items() if a not in pulled}),
        }

    @property
    def codes(self) -> set[int]:
        """The keys and buttons that have a meaning."""
        return self._buttons.keys() | self._steps.keys()

    @property
    def axis_codes(self) -> set[int]:
        """The axes that have a meaning."""
        return set(self._axes)

    def read(self, down: set[int], values: Mapping[int, int]) -> Contribution:
        """Returns the contribution of these pressed keys and these values of the axes."""
        axes: dict[Axis, float] = {}
        for code, steps in self._steps.items():
            if code in down:
                axes[steps[0]] = axes.get(steps[0], 0.0) + steps[1]
        for code, range_ in self._axes.items():
            level = range_.scale(values.get(code, 0))
            if abs(level) > abs(axes.get(range_.axis, 0.0)):
                axes[range_.axis] = level
        moved = {axis: value for axis, value in axes.items() if value}
        return Contribution(
            frozenset(self._buttons[code] for code in down & self._buttons.keys()), moved
        )


def _find_buttons(device: Input) -> dict[int, Button]:
    layout = "playstation" if device.vendor in _BY_PLACE else "xbox360"
    pad = load_identities()[layout].layout.buttons
    found = {control.code: button for button, control in pad.items()}
    for first in (ecodes.BTN_TRIGGER, ecodes.BTN_0):
        numbered = [code for code in range(first, first + 16) if device.keys >> code & 1]
        found.update(zip(numbered, _IN_ORDER, strict=False))
    return {**found, **_name_codes(_KEYS)}


def _find_axes(ranges: Mapping[int, object]) -> dict[int, Axis]:
    axes = {
        ecodes.ABS_X: Axis.LEFT_X,
        ecodes.ABS_Y: Axis.LEFT_Y,
        ecodes.ABS_RX: Axis.RIGHT_X,
        ecodes.ABS_RY: Axis.RIGHT_Y,
        ecodes.ABS_BRAKE: Axis.LEFT_TRIGGER,
        ecodes.ABS_GAS: Axis.RIGHT_TRIGGER,
        ecodes.ABS_HAT0X: Axis.DPAD_X,
        ecodes.ABS_HAT0Y: Axis.DPAD_Y,
    }
    if ecodes.ABS_RX in ranges:
        axes |= {ecodes.ABS_Z: Axis.LEFT_TRIGGER, ecodes.ABS_RZ: Axis.RIGHT_TRIGGER}
    else:  # older pads have their right stick there
        axes |= {ecodes.ABS_Z: Axis.RIGHT_X, ecodes.ABS_RZ: Axis.RIGHT_Y}
    return axes


def _name_codes(named: Mapping[str, Meaning]) -> dict[int, Meaning]:
    return {ecodes.ecodes[name]: meaning for name, meaning in named.items()}

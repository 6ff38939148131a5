"""What we claim to be: the identity, the controls and their ranges of a wired Xbox 360 pad.

SDL, Steam, Wine, browsers and RetroArch know this pad without configuration. They recognise it by
the ids, and map it by the *order* of its codes: one button more or less shifts all that follow.
"""

import math

from evdev import ecodes

from neurotouch_hid.device.claim import Claim, Control, make_key
from neurotouch_hid.messages import Axis, Button, GamepadState

NAME = "Microsoft X-Box 360 pad"
BUS = ecodes.BUS_USB
VENDOR = 0x045E
PRODUCT = 0x028E
VERSION = 0x0110
"""Not 0x0001: the mapping databases know that version with an inverted D-pad and no guide."""

PHYS = "neurotouch/pad0"
"""Where the pad claims to be plugged in; udev rules and we find our own devices by it."""


def _axis(code: int, minimum: int, maximum: int) -> Control:
    return Control(ecodes.EV_ABS, code, minimum, maximum)


BUTTONS = {
    Button.A: make_key(ecodes.BTN_SOUTH),
    Button.B: make_key(ecodes.BTN_EAST),
    # By label, as the kernel's xpad driver sends them and SDL expects them: BTN_X is BTN_NORTH,
    # although the button marked X lies west.
    Button.X: make_key(ecodes.BTN_NORTH),
    Button.Y: make_key(ecodes.BTN_WEST),
    Button.LB: make_key(ecodes.BTN_TL),
    Button.RB: make_key(ecodes.BTN_TR),
    Button.BACK: make_key(ecodes.BTN_SELECT),
    Button.START: make_key(ecodes.BTN_START),
    Button.GUIDE: make_key(ecodes.BTN_MODE),
    Button.LS: make_key(ecodes.BTN_THUMBL),
    Button.RS: make_key(ecodes.BTN_THUMBR),
}

AXES = {
    Axis.LEFT_X: _axis(ecodes.ABS_X, -32768, 32767),
    Axis.LEFT_Y: _axis(ecodes.ABS_Y, -32768, 32767),
    Axis.LEFT_TRIGGER: _axis(ecodes.ABS_Z, 0, 255),
    Axis.RIGHT_X: _axis(ecodes.ABS_RX, -32768, 32767),
    Axis.RIGHT_Y: _axis(ecodes.ABS_RY, -32768, 32767),
    Axis.RIGHT_TRIGGER: _axis(ecodes.ABS_RZ, 0, 255),
    Axis.DPAD_X: _axis(ecodes.ABS_HAT0X, -1, 1),
    Axis.DPAD_Y: _axis(ecodes.ABS_HAT0Y, -1, 1),
}

CONTROLS = (*BUTTONS.values(), *AXES.values())

CLAIM = Claim(NAME, (BUS, VENDOR, PRODUCT, VERSION), PHYS, CONTROLS)


def encode(state: GamepadState) -> tuple[int, ...]:
    """Return the report of a state: the value of every control, in the order of CONTROLS."""
    return (
        *(int(button in state.buttons) for button in BUTTONS),
        *(_level(state.axes.get(axis, 0.0), control) for axis, control in AXES.items()),
    )


def _level(value: float, control: Control) -> int:
    """Scale -1..1 or 0..1 to the control's integers, the same to both sides; NaN is at rest.

    The kernel does not clamp, so a value out of range would reach the games.
    """
    if math.isnan(value):
        return 0
    lowest = -1.0 if control.minimum < 0 else 0.0
    return round(min(max(value, lowest), 1.0) * control.maximum)

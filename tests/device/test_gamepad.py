"""The claim of being an Xbox 360 pad, number by number, and the scaling of values."""

import math
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from neurotouch_hid.device import gamepad
from neurotouch_hid.device.claim import Control
from neurotouch_hid.messages import Axis, Button, GamepadState

# From the kernel's xpad driver, as numbers: a second source beside the names in the module.
KEY_CODES = {
    Button.A: 0x130,
    Button.B: 0x131,
    Button.X: 0x133,
    Button.Y: 0x134,
    Button.LB: 0x136,
    Button.RB: 0x137,
    Button.BACK: 0x13A,
    Button.START: 0x13B,
    Button.GUIDE: 0x13C,
    Button.LS: 0x13D,
    Button.RS: 0x13E,
}
AXIS_CODES = {
    Axis.LEFT_X: (0, -32768, 32767),
    Axis.LEFT_Y: (1, -32768, 32767),
    Axis.LEFT_TRIGGER: (2, 0, 255),
    Axis.RIGHT_X: (3, -32768, 32767),
    Axis.RIGHT_Y: (4, -32768, 32767),
    Axis.RIGHT_TRIGGER: (5, 0, 255),
    Axis.DPAD_X: (16, -1, 1),
    Axis.DPAD_Y: (17, -1, 1),
}


def crc16_arc(data: bytes) -> int:
    crc = 0
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0xA001 if crc & 1 else 0)
    return crc


def value_of(state: GamepadState, control: Control) -> int:
    return gamepad.encode(state)[gamepad.CONTROLS.index(control)]


def test_every_button_and_axis_of_the_messages_has_its_code():
    assert {button: control.code for button, control in gamepad.BUTTONS.items()} == KEY_CODES
    assert {
        axis: (control.code, control.minimum, control.maximum)
        for axis, control in gamepad.AXES.items()
    } == AXIS_CODES
    assert set(gamepad.BUTTONS) == set(Button)
    assert set(gamepad.AXES) == set(Axis)


def test_sdl_knows_the_pad_by_this_guid():
    words = (
        gamepad.BUS,
        crc16_arc(gamepad.NAME.encode()),
        gamepad.VENDOR,
        0,
        gamepad.PRODUCT,
        0,
        gamepad.VERSION,
        0,
    )
    assert struct.pack("<8H", *words).hex() == "030081b85e0400008e02000010010000"


def test_the_name_fits_the_kernel_and_sdl_does_not_ignore_it():
    assert len(gamepad.NAME.encode()) < 80
    assert not gamepad.NAME.startswith(("uinput-", "Mouse ", "gpio_ir_recv"))
    assert " Keyboard" not in gamepad.NAME


@pytest.mark.parametrize("button", Button)
def test_a_button_moves_only_itself(button):
    report = gamepad.encode(GamepadState(0, frozenset({button})))
    assert sum(report) == 1
    assert value_of(GamepadState(0, frozenset({button})), gamepad.BUTTONS[button]) == 1


@pytest.mark.parametrize("axis", Axis)
def test_an_axis_moves_only_itself(axis):
    control = gamepad.AXES[axis]
    report = gamepad.encode(GamepadState(0, axes={axis: 1.0}))
    assert sum(report) == control.maximum
    assert value_of(GamepadState(0, axes={axis: 1.0}), control) == control.maximum


def test_a_pad_that_nobody_touches_is_all_zero():
    assert gamepad.encode(GamepadState(5)) == gamepad.CLAIM.neutral
    assert gamepad.encode(GamepadState(5, axes=dict.fromkeys(Axis, 0.0))) == gamepad.CLAIM.neutral


@pytest.mark.parametrize(
    ("axis", "value", "expected"),
    [
        (Axis.LEFT_X, -1.0, -32767),
        (Axis.LEFT_X, -2.0, -32767),
        (Axis.LEFT_X, 2.0, 32767),
        (Axis.LEFT_X, math.inf, 32767),
        (Axis.LEFT_X, -math.inf, -32767),
        (Axis.LEFT_X, math.nan, 0),
        (Axis.LEFT_X, 0.5, 16384),
        (Axis.LEFT_X, -0.5, -16384),
        (Axis.LEFT_TRIGGER, -1.0, 0),
        (Axis.LEFT_TRIGGER, 0.5, 128),
        (Axis.LEFT_TRIGGER, 9.0, 255),
        (Axis.LEFT_TRIGGER, math.nan, 0),
        (Axis.DPAD_Y, -1.0, -1),
        (Axis.DPAD_Y, 0.2, 0),
    ],
)
def test_values_are_clamped_and_rounded(axis, value, expected):
    assert value_of(GamepadState(0, axes={axis: value}), gamepad.AXES[axis]) == expected


@given(value=st.floats(), axis=st.sampled_from(list(Axis)))
def test_no_number_leaves_the_range(value, axis):
    control = gamepad.AXES[axis]
    level = value_of(GamepadState(0, axes={axis: value}), control)
    assert control.minimum <= level <= control.maximum
    if control.minimum < 0 and not math.isnan(value):
        assert value_of(GamepadState(0, axes={axis: -value}), control) == -level

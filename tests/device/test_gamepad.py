"""The spec of being an Xbox 360 pad, number by number, and the scaling of values."""

import math
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from neurotouch_hid.device.outputs.identity import load_identities
from neurotouch_hid.device.outputs.spec import Control
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


XBOX = load_identities()["xbox360"]
PLAYSTATION = load_identities()["playstation"]


def crc16_arc(data: bytes) -> int:
    crc = 0
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0xA001 if crc & 1 else 0)
    return crc


def value_of(state: GamepadState, control: Control) -> int:
    return XBOX.layout.encode(state)[XBOX.layout.controls.index(control)]


def test_every_button_and_axis_of_the_messages_has_its_code():
    assert {button: control.code for button, control in XBOX.layout.buttons.items()} == KEY_CODES
    assert {
        axis: (control.code, control.minimum, control.maximum)
        for axis, control in XBOX.layout.axes.items()
    } == AXIS_CODES
    assert set(XBOX.layout.buttons) == set(Button)
    assert set(XBOX.layout.axes) == set(Axis)


def test_sdl_knows_the_pad_by_this_guid():
    words = (
        3,
        crc16_arc(XBOX.name.encode()),
        XBOX.vendor,
        0,
        XBOX.product,
        0,
        XBOX.version,
        0,
    )
    assert struct.pack("<8H", *words).hex() == "030081b85e0400008e02000010010000"


PLAYSTATION_CODES = {
    # From the kernel's hid-playstation driver: by place.
    **KEY_CODES,
    Button.X: 0x134,
    Button.Y: 0x133,
}


def test_a_playstation_pad_has_its_own_codes_ranges_and_rest():
    layout = PLAYSTATION.layout
    assert {button: control.code for button, control in layout.buttons.items()} == PLAYSTATION_CODES
    assert [control.code for control in layout.trigger_buttons.values()] == [0x138, 0x139]
    sticks = [Axis.LEFT_X, Axis.LEFT_Y, Axis.RIGHT_X, Axis.RIGHT_Y]
    for axis, control in layout.axes.items():
        rest = 128 if axis in sticks else 0
        assert control.code == AXIS_CODES[axis][0]
        assert control.rest == rest
        if axis not in (Axis.DPAD_X, Axis.DPAD_Y):
            assert (control.minimum, control.maximum) == (0, 255)
    assert set(layout.axes) == set(Axis)


@pytest.mark.parametrize(
    ("axes", "changed"),
    [
        ({Axis.LEFT_X: 1.0}, {"left_x": 255}),
        ({Axis.LEFT_X: -1.0}, {"left_x": 1}),
        ({Axis.LEFT_TRIGGER: 0.001}, {}),
        ({Axis.LEFT_TRIGGER: 0.01}, {"left_trigger": 3, "TL2": 1}),
        ({Axis.RIGHT_TRIGGER: 1.0}, {"right_trigger": 255, "TR2": 1}),
    ],
)
def test_a_playstation_trigger_is_a_button_too(axes, changed):
    layout = PLAYSTATION.layout
    names = [*layout.buttons, "TL2", "TR2", *layout.axes]
    report = layout.encode(GamepadState(0, axes=axes))
    neutral = PLAYSTATION.make_spec().neutral
    pairs = zip(names, report, neutral, strict=True)
    assert {str(name): value for name, value, rest in pairs if value != rest} == changed


@given(buttons=st.frozensets(st.sampled_from(list(Button))), value=st.floats(-1, 1))
@pytest.mark.parametrize("identity", [XBOX, PLAYSTATION], ids=["xbox", "playstation"])
def test_what_a_report_says_is_what_was_put_in(identity, buttons, value):
    layout = identity.layout
    state = GamepadState(0, buttons, {Axis.RIGHT_Y: value})
    down, axes = layout.decode(layout.encode(state))
    assert down == buttons
    assert axes.keys() <= {Axis.RIGHT_Y}
    assert axes.get(Axis.RIGHT_Y, 0.0) == pytest.approx(value, abs=0.5 / 127)


@pytest.mark.parametrize("button", Button)
def test_a_button_moves_only_itself(button):
    report = XBOX.layout.encode(GamepadState(0, frozenset({button})))
    assert sum(report) == 1
    assert value_of(GamepadState(0, frozenset({button})), XBOX.layout.buttons[button]) == 1


@pytest.mark.parametrize("axis", Axis)
def test_an_axis_moves_only_itself(axis):
    control = XBOX.layout.axes[axis]
    report = XBOX.layout.encode(GamepadState(0, axes={axis: 1.0}))
    assert sum(report) == control.maximum
    assert value_of(GamepadState(0, axes={axis: 1.0}), control) == control.maximum


def test_a_pad_that_nobody_touches_is_all_zero():
    assert XBOX.layout.encode(GamepadState(5)) == XBOX.make_spec().neutral
    assert (
        XBOX.layout.encode(GamepadState(5, axes=dict.fromkeys(Axis, 0.0)))
        == XBOX.make_spec().neutral
    )


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
    assert value_of(GamepadState(0, axes={axis: value}), XBOX.layout.axes[axis]) == expected


@given(value=st.floats(), axis=st.sampled_from(list(Axis)))
def test_no_number_leaves_the_range(value, axis):
    control = XBOX.layout.axes[axis]
    level = value_of(GamepadState(0, axes={axis: value}), control)
    assert control.minimum <= level <= control.maximum
    if control.minimum < 0 and not math.isnan(value):
        assert value_of(GamepadState(0, axes={axis: -value}), control) == -level

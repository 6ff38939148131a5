"""What a helper's device means on our pad, and what two hands do together."""

from pathlib import Path

import pytest
from evdev import ecodes
from hypothesis import given
from hypothesis import strategies as st

from neurotouch_hid.device.inputs.contribution import Contribution, merge
from neurotouch_hid.device.inputs.nodes import Input
from neurotouch_hid.device.inputs.translation import Translation
from neurotouch_hid.messages import Axis, Button

XBOX_RANGES = {
    **dict.fromkeys(("ABS_X", "ABS_Y", "ABS_RX", "ABS_RY"), (-32768, 32767, 128)),
    **dict.fromkeys(("ABS_Z", "ABS_RZ"), (0, 1023, 0)),
    **dict.fromkeys(("ABS_HAT0X", "ABS_HAT0Y"), (-1, 1, 0)),
}
SONY_RANGES = {**XBOX_RANGES, **dict.fromkeys(("ABS_X", "ABS_Y", "ABS_RX", "ABS_RY"), (0, 255, 0))}
OLD_RANGES = dict.fromkeys(("ABS_X", "ABS_Y", "ABS_Z", "ABS_RZ"), (0, 255, 0))


def name(codes: dict) -> dict:
    return {ecodes.ecodes[name]: value for name, value in codes.items()}


def make(vendor: int, ranges: dict, keys: tuple[str, ...] = (), **own: Button) -> Translation:
    bits = sum(1 << ecodes.ecodes[key] for key in keys)
    device = Input(Path("/dev/input/event9"), "It", "usb-1", "", vendor, 1, bits, 0, 0, 0)
    return Translation(device, name(ranges), own)


def read(translation: Translation, *down: str, rest: int = 0, **values: int) -> Contribution:
    at_rest = dict.fromkeys(translation.axis_codes, rest)
    return translation.read({ecodes.ecodes[key] for key in down}, {**at_rest, **name(values)})


@pytest.mark.parametrize(
    ("vendor", "key", "button"),
    [
        (0x045E, "BTN_SOUTH", Button.A),
        (0x045E, "BTN_NORTH", Button.X),  # by label, as its driver does
        (0x045E, "BTN_WEST", Button.Y),
        (0x054C, "BTN_NORTH", Button.Y),  # by place
        (0x057E, "BTN_WEST", Button.X),
        (0x0F0D, "BTN_MODE", Button.GUIDE),
    ],
)
def test_the_buttons_of_pads(vendor, key, button):
    assert read(make(vendor, XBOX_RANGES), key) == Contribution(frozenset({button}))


@pytest.mark.parametrize(
    ("code", "value", "axis", "level"),
    [
        ("ABS_X", -32768, Axis.LEFT_X, -1.0),
        ("ABS_RY", 32767, Axis.RIGHT_Y, 1.0),
        ("ABS_X", 128, None, 0.0),  # flat
        ("ABS_Z", 1023, Axis.LEFT_TRIGGER, 1.0),
        ("ABS_RZ", 341, Axis.RIGHT_TRIGGER, 1 / 3),
        ("ABS_HAT0Y", -1, Axis.DPAD_Y, -1.0),
    ],
)
def test_the_axes_of_pads(code, value, axis, level):
    share = read(make(0x045E, XBOX_RANGES), **{code: value})
    assert share.axes == ({axis: pytest.approx(level)} if axis else {})


def test_sticks_that_rest_in_the_middle():
    sony = make(0x054C, SONY_RANGES)
    sticks = dict.fromkeys(("ABS_X", "ABS_Y", "ABS_RX", "ABS_RY"), 128)
    assert read(sony, **sticks) == Contribution()
    assert read(sony, **{**sticks, "ABS_X": 255}).axes == {Axis.LEFT_X: 1.0}
    assert read(sony, **{**sticks, "ABS_X": 0}).axes == {Axis.LEFT_X: -1.0}


def test_the_right_stick_of_old_pads():
    old = make(0x0079, OLD_RANGES, ("BTN_TRIGGER", "BTN_THUMB", "BTN_TL2"))
    rest = {"ABS_X": 128, "ABS_Y": 128, "ABS_Z": 128, "ABS_RZ": 128}
    assert read(old, **{**rest, "ABS_Z": 255}).axes == {Axis.RIGHT_X: 1.0}
    assert read(old, "BTN_TRIGGER", "BTN_THUMB", **rest).buttons == {Button.A, Button.B}
    assert read(old, "BTN_TL2", **rest).axes == {Axis.LEFT_TRIGGER: 1.0}


def test_the_second_trigger_button_does_not_count_beside_an_axis():
    assert read(make(0x045E, XBOX_RANGES), "BTN_TL2") == Contribution()


def test_keyboards_and_switches():
    keyboard = make(0x046D, {})
    assert read(keyboard, "KEY_SPACE").buttons == {Button.A}
    assert read(keyboard, "KEY_LEFT", "KEY_UP").axes == {Axis.DPAD_X: -1.0, Axis.DPAD_Y: -1.0}
    assert read(keyboard, "KEY_LEFT", "KEY_RIGHT") == Contribution()
    assert read(keyboard, "BTN_LEFT").buttons == {Button.A}


def test_a_persons_own_keys_come_first():
    keyboard = make(0x046D, {}, KEY_F5=Button.GUIDE, KEY_SPACE=Button.Y)
    assert read(keyboard, "KEY_F5", "KEY_SPACE").buttons == {Button.GUIDE, Button.Y}


@pytest.mark.parametrize("priority", ["equal", "gel", "helper"])
def test_buttons_are_down_if_either_holds_them(priority):
    both = merge(Contribution(frozenset({Button.A})), Contribution(frozenset({Button.B})), priority)
    assert both.buttons == {Button.A, Button.B}


@pytest.mark.parametrize(
    ("gel", "helper", "priority", "expected"),
    [
        ({Axis.LEFT_X: 0.5}, {Axis.LEFT_X: -0.6}, "equal", {Axis.LEFT_X: -0.6}),
        ({Axis.LEFT_X: 0.5}, {Axis.LEFT_X: -0.5}, "equal", {Axis.LEFT_X: 0.5}),
        # A stick is one: nobody gets the x of one hand and the y of the other.
        ({Axis.LEFT_X: 0.5}, {Axis.LEFT_Y: 0.6}, "equal", {Axis.LEFT_Y: 0.6}),
        ({Axis.LEFT_X: 0.5}, {Axis.RIGHT_Y: 0.1}, "equal", {Axis.LEFT_X: 0.5, Axis.RIGHT_Y: 0.1}),
        ({Axis.LEFT_X: 0.2}, {Axis.LEFT_X: -0.6}, "gel", {Axis.LEFT_X: 0.2}),
        ({Axis.LEFT_X: 0.9}, {Axis.LEFT_X: -0.2}, "helper", {Axis.LEFT_X: -0.2}),
        ({Axis.LEFT_X: 0.9}, {Axis.LEFT_X: -0.1}, "helper", {Axis.LEFT_X: 0.9}),  # a worn stick
        ({Axis.LEFT_X: 0.9}, {}, "helper", {Axis.LEFT_X: 0.9}),
        ({}, {Axis.LEFT_X: 0.9}, "gel", {Axis.LEFT_X: 0.9}),
        (
            {Axis.LEFT_TRIGGER: 0.2, Axis.RIGHT_TRIGGER: 0.9},
            {Axis.LEFT_TRIGGER: 0.7, Axis.RIGHT_TRIGGER: 0.1},
            "equal",
            {Axis.LEFT_TRIGGER: 0.7, Axis.RIGHT_TRIGGER: 0.9},
        ),
        ({Axis.DPAD_X: 1.0}, {Axis.DPAD_Y: 1.0}, "equal", {Axis.DPAD_X: 1.0}),
    ],
)
def test_axes_of_two_hands(gel, helper, priority, expected):
    assert merge(Contribution(axes=gel), Contribution(axes=helper), priority).axes == expected


SHARES = st.builds(
    Contribution,
    st.frozensets(st.sampled_from(list(Button))),
    st.dictionaries(st.sampled_from(list(Axis)), st.floats(-1, 1)),
)


@given(share=SHARES, priority=st.sampled_from(["equal", "gel", "helper"]))
def test_who_does_nothing_changes_nothing(share, priority):
    moved = {axis: value for axis, value in share.axes.items() if value}
    for both in (merge(share, Contribution(), priority), merge(Contribution(), share, priority)):
        assert (both.buttons, both.axes) == (share.buttons, moved)

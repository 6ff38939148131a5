"""The keyboard's spec, and its table of keys beside that of the profiles."""

import pytest

from neurotouch_hid.device.outputs import keyboard, mouse
from neurotouch_hid.messages import GamepadState
from neurotouch_hid.profile.schema.keyboard_keys import KEYS, MOUSE_BUTTONS


def test_it_has_exactly_the_keys_that_a_profile_can_name():
    assert sorted(keyboard.KEYS) == sorted(KEYS.values())


def test_the_mouse_has_exactly_the_buttons_that_a_profile_can_name():
    assert sorted(mouse.BUTTONS) == sorted(MOUSE_BUTTONS.values())


def test_udev_will_take_it_for_a_keyboard_and_nobody_for_a_pad():
    codes = {control.code for control in keyboard.KEYS.values()}
    assert len(codes) == len(keyboard.KEYS)
    assert codes >= set(range(1, 32))  # udev's rule for ID_INPUT_KEYBOARD
    assert max(codes) < 0x100  # no BTN_*: those begin here
    power, sleep, wakeup = 116, 142, 143
    assert not codes & {power, sleep, wakeup}


@pytest.mark.parametrize("name", keyboard.KEYS)
def test_a_key_moves_only_itself(name):
    report = keyboard.encode_keys(GamepadState(0, keys=frozenset({name})))
    assert sum(report) == 1
    assert keyboard.SPEC.controls[report.index(1)] == keyboard.KEYS[name]


# From the kernel's input-event-codes.h, as numbers.
@pytest.mark.parametrize(
    ("name", "code"),
    [
        *(("KEY_ESC", 1), ("KEY_Q", 16), ("KEY_A", 30), ("KEY_Z", 44), ("KEY_0", 11)),
        *(("KEY_LEFTCTRL", 29), ("KEY_RIGHTALT", 100), ("KEY_LEFTMETA", 125), ("KEY_SYSRQ", 99)),
        *(("KEY_F1", 59), ("KEY_F12", 88), ("KEY_F24", 194), ("KEY_UP", 103), ("KEY_KP0", 82)),
        *(("KEY_PLAYPAUSE", 164), ("KEY_VOLUMEUP", 115), ("KEY_MICMUTE", 248)),
    ],
)
def test_codes(name, code):
    assert keyboard.KEYS[name].code == code


def test_modifiers_stand_first_so_that_a_chord_begins_with_them():
    first = {"CTRL", "SHIFT", "ALT", "META"}
    assert set(list(keyboard.KEYS)[:8]) == {
        f"KEY_{side}{key}" for side in ("LEFT", "RIGHT") for key in first
    }


@pytest.mark.parametrize("spec", [keyboard.SPEC, mouse.SPEC])
def test_sdl_and_the_kernel_take_the_names(spec):
    assert len(spec.name.encode()) < 80
    assert spec.phys.startswith("neurotouch/")  # the rules and we find them by it
    assert spec.ids[:2] == (0x06, 0)  # BUS_VIRTUAL, nobody's vendor id


@pytest.mark.parametrize("alt", ["KEY_LEFTALT", "KEY_RIGHTALT"])
def test_the_magic_keys_of_the_kernel_stay_out_of_reach(alt):
    """It listens for Print going down while Alt is; a chord may also grow from state to state."""
    with_alt = keyboard.encode_keys(GamepadState(0, keys=frozenset({alt, "KEY_B"})))
    magic = GamepadState(0, keys=frozenset({alt, "KEY_SYSRQ", "KEY_B"}))
    assert keyboard.encode_keys(magic) == with_alt
    assert sum(keyboard.encode_keys(GamepadState(0, keys=frozenset({"KEY_SYSRQ", "KEY_B"})))) == 2


def test_at_rest_all_is_zero():
    assert keyboard.encode_keys(GamepadState(0)) == keyboard.SPEC.neutral
    assert mouse.encode_buttons(GamepadState(0)) == mouse.SPEC.neutral

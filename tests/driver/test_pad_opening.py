"""Who plays on a pad, without a kernel; with one, see ``tests/kernel/test_copilot.py``."""

import pytest

from neurotouch_hid.device import ExtraDevice
from neurotouch_hid.driver.pad_opening import open_pad
from neurotouch_hid.driver.settings import DriverSettings
from neurotouch_hid.errors import DeviceError, ProfileError
from neurotouch_hid.messages import Button
from neurotouch_hid.profile.reading.load import load_settings

README_EXAMPLE = """
version: 1
copilot:
  device: 8BitDo               # auto, a node, or a part of the name
  priority: helper             # or gel; equal: who moves further
  keys: {KEY_F: a, KEY_G: b}   # for keyboards and switches
yield_to_mouse_ms: 1500        # the gel's pointer waits while the real mouse moves
"""


@pytest.fixture
def load(tmp_path):
    def load(text: str) -> DriverSettings:
        file = tmp_path / "driver.yaml"
        file.write_text(text)
        return load_settings(file, DriverSettings)

    return load


def test_without_a_copilot_the_gel_plays_alone():
    played = open_pad("memory", [ExtraDevice.KEYBOARD], DriverSettings())
    with played.device as pad:
        assert played.copilot is None
        assert pad.name == "memory"
        told = played.tell_facts()
    assert told == {
        "copilot": "none",
        "mouse": "nothing moves the pointer",
        "rumble": {"strong": 0.0, "weak": 0.0},
    }


def test_a_copilot_who_is_not_there_is_an_error_or_waited_for():
    with pytest.raises(DeviceError, match="There is no input device 'No such pad'"):
        open_pad("memory", [], DriverSettings(), copilot="No such pad")
    played = open_pad("memory", [], DriverSettings(), copilot="No such pad", wait=True)
    with played.device:
        assert played.copilot is not None
        said = played.copilot.describe()
        assert said.startswith("waits for No such pad. There is no input device 'No such pad'")


def test_a_pad_that_cannot_be_made_leaves_no_copilot_behind():
    with pytest.raises(DeviceError, match="no device called 'joystick'"):
        open_pad("joystick", [], DriverSettings(), copilot="No such pad", wait=True)


def test_rumble_is_claimed_only_if_somebody_wants_it():
    asked = {}

    def make(kind, extra_devices, **options):
        asked.update(options)
        raise DeviceError("enough")

    for shows, copilot in ((False, None), (True, None), (False, "Comes later")):
        options = {"shows_rumble": shows, "copilot": copilot, "wait": True}
        with pytest.raises(DeviceError, match="enough"):
            open_pad("uinput", [], DriverSettings(), make=make, **options)
        assert (asked["hear_rumble"] is not None) is (shows or copilot is not None)


def test_the_settings_of_the_readme(load):
    settings = load(README_EXAMPLE)
    assert settings.copilot.device == "8BitDo"
    assert settings.copilot.priority == "helper"
    assert settings.copilot.keys == {"KEY_F": Button.A, "KEY_G": Button.B}
    assert settings.yield_to_mouse_ms == 1500


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("copilot: {keys: {KEY_NOPE: a}}", "the kernel knows no key or button of this name"),
        ("copilot: {keys: {KEY_F: nope}}", "copilot.keys.KEY_F"),
        ("copilot: {priority: both}", "copilot.priority"),
        ("yield_to_mouse_ms: 20000", "yield_to_mouse_ms"),
    ],
)
def test_wrong_settings_are_refused(load, text, says):
    with pytest.raises(ProfileError, match=says):
        load(f"version: 1\n{text}\n")

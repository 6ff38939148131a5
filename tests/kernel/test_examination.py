"""The doctor and the list of devices, with a real kernel and a real udevd under them."""

import re

import pytest


@pytest.fixture(scope="module")
def pads(guest):
    return guest("doctor_pads")


def test_the_module_and_the_right_are_there(pads):
    assert pads["module"]["status"] == "OK"
    assert pads["right"] == {
        "status": "OK",
        "sentence": "You may make virtual gamepads.",
        "fix": None,
        "commands": [],
    }


def test_without_right_the_way_to_it_is_told(pads):
    said = pads["right_of_nobody"]
    assert said["status"] == "FAILED"
    assert "its mode is 0600" in said["sentence"]
    assert any("70-neurotouch-uinput.rules" in command for command in said["commands"])


def test_the_installed_rule_is_found(pads):
    assert pads["rule"]["status"] == "OK"
    assert "/run/udev/rules.d/70-neurotouch-uinput.rules" in pads["rule"]["sentence"]


def test_a_press_comes_back(pads):
    assert pads["loop_back"]["status"] == "OK"
    assert re.search(
        r"A press of A came back after \d+\.\d\d ms \(/dev/input/event\d+\)",
        pads["loop_back"]["sentence"],
    )


def test_udev_and_sdl_take_it_for_a_pad(pads):
    assert pads["recognised"]["status"] == "OK"
    assert "045e:028e" in pads["recognised"]["sentence"]
    assert pads["hidden"]["status"] == "WARNING"
    assert "SDL_GAMECONTROLLER_IGNORE_DEVICES" in pads["hidden"]["sentence"]


def test_our_pad_is_listed_as_ours_and_only_while_it_is_there(pads):
    (ours,) = pads["devices"]["pads"]
    assert ours["name"] == "Microsoft X-Box 360 pad"
    assert ours["ours"]
    assert ours["virtual"]
    assert ours["place"] == "neurotouch/pad0"
    assert ours["ids"] == {"bus": 3, "vendor": 0x045E, "product": 0x028E, "version": 0x0110}
    assert pads["after"] == 0

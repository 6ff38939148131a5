"""The three reasons why /dev/uinput or /dev/uhid cannot be used, and the shipped rules."""

import pytest

from neurotouch_hid.device.outputs import uhid, uinput

RULES = {"uinput": uinput.RULE, "uhid": uhid.RULE}


@pytest.fixture(params=RULES)
def name(request):
    return request.param


@pytest.fixture
def opening(guest, name):
    return guest("opening")[name]


def test_without_right(opening, name):
    said = opening["without_right"]
    assert said["message"] == f"You have no right to write to /dev/{name} (its mode is 0600)."
    assert RULES[name] in said["hint"]


def test_without_node(opening, name):
    said = opening["without_node"]
    assert said["message"] == f"There is no /dev/{name} here, so no virtual gamepad can be made."
    assert f"sudo modprobe {name}" in said["hint"]


def test_without_module(opening, name):
    said = opening["without_module"]
    assert said["message"] == f"'/dev/{name}' exists, but the kernel module behind it is missing."
    assert f"sudo modprobe {name}" in said["hint"]


def test_opening_the_static_node_loads_the_module(opening):
    assert opening["with_right"]["message"] == "opened"
    assert opening["module_loaded_by_opening"]["message"] == "opened"


def test_our_rule_gives_the_node_to_the_user_at_the_seat(opening):
    assert "uaccess" in opening["tags"].split(":")
    assert opening["static_node_tagged"]

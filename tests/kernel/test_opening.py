"""The three reasons why /dev/uinput cannot be used, and the shipped rule."""

import pytest

from neurotouch_hid.device.uinput import RULE


@pytest.fixture(scope="module")
def opening(guest):
    return guest("opening")


def test_without_right(opening):
    said = opening["without_right"]
    assert said["message"] == "You have no right to write to /dev/uinput (its mode is 0600)."
    assert RULE in said["hint"]


def test_without_node(opening):
    said = opening["without_node"]
    assert said["message"] == "There is no /dev/uinput here, so no virtual gamepad can be made."
    assert "sudo modprobe uinput" in said["hint"]


def test_without_module(opening):
    said = opening["without_module"]
    assert said["message"] == "/dev/uinput exists, but the kernel module behind it is missing."
    assert "sudo modprobe uinput" in said["hint"]


def test_opening_the_static_node_loads_the_module(opening):
    assert opening["with_right"]["message"] == "opened"
    assert opening["module_loaded_by_opening"]["message"] == "opened"


def test_our_rule_gives_the_node_to_the_user_at_the_seat(opening):
    assert "uaccess" in opening["tags"].split(":")
    assert opening["static_node_tagged"]

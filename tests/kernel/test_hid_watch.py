"""``devices --watch``: our HID pad read back through hidapi, by our own command."""

import pytest


@pytest.fixture(scope="module")
def seen(guest):
    return guest("watching")


def test_each_report_is_a_line(seen):
    assert seen["title"].startswith("Reports of NeuroTouch Gamepad (/dev/hidraw")
    assert seen["lines"] == [
        {"pad": "neurotouch/pad0", "buttons": ["a", "lb"], "axes": {}},
        {
            "pad": "neurotouch/pad0",
            "buttons": [],
            "axes": {"left_x": -1.0, "right_trigger": 1.0, "dpad_y": 1.0},
        },
        {"pad": "neurotouch/pad0", "buttons": [], "axes": {}},
    ]


def test_it_ends_with_the_pad(seen):
    assert seen["rest"] == ""
    assert "NeuroTouch Gamepad was removed" in seen["said"]
    assert seen["exit_code"] == 0


def test_without_a_pad(seen):
    code, said = seen["without"]
    assert code == 7
    assert "No HID pad of this program was found" in said
    assert "neurotouch run --device hid" in said


def test_without_right(seen):
    assert "You have no right to read /dev/hidraw" in seen["denied"]["message"]
    assert 'KERNELS=="0003:1209:4E54.*"' in seen["denied"]["hint"]
    assert "70-neurotouch-hidraw.rules" in seen["denied"]["hint"]

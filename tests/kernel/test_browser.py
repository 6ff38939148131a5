"""Chromium's Gamepad API on the real pad of a real kernel."""

import os

import pytest

from tests.page.chromium import MISSING

NOTHING = [0.0] * 17


@pytest.fixture(scope="module")
def gamepad(guest):
    seen = guest("browser")
    if seen is None and os.environ.get("NEUROTOUCH_REQUIRE_BROWSER") == "1":
        pytest.fail("browser tests are required, but no Chromium is installed")
    if seen is None:
        pytest.skip(MISSING)
    return seen


def test_a_browser_takes_it_for_a_standard_gamepad(gamepad):
    pressed = gamepad["pressed"]
    assert pressed["mapping"] == "standard"
    assert "Vendor: 045e Product: 028e" in pressed["id"]
    assert (len(pressed["axes"]), len(pressed["buttons"])) == (4, 17)
    assert pressed["buttons"] == [1.0, *NOTHING[1:]]
    assert pressed["axes"] == [0.0] * 4


def test_a_push_to_the_left_moves_its_left_stick(gamepad):
    x, *others = gamepad["pushed"]["axes"]
    assert x == pytest.approx(-1.0, abs=0.1)
    assert others == pytest.approx([0.0] * 3, abs=0.02)
    assert gamepad["pushed"]["buttons"] == NOTHING
    assert gamepad["let_go"]["axes"] == [0.0] * 4


def test_the_spacecraft_reads_it_through_the_gamepad_api(gamepad):
    ship = gamepad["ship"]
    assert ship.pop("yaw") == pytest.approx(-1.0, abs=0.1)
    assert set(ship.values()) == {0}

"""The emulated camera in the real kernel: three drivers see what it was shown, pixel by pixel."""

import numpy as np
import pytest

from tests.emulator.comparison import assert_same
from tests.emulator.host import make_scene
from tests.kernel.guest.camera import SCENE, SERIAL

OURS = {
    "idProduct": "841a",
    "bcdDevice": "0306",
    "product": "DAVIS 346",
    "manufacturer": "iniVation",
}


@pytest.fixture(scope="module")
def saw(guest):
    return guest("camera")


def test_linux_knows_it(saw):
    assert saw["super"] == [{**OURS, "speed": "5000", "serial": SERIAL}]


@pytest.mark.parametrize("driver", ["events", "dv", "own"])
def test_every_driver_sees_what_was_shown(saw, results, driver):
    assert_same(np.load(results / f"camera-{driver}.npz"), make_scene(**SCENE))


def test_a_driver_notices_that_it_is_unplugged(saw):
    assert saw["unplugged"] is True


def test_events_survives_that_it_is_unplugged(saw):
    seen = saw["unplugged_events"]
    assert seen["plays"] is True
    assert seen["trouble"].startswith("The camera iniVation DAVIS 346 00000346 has failed")
    assert seen["code"] == 0


def test_the_command_plugs_in_another_one_on_usb_2(saw):
    assert saw["two"]["both"] == [
        {**OURS, "speed": "480", "serial": "00000001"},
        {**OURS, "speed": "5000", "serial": "00000002"},
    ]
    assert saw["two"]["code"] == 0
    assert saw["two"]["said"].startswith("Camera 00000001 is plugged in and sees file:")


def test_nothing_is_left_of_them(saw):
    assert saw["left"] == []

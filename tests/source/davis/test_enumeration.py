"""Cameras as Linux lists them."""

from dataclasses import replace

import pytest

from neurotouch_hid.errors import CameraError
from neurotouch_hid.source.davis.enumeration import (
    CameraInfo,
    choose_camera,
    describe_users,
    find_cameras,
)

CAMERA = {
    "idVendor": "152a",
    "idProduct": "841a",
    "bcdDevice": "0306",
    "busnum": "2",
    "devnum": "7",
    "speed": "5000",
    "product": "DAVIS 346",
    "serial": "00001055",
}


@pytest.fixture
def plug(tmp_path):
    """Returns what puts a device into a listing, which lies in ``plug.folder``."""

    def plug(port, **changes):
        folder = tmp_path / port
        folder.mkdir()
        for name, text in (CAMERA | changes).items():
            if text is not None:
                (folder / name).write_text(text + "\n")

    plug.folder = tmp_path
    return plug


def test_a_camera_is_described(plug):
    plug("2-1.4")
    (info,) = find_cameras(plug.folder)
    assert info == replace(
        CameraInfo(2, 7, "2-1.4", "00001055", "DAVIS 346", 5000, 6), reason=info.reason
    )
    assert str(info.node) == "/dev/bus/usb/002/007"
    assert "no right to read and write /dev/bus/usb/002/007" in info.reason  # it is not there


def test_others_and_half_gone_ones_are_left_out(plug):
    plug("1-1", idProduct="841b")
    plug("1-2", idVendor="046d")
    plug("1-3", devnum=None)
    plug("1-4", bcdDevice="")
    (plug.folder / "1-0:1.0").mkdir()
    assert find_cameras(plug.folder) == ()
    assert find_cameras(plug.folder / "nothing") == ()


def test_without_names_and_with_an_old_firmware(plug):
    plug("1-1", serial=None, product=None, speed="480", bcdDevice="0205")
    (info,) = find_cameras(plug.folder)
    assert (info.serial, info.product, info.speed_mbit_s, info.firmware) == ("", "DAVIS", 480, 5)
    assert info.reason == "its firmware is version 5, and 6 is the least"


def test_a_newer_firmware_is_no_reason(plug):
    plug("1-1", bcdDevice="0307")
    (info,) = find_cameras(plug.folder)
    assert info.firmware == 7
    assert "firmware" not in info.reason


def test_cameras_come_in_the_order_of_their_ports(plug):
    plug("2-2", serial="b")
    plug("2-1", serial="a")
    plug("1-9", serial="c", busnum="1")
    assert [info.serial for info in find_cameras(plug.folder)] == ["c", "a", "b"]


ONE = CameraInfo(2, 7, "2-1", "00001055", "DAVIS 346", 5000, 6, reason="in use by PID 1")
TWO = CameraInfo(2, 8, "2-2", "00002066", "DAVIS 346", 5000, 6)


@pytest.mark.parametrize("serial", ["00001055", "1055", "01055"])
def test_a_serial_chooses_with_and_without_zeros(serial):
    assert choose_camera((TWO, ONE), serial) is ONE


def test_without_a_serial_the_first_free_one_is_taken():
    assert choose_camera((ONE, TWO)) is TWO
    assert choose_camera((ONE,)) is ONE


@pytest.mark.parametrize("serial", ["7", "0", "10550"])
def test_a_serial_that_is_not_there_is_an_error_that_says_what_is(serial):
    nameless = replace(TWO, serial="")
    with pytest.raises(CameraError, match=f"No camera {serial} is") as caught:
        choose_camera((ONE, nameless), serial)
    assert caught.value.hint == "There is: 00001055, one without a number"


def test_no_camera_at_all():
    with pytest.raises(CameraError, match="No DAVIS camera is plugged in"):
        choose_camera(())
    with pytest.raises(CameraError, match=r"plugged in, so none has the serial number 1055\.$"):
        choose_camera((), "1055")


def test_users_are_named_where_they_can_be_seen():
    assert describe_users((12, 34)) == "PID 12, 34"
    assert describe_users(()) == "another program"

"""The helper's device as the co-pilot's thread meets it; in a real kernel it is tested too."""

import errno
import os
from pathlib import Path

import pytest
from evdev import ecodes

from neurotouch_hid.device import Copilot
from neurotouch_hid.device.inputs import copilot
from neurotouch_hid.device.inputs.nodes import Input
from neurotouch_hid.errors import DeviceError
from tests.waiting import wait_until

LIMIT_S = 60.0
A = ecodes.BTN_SOUTH
PAD = Input(Path("/dev/input/event7"), "Pad", "usb-1", "", 1, 2, 1 << A, 0, 0, 0)


class Socket:
    """What the pad is plugged into, in place of the kernel.

    Attributes:
        goes: the pad is pulled out once it has been taken.
        name: of the pad.
        taken: how often it has been opened.
    """

    def __init__(self) -> None:
        self.plugged = True
        self.goes = False
        self.name = b"Pad"
        self.taken = 0

    def find(self, _wanted: object) -> list[Input]:
        return [PAD] if self.plugged else []

    def open(self, node: Path) -> "VirtualDevice":
        self.taken += 1
        self.name.decode()  # as evdev does
        return VirtualDevice(self, node)


class VirtualDevice:
    """An opened event node on which nothing happens."""

    def __init__(self, socket: Socket, path: Path) -> None:
        self._socket = socket
        self._gone = False
        self.path = path
        self.fd, self._end = os.pipe2(os.O_NONBLOCK)

    def capabilities(self, *, absinfo: bool) -> dict[int, list]:
        return {}

    def grab(self) -> None:
        if self._socket.goes:
            self._gone, self._socket.plugged = True, False

    def active_keys(self) -> list[int]:
        if self._gone:
            raise OSError(errno.ENODEV, "No such device")
        return []

    def close(self) -> None:
        os.close(self.fd)
        os.close(self._end)


@pytest.fixture
def socket(monkeypatch):
    socket = Socket()
    monkeypatch.setattr(copilot, "_SEARCH_S", 0.01)
    monkeypatch.setattr(copilot, "InputDevice", socket.open)
    monkeypatch.setattr(copilot, "find_alike", socket.find)

    def find(wanted: str) -> Input:
        if not socket.plugged:
            raise DeviceError(f"There is no {wanted}.")
        return PAD

    monkeypatch.setattr(copilot, "find_copilot", find)
    return socket


def test_a_pad_that_goes_as_soon_as_it_is_taken_is_taken_when_it_comes_back(socket):
    socket.plugged = False
    helper = Copilot("Pad", wait=True)
    helper.start(lambda share: None)
    try:
        socket.goes = socket.plugged = True
        wait_until(lambda: socket.taken and not socket.plugged)
        socket.goes, socket.plugged = False, True
        wait_until(lambda: helper.describe() == "Pad (/dev/input/event7)")
    finally:
        helper.close()


def test_a_pad_that_goes_as_soon_as_it_is_taken_is_a_device_error_at_the_start(socket):
    socket.goes = True
    with pytest.raises(DeviceError, match="has just been unplugged"):
        Copilot("Pad")


def test_a_pad_whose_name_is_no_text_is_a_device_error_and_another_is_waited_for(socket):
    socket.name = b"Pa\xff"
    with pytest.raises(DeviceError, match="name is not valid text"):
        Copilot("Pad")
    helper = Copilot("Pad", wait=True)
    helper.start(lambda share: None)
    try:
        taken = socket.taken
        wait_until(lambda: socket.taken > taken)
        socket.name = b"Pad"
        wait_until(lambda: helper.describe() == "Pad (/dev/input/event7)")
    finally:
        helper.close()

"""The cable into a virtual machine, with the machine's end in the test's hands.

A real machine is at the other end in ``tests/system/test_sleep.py``.
"""

import socket
import struct

import pytest
from neurotouch_devtools.emulator import CameraConfig, EmulatedCamera, Fault
from neurotouch_devtools.emulator.usbredir import UsbRedir

from tests.emulator.host import make_scene

HELLO, CONNECT, RESET, INTERFACES, ENDPOINTS = 0, 1, 3, 4, 5
SET_CONFIGURATION, CONFIGURATION, SET_SETTING, SETTING = 6, 8, 9, 11
CANCEL, CONTROL, BULK = 21, 100, 101
STREAM = 0x82
STALL, CANCELLED = 4, 1


class Machine:
    """Speaks as QEMU does."""

    def __init__(self, folder):
        self.path = folder / "port"
        self._listening = socket.socket(socket.AF_UNIX)
        self._listening.bind(str(self.path))
        self._listening.listen()
        self._head = struct.Struct("<III")
        self.connection = None

    def greet(self):
        self.connection, _ = self._listening.accept()
        self.connection.settimeout(10.0)
        assert self.hear()[0] == HELLO
        self.say(HELLO, 0, b"machine".ljust(64, b"\0") + struct.pack("<I", 0x7F))
        self._head = struct.Struct("<IIQ")
        return [self.hear() for _ in range(3)]

    def say(self, kind, number, data=b""):
        self.connection.sendall(self._head.pack(kind, len(data), number) + data)

    def hear(self):
        kind, length, number = self._head.unpack(self._read(self._head.size))
        return kind, number, self._read(length)

    def ask(self, number, request_type, request, value, index, length, data=b""):
        head = struct.pack("<BBBBHHH", 0x80, request, request_type, 0, value, index, length)
        self.say(CONTROL, number, head + data)
        kind, answered, answer = self.hear()
        assert (kind, answered) == (CONTROL, number)
        return answer[3], answer[10:]

    def read_stream(self, number, length=512):
        self.say(BULK, number, struct.pack("<BBHIH", STREAM, 0, length, 0, 0))

    def close(self):
        self._listening.close()
        if self.connection is not None:
            self.connection.close()

    def _read(self, n_bytes):
        data = b""
        while len(data) < n_bytes:
            part = self.connection.recv(n_bytes - len(data))
            if not part:
                raise EOFError
            data += part
        return data


@pytest.fixture
def machine(tmp_path):
    machine = Machine(tmp_path)
    yield machine
    machine.close()


def make_camera(*faults):
    return EmulatedCamera(make_scene(), CameraConfig(unpaced=True), faults)


def test_the_machine_hears_what_was_plugged_in(machine):
    with UsbRedir(make_camera(), machine.path):
        (first, _, interfaces), (second, _, endpoints), (third, _, device) = machine.greet()
        assert (first, second, third) == (INTERFACES, ENDPOINTS, CONNECT)
        assert struct.unpack_from("<I", interfaces)[0] == 1
        assert interfaces[4 + 32] == 0xFF  # of its maker's own class
        place = 0x10 | STREAM & 0x0F
        assert endpoints[place] == 2  # bulk
        assert struct.unpack_from("<32H", endpoints, 96)[place] in (512, 1024)
        assert struct.unpack_from("<HH", device, 4) == (0x152A, 0x841A)


def test_requests_are_answered_with_their_numbers(machine):
    with UsbRedir(make_camera(), machine.path):
        machine.greet()
        status, device = machine.ask(7, 0x80, 6, 0x0100, 0, 18)
        assert (status, device[:2], len(device)) == (0, b"\x12\x01", 18)
        assert machine.ask(8, 0x80, 0x55, 0, 0, 4)[0] == STALL
        machine.say(SET_CONFIGURATION, 9, b"\x01")
        assert machine.hear() == (CONFIGURATION, 9, b"\x00\x01")
        machine.say(SET_SETTING, 10, b"\x00\x00")
        assert machine.hear() == (SETTING, 10, b"\x00\x00\x00")


def test_a_transfer_that_waits_can_be_cancelled(machine):
    with UsbRedir(make_camera(), machine.path):
        machine.greet()
        machine.read_stream(3)
        machine.say(CANCEL, 3)
        kind, number, answer = machine.hear()
        assert (kind, number, answer[1]) == (BULK, 3, CANCELLED)


def test_after_a_reset_nobody_hears_of_transfers_before_it(machine):
    with UsbRedir(make_camera(), machine.path):
        machine.greet()
        machine.read_stream(3)
        machine.say(RESET, 0)
        machine.say(CANCEL, 3)
        assert machine.ask(4, 0x80, 8, 0, 0, 1) == (0, b"\x00")


def test_a_pulled_cable_ends_the_connection(machine):
    cable = UsbRedir(make_camera(), machine.path)
    machine.greet()
    cable.close()
    with pytest.raises(EOFError):
        machine.hear()


def test_a_fault_pulls_it_too(machine):
    with UsbRedir(make_camera(Fault.parse("unplug@plugged+2")), machine.path):
        machine.greet()
        with pytest.raises(EOFError):
            machine.ask(1, 0x80, 8, 0, 0, 1)

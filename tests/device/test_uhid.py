"""The events that go to and come from ``/dev/uhid``, with a socket in its place."""

import errno
import os
import socket
import struct
from pathlib import Path

import pytest

from neurotouch_hid.device.outputs import uhid
from neurotouch_hid.device.outputs.identity import load_identities
from neurotouch_hid.device.outputs.uhid import RULE, RULES_FILE, UhidNode, open_uhid
from neurotouch_hid.errors import DeviceError
from neurotouch_hid.messages import Button, GamepadState

OWN = load_identities()["own"]
START = struct.pack("=IQ", 2, 0)
A_DOWN = OWN.layout.encode(GamepadState(0, frozenset({Button.A})))


class FakeKernel:
    """The other end of the socket."""

    def __init__(self):
        self._end, ours = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._end.settimeout(60.0)
        self.descriptor = ours.detach()

    def make(self) -> UhidNode:
        self.send(START)  # it waits in the queue
        return UhidNode(self.descriptor, OWN.make_spec())

    def send(self, event: bytes) -> None:
        self._end.send(event.ljust(4380, b"\0"))

    def take(self) -> bytes:
        return self._end.recv(8192)

    def close(self) -> None:
        self._end.close()


@pytest.fixture
def kernel():
    kernel = FakeKernel()
    yield kernel
    kernel.close()


@pytest.fixture
def pad(kernel):
    pad = kernel.make()
    kernel.take()
    yield pad
    pad.close()


def test_the_event_that_makes_the_pad(kernel):
    pad = kernel.make()
    event = kernel.take()
    assert event[:4] == b"\x0b\0\0\0"
    assert event[4:132].rstrip(b"\0") == b"NeuroTouch Gamepad"
    assert event[132:196].rstrip(b"\0") == b"neurotouch/pad0"
    assert event[196:260].rstrip(b"\0") == b"neurotouch/pad0"
    size, bus, vendor, product, version, country = struct.unpack_from("=HHIIII", event, 260)
    assert (bus, vendor, product, version, country) == (3, 0x1209, 0x4E54, 0x0100, 0)
    assert len(event) == 280 + size == 280 + 114
    pad.close()
    assert kernel.take() == b"\x01\0\0\0"
    with pytest.raises(OSError, match="Bad file descriptor"):
        os.fstat(kernel.descriptor)


def test_the_first_reports_are_repeated_as_a_driver_that_begins_misses_them(kernel, pad):
    pad.write_report(A_DOWN)
    pad.write_report(A_DOWN)
    assert kernel.take() == kernel.take()


def test_one_report_per_change(kernel, monkeypatch):
    monkeypatch.setattr(uhid, "BINDING_S", -1.0)
    pad = kernel.make()
    kernel.take()
    pad.write_report(A_DOWN)
    pad.write_report(A_DOWN)
    pad.write_report(OWN.make_spec().neutral)
    head = struct.pack("=IH", 12, 13)
    assert kernel.take() == head + bytes.fromhex("0000 0000 0000 0000 00 00 00 0100")
    assert kernel.take() == head + bytes(13)
    pad.close()


def test_a_program_that_asks_for_the_report_gets_it(kernel, pad):
    pad.write_report(A_DOWN)
    kernel.take()
    kernel.send(struct.pack("=IIBB", 9, 77, 0, 2))
    report = bytes.fromhex("0000 0000 0000 0000 00 00 00 0100")
    assert kernel.take() == struct.pack("=IIHH", 10, 77, 0, 13) + report


@pytest.mark.parametrize(("number", "kind"), [(0, 0), (5, 0), (0, 1), (1, 2)])
def test_an_unknown_report_is_refused_at_once(kernel, pad, number, kind):
    kernel.send(struct.pack("=IIBB", 9, 78, number, kind))
    assert kernel.take() == struct.pack("=IIHH", 10, 78, errno.EIO, 0)


def test_what_is_set_is_refused_at_once(kernel, pad):
    kernel.send(struct.pack("=IIBBH", 13, 79, 0, 0, 3) + b"abc")
    assert kernel.take() == struct.pack("=IIH", 14, 79, errno.EIO)


def test_what_the_kernel_only_tells_needs_no_answer(kernel, pad):
    for kind in (4, 5, 6, 99):  # OPEN, CLOSE, OUTPUT, and one of the future
        kernel.send(struct.pack("=I", kind))
    kernel.send(struct.pack("=IIBBH", 13, 80, 0, 0, 0))
    assert kernel.take() == struct.pack("=IIH", 14, 80, errno.EIO)


def test_a_pad_that_nobody_drives(kernel):
    with pytest.raises(DeviceError, match="found no driver for the NeuroTouch Gamepad") as caught:
        UhidNode(kernel.descriptor, OWN.make_spec(), patience_s=0.05)
    assert "modprobe hid-generic" in caught.value.hint
    kernel.take()
    assert kernel.take() == b"\x01\0\0\0"


def test_a_pad_that_vanished_is_an_error_and_still_closes(kernel):
    pad = kernel.make()
    kernel.close()
    with pytest.raises(DeviceError, match="no longer takes input for the NeuroTouch Gamepad"):
        pad.write_report(A_DOWN)
    pad.close()


def test_no_node(tmp_path):
    with pytest.raises(DeviceError, match=r"There is no .*uhid here") as caught:
        open_uhid(tmp_path / "uhid")
    assert "modprobe uhid" in caught.value.hint


def test_the_hint_and_the_shipped_rule_agree():
    rules = Path(__file__).parents[2] / "udev" / RULES_FILE
    assert RULE in rules.read_text().splitlines()

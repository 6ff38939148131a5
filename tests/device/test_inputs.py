"""The kernel's list of input devices, and which of our HID pads hidraw has."""

from pathlib import Path

import pytest

from neurotouch_hid.device.inputs.hid_pad_reader import find_hid_pads, read_reports
from neurotouch_hid.device.inputs.nodes import find_inputs, is_input_name, parse_bits
from neurotouch_hid.device.outputs.descriptor import ReportFormat
from neurotouch_hid.device.outputs.identity import load_identities
from neurotouch_hid.errors import DeviceError

DESCRIPTOR = ReportFormat(load_identities()["own"].layout.controls).descriptor


def add(root: Path, number: int, **facts: str) -> None:
    device = root / f"sys/event{number}/device"
    (device / "id").mkdir(parents=True)
    (device / "capabilities").mkdir()
    usual = {"name": "A pad", "phys": "usb-1/input0", "uniq": "", "id/vendor": "0f0d"}
    usual |= {"id/product": "0092", "capabilities/key": "7cdb000000000000 0 0 0 0"}
    usual |= {"capabilities/abs": "3003f", "capabilities/rel": "0", "capabilities/ff": "0"}
    for file, text in {**usual, **facts}.items():
        (device / file).write_text(text + "\n")
    (root / "dev").mkdir(exist_ok=True)
    (root / f"dev/event{number}").touch()


def find(root: Path) -> list:
    return find_inputs(root / "dev", root / "sys")


def test_what_the_kernel_lists(tmp_path):
    add(tmp_path, 10)
    add(tmp_path, 9, name="First\x1b[31m")
    first, second = find(tmp_path)
    assert first.name == "First[31m"  # nothing a terminal would obey
    assert second.node == tmp_path / "dev/event10"
    assert (second.vendor, second.product) == (0x0F0D, 0x0092)
    assert second.keys >> 0x130 & 1
    assert not second.keys >> 0x132 & 1
    assert second.axes == 0x3003F


def test_our_own_devices_do_not_count(tmp_path):
    add(tmp_path, 1, phys="neurotouch/pad0")
    assert find(tmp_path) == []


def test_a_device_that_goes_while_we_look_is_left_out(tmp_path):
    add(tmp_path, 1)
    (tmp_path / "sys/event1/device/id/vendor").unlink()
    assert find(tmp_path) == []


@pytest.mark.parametrize(
    ("text", "bits"), [("0", 0), ("1 0", 1 << 64), ("b", 11), ("1 8000000000000001", 3 << 63 | 1)]
)
def test_bitmaps_of_the_kernel(text, bits):
    assert parse_bits(text) == bits


@pytest.mark.parametrize(
    ("name", "known"),
    [("KEY_SPACE", True), ("BTN_SOUTH", True), ("ABS_X", False), ("KEY_NOPE", False)],
)
def test_names_of_keys(name, known):
    assert is_input_name(name) is known


def add_hid(root: Path, number: int, descriptor: bytes) -> None:
    device = root / f"sys/hidraw{number}/device"
    device.mkdir(parents=True)
    (device / "report_descriptor").write_bytes(descriptor)
    (device / "uevent").write_text(
        "DRIVER=hid-generic\nHID_ID=0003:00001209:00004E54\nHID_NAME=NeuroTouch Gamepad\n"
        "HID_PHYS=neurotouch/pad0\nHID_UNIQ=neurotouch/pad0\n"
    )


def test_our_hid_pads_are_found_by_their_descriptor(tmp_path):
    add_hid(tmp_path, 0, b"\x05\x01\x09\x06")
    add_hid(tmp_path, 1, DESCRIPTOR)
    (pad,) = find_hid_pads(tmp_path / "dev", tmp_path / "sys")
    assert (pad.name, pad.place, pad.ids) == (
        "NeuroTouch Gamepad",
        "neurotouch/pad0",
        "0003:1209:4E54",
    )
    with pytest.raises(DeviceError, match="no right to read") as caught:
        read_reports(pad)  # it is not there, so nobody may read it
    assert 'KERNELS=="0003:1209:4E54.*"' in caught.value.hint


def test_the_shipped_rule_is_for_our_ids():
    rules = (Path(__file__).parents[2] / "udev/70-neurotouch-hid.rules").read_text()
    own = load_identities()["own"]
    assert f'KERNELS=="0003:{own.vendor:04X}:{own.product:04X}.*"' in rules

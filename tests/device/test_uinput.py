"""The bytes and calls that reach ``/dev/uinput``, with a pipe in its place."""

import contextlib
import errno
import os
import stat
from pathlib import Path
from unittest.mock import Mock

import pytest
from evdev import ecodes

from neurotouch_hid.device.outputs import keyboard, mouse, uinput
from neurotouch_hid.device.outputs.identity import load_identities
from neurotouch_hid.device.outputs.spec import DeviceSpec
from neurotouch_hid.device.outputs.uinput import RULE, UinputNode, open_uinput
from neurotouch_hid.errors import DeviceError
from tests.device.kernel import FakeNode, Kernel

PAD = load_identities()["xbox360"].make_spec()
PHYS, SETUP, ABS_SETUP = 0x4008556C, 0x405C5503, 0x401C5504
EVBIT, KEYBIT, RELBIT, CREATE, DESTROY = 0x40045564, 0x40045565, 0x40045566, 0x5501, 0x5502


def event(type_: int, code: int, value: int) -> str:
    """An input event as 64-bit Linux lays it out, stamp 0, in hexadecimal."""
    words = type_.to_bytes(2, "little") + code.to_bytes(2, "little")
    return "00" * 16 + words.hex() + value.to_bytes(4, "little", signed=True).hex()


SYN = event(0, 0, 0)


@pytest.fixture
def kernel():
    kernel = Kernel()
    yield kernel
    kernel.close()


def make(kernel: Kernel, spec: DeviceSpec) -> tuple[UinputNode, FakeNode]:
    node = UinputNode(kernel.open(), spec, ioctl=kernel.ioctl)
    return node, kernel.nodes[-1]


def report(spec: DeviceSpec, **values: int) -> tuple[int, ...]:
    """The report in which these codes, named by the kernel, have these values."""
    wanted = {ecodes.ecodes[name]: value for name, value in values.items()}
    return tuple(wanted.get(control.code, 0) for control in spec.controls)


def test_the_calls_that_make_the_pad(kernel):
    _, pad = make(kernel, PAD)
    keys = [0x130, 0x131, 0x133, 0x134, 0x136, 0x137, 0x13A, 0x13B, 0x13C, 0x13D, 0x13E]
    stick = "00000000" + "0080ffff" + "ff7f0000" + "00000000" * 3
    trigger = "00000000" + "00000000" + "ff000000" + "00000000" * 3
    hat = "00000000" + "ffffffff" + "01000000" + "00000000" * 3
    axes = {0: stick, 1: stick, 2: trigger, 3: stick, 4: stick, 5: trigger, 16: hat, 17: hat}
    name = b"Microsoft X-Box 360 pad".ljust(80, b"\0")
    assert [call for call in pad.calls if call[0] != ABS_SETUP] == [
        (EVBIT, 1),  # EV_KEY
        (EVBIT, 3),  # EV_ABS; no EV_FF
        *((KEYBIT, key) for key in keys),
        (PHYS, b"neurotouch/pad0\0"),
        (SETUP, bytes.fromhex("03005e048e021001") + name + bytes(4)),
        (CREATE, 0),
    ]
    setups = [argument for request, argument in pad.calls if request == ABS_SETUP]
    assert sorted(setups) == sorted(
        code.to_bytes(2, "little") + bytes(2) + bytes.fromhex(rest) for code, rest in axes.items()
    )
    assert pad.calls[-1] == (CREATE, 0)
    assert pad.take() == ""


def test_the_calls_that_make_the_mouse(kernel):
    _, node = make(kernel, mouse.SPEC)
    name = b"NeuroTouch Mouse".ljust(80, b"\0")
    assert node.calls == [
        (EVBIT, 1),
        *((KEYBIT, button) for button in (0x110, 0x111, 0x112, 0x113, 0x114)),
        (EVBIT, 2),  # EV_REL
        *((RELBIT, code) for code in (0, 1, 8, 6, 11, 12)),
        (PHYS, b"neurotouch/mouse0\0"),
        (SETUP, bytes.fromhex("0600000002000100") + name + bytes(4)),
        (CREATE, 0),
    ]


def test_the_calls_that_make_the_keyboard(kernel):
    _, node = make(kernel, keyboard.SPEC)
    name = b"NeuroTouch Keyboard".ljust(80, b"\0")
    assert [call for call in node.calls if call[0] != KEYBIT] == [
        (EVBIT, 1),  # no EV_REP, no EV_LED
        (PHYS, b"neurotouch/keyboard0\0"),
        (SETUP, bytes.fromhex("0600000001000100") + name + bytes(4)),
        (CREATE, 0),
    ]
    keys = {argument for request, argument in node.calls if request == KEYBIT}
    assert keys == {control.code for control in keyboard.KEYS.values()}


def test_one_packed_frame_per_change(kernel):
    pad, seen = make(kernel, PAD)
    pad.write_report(report(PAD, BTN_SOUTH=1, ABS_X=32767))
    assert seen.take() == event(1, 0x130, 1) + event(3, 0, 32767) + SYN
    pad.write_report(report(PAD, BTN_SOUTH=1, ABS_X=-32767))
    assert seen.take() == event(3, 0, -32767) + SYN
    pad.write_report(report(PAD, BTN_SOUTH=1, ABS_X=-32767))
    assert seen.take() == ""
    pad.write_report(PAD.neutral)
    assert seen.take() == event(3, 0, 0) + event(1, 0x130, 0) + SYN


def test_steps_come_first_then_releases_backwards_then_presses(kernel):
    node, seen = make(kernel, mouse.SPEC)
    node.write_report(report(mouse.SPEC, BTN_LEFT=1, BTN_RIGHT=1))
    assert seen.take() == event(1, 0x110, 1) + event(1, 0x111, 1) + SYN
    node.write_report(report(mouse.SPEC, BTN_MIDDLE=1), ((0, -3), (11, 7)))
    rel, released = event(2, 0, -3) + event(2, 11, 7), event(1, 0x111, 0) + event(1, 0x110, 0)
    assert seen.take() == rel + released + event(1, 0x112, 1) + SYN
    node.write_report(report(mouse.SPEC, BTN_MIDDLE=1), ((1, 5),))
    assert seen.take() == event(2, 1, 5) + SYN


def test_a_report_has_its_time(kernel):
    pad, seen = make(kernel, PAD)
    pad.write_report(report(PAD, BTN_SOUTH=1), stamp_ns=8_000_000_000_999)
    seen.take()
    assert seen.stamps == [(8_000, 0)] * 2
    pad.write_report(report(PAD), stamp_ns=8_000_999_999_999)
    seen.take()
    assert seen.stamps == [(8_000, 999_999)] * 2


def test_the_number_of_a_call_has_its_size():
    assert uinput._write_request(4, 28) == ABS_SETUP
    assert uinput._write_request(3, 92) == SETUP
    assert uinput._write_request(108, 8) == PHYS


def test_the_rumble_ends_before_the_node_is_gone(kernel, monkeypatch):
    server = Mock()
    monkeypatch.setattr(uinput, "RumbleServer", server)
    spec = load_identities()["xbox360"].make_spec(rumbles=True)
    node = UinputNode(kernel.open(), spec, ioctl=kernel.ioctl, hear=print)
    server.return_value.close.side_effect = lambda: kernel.nodes[-1].calls.append("rumble ends")
    node.close()
    assert kernel.nodes[-1].calls[-2:] == ["rumble ends", (DESTROY, 0)]


def test_closing_removes_the_node(kernel):
    pad, seen = make(kernel, PAD)
    pad.close()
    assert seen.calls[-1] == (DESTROY, 0)
    assert seen.is_closed


def test_a_refused_node_leaves_nothing_open(kernel):
    kernel.refused = (1, CREATE)
    refusal = r"refuses to create the NeuroTouch Mouse: Invalid argument"
    with pytest.raises(DeviceError, match=refusal):
        make(kernel, mouse.SPEC)
    assert kernel.nodes[0].is_closed


def test_a_node_that_vanished_is_an_error_each_time_and_still_closes(kernel):
    pad, seen = make(kernel, PAD)
    seen.vanish()
    for _ in range(2):
        with pytest.raises(DeviceError, match="no longer takes input for the Microsoft"):
            pad.write_report(report(PAD, BTN_SOUTH=1))
    kernel.refused = (1, DESTROY)
    pad.close()
    assert seen.is_closed


def test_what_a_full_kernel_refused_is_sent_later_but_not_the_steps(kernel):
    node, seen = make(kernel, mouse.SPEC)
    os.set_blocking(seen.writing, False)
    with contextlib.suppress(BlockingIOError):
        while True:
            os.write(seen.writing, bytes(4096))
    with pytest.raises(DeviceError, match="no longer takes input"):
        node.write_report(report(mouse.SPEC, BTN_LEFT=1), ((0, 900),))
    while seen.take():
        pass
    node.write_report(report(mouse.SPEC, BTN_LEFT=1), ((0, 1),))
    assert seen.take() == event(2, 0, 1) + event(1, 0x110, 1) + SYN


def test_no_node(tmp_path):
    with pytest.raises(DeviceError, match=r"There is no .*uinput here") as caught:
        open_uinput(tmp_path / "uinput")
    assert "modprobe uinput" in caught.value.hint


@pytest.fixture
def dead_node(tmp_path):
    """A character device with nothing behind it."""
    node = tmp_path / "uinput"
    try:
        os.mknod(node, stat.S_IFCHR | 0o600, os.makedev(10, 223))
        os.close(os.open(node, os.O_WRONLY))
    except PermissionError:
        pytest.skip("device nodes cannot be made or opened here: needs root")
    except OSError as error:
        if error.errno not in (errno.ENODEV, errno.ENXIO):
            raise
        return node
    pytest.skip("this kernel has uinput; the real-kernel tests unload it")


def test_a_node_without_its_module(dead_node):
    with pytest.raises(DeviceError, match="module behind it is missing") as caught:
        open_uinput(dead_node)
    assert "modprobe uinput" in caught.value.hint


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everything")
def test_no_right(tmp_path):
    node = tmp_path / "uinput"
    node.touch(mode=0o400)
    with pytest.raises(DeviceError, match=r"no right to write to .*mode is 0400") as caught:
        open_uinput(node)
    assert RULE in caught.value.hint


def test_anything_else_is_said_plainly(tmp_path):
    with pytest.raises(DeviceError, match="cannot be opened: Is a directory"):
        open_uinput(tmp_path)


def test_the_hint_and_the_shipped_rule_agree():
    root = Path(__file__).parents[2]
    assert RULE in (root / "udev/70-neurotouch-uinput.rules").read_text().splitlines()

"""The bytes and calls that reach ``/dev/uinput``, with a pipe in its place."""

import contextlib
import errno
import os
import stat
import threading
from pathlib import Path

import pytest

from neurotouch_hid.device.uinput import RULE, UinputDevice, open_uinput
from neurotouch_hid.errors import DeviceError
from neurotouch_hid.messages import Axis, Button, GamepadState

SYN = "00000000000000000000000000000000" + "0000" + "0000" + "00000000"
KEY_A_DOWN = "00000000000000000000000000000000" + "0100" + "3001" + "01000000"
KEY_A_UP = "00000000000000000000000000000000" + "0100" + "3001" + "00000000"
LEFT_X_FULL = "00000000000000000000000000000000" + "0300" + "0000" + "ff7f0000"
LEFT_X_LEFT = "00000000000000000000000000000000" + "0300" + "0000" + "0180ffff"
LEFT_X_REST = "00000000000000000000000000000000" + "0300" + "0000" + "00000000"


class Kernel:
    """A pipe in the place of /dev/uinput, and the ioctls that were made on it."""

    def __init__(self):
        self.reading, self.writing = os.pipe()
        os.set_blocking(self.reading, False)
        self.calls: list[tuple[int, int | bytes]] = []
        self.refused: int | None = None

    def ioctl(self, descriptor: int, request: int, argument: int | bytes) -> None:
        assert descriptor == self.writing
        if request == self.refused:
            raise OSError(errno.EINVAL, os.strerror(errno.EINVAL))
        self.calls.append((request, argument))

    def open(self) -> UinputDevice:
        return UinputDevice(self.writing, ioctl=self.ioctl)

    def take(self) -> str:
        """What was written since the last look, in hexadecimal."""
        try:
            return os.read(self.reading, 1 << 16).hex()
        except BlockingIOError:
            return ""

    @property
    def is_closed(self) -> bool:
        try:
            os.fstat(self.writing)
        except OSError:
            return True
        return False


@pytest.fixture
def kernel():
    kernel = Kernel()
    yield kernel
    os.close(kernel.reading)
    if not kernel.is_closed:
        os.close(kernel.writing)


def test_the_calls_that_make_the_pad(kernel):
    kernel.open()
    keys = [0x130, 0x131, 0x133, 0x134, 0x136, 0x137, 0x13A, 0x13B, 0x13C, 0x13D, 0x13E]
    stick = "00000000" + "0080ffff" + "ff7f0000" + "00000000" * 3
    trigger = "00000000" + "00000000" + "ff000000" + "00000000" * 3
    hat = "00000000" + "ffffffff" + "01000000" + "00000000" * 3
    axes = {0: stick, 1: stick, 2: trigger, 3: stick, 4: stick, 5: trigger, 16: hat, 17: hat}
    name = b"Microsoft X-Box 360 pad".ljust(80, b"\0")
    assert [(request, argument) for request, argument in kernel.calls if request != 0x401C5504] == [
        (0x40045564, 1),  # UI_SET_EVBIT EV_KEY
        *((0x40045565, key) for key in keys),
        (0x40045564, 3),  # UI_SET_EVBIT EV_ABS; no EV_FF
        (0x4008556C, b"neurotouch/pad0\0"),
        (0x405C5503, bytes.fromhex("03005e048e021001") + name + bytes(4)),
        (0x5501, 0),  # UI_DEV_CREATE
    ]
    setups = [argument for request, argument in kernel.calls if request == 0x401C5504]
    assert sorted(setups) == sorted(
        code.to_bytes(2, "little") + bytes(2) + bytes.fromhex(rest) for code, rest in axes.items()
    )
    assert kernel.calls[-1] == (0x5501, 0)
    assert kernel.take() == ""


def test_one_packed_write_per_change(kernel):
    pad = kernel.open()
    pad.write(GamepadState(1, frozenset({Button.A}), {Axis.LEFT_X: 1.0}))
    assert kernel.take() == KEY_A_DOWN + LEFT_X_FULL + SYN
    pad.write(GamepadState(2, frozenset({Button.A}), {Axis.LEFT_X: -1.0}))
    assert kernel.take() == LEFT_X_LEFT + SYN
    pad.write(GamepadState(3))
    assert kernel.take() == KEY_A_UP + LEFT_X_REST + SYN


def test_no_write_when_nothing_changes(kernel):
    pad = kernel.open()
    pad.write(GamepadState(1))
    pad.neutral()
    assert kernel.take() == ""
    pad.write(GamepadState(2, axes={Axis.LEFT_X: 1.0}))
    kernel.take()
    pad.write(GamepadState(3, axes={Axis.LEFT_X: 1.0}))
    pad.write(GamepadState(4, axes={Axis.LEFT_X: 7.0, Axis.LEFT_Y: 1e-6}))
    assert kernel.take() == ""


def test_neutral_releases_what_is_held(kernel):
    pad = kernel.open()
    pad.write(GamepadState(1, frozenset({Button.A})))
    kernel.take()
    pad.neutral()
    assert kernel.take() == KEY_A_UP + SYN
    pad.write(GamepadState(2, frozenset({Button.A})))
    assert kernel.take() == KEY_A_DOWN + SYN


def test_close_releases_destroys_and_closes(kernel):
    with kernel.open() as pad:
        pad.write(GamepadState(1, frozenset({Button.A})))
        kernel.take()
    assert kernel.take() == KEY_A_UP + SYN
    assert kernel.calls[-1] == (0x5502, 0)
    assert kernel.is_closed
    pad.close()
    pad.neutral()
    with pytest.raises(DeviceError, match="already closed"):
        pad.write(GamepadState(2))


def test_a_refused_pad_leaves_nothing_open(kernel):
    kernel.refused = 0x5501
    with pytest.raises(DeviceError, match=r"refuses to create .*Invalid argument"):
        kernel.open()
    assert kernel.is_closed


def test_a_pad_that_vanished_is_an_error_and_still_closes(kernel):
    pad = kernel.open()
    os.close(kernel.reading)
    try:
        with pytest.raises(DeviceError, match="no longer takes input"):
            pad.write(GamepadState(1, frozenset({Button.A})))
        with pytest.raises(DeviceError, match="no longer takes input"):
            pad.write(GamepadState(1, frozenset({Button.A})))
        pad.close()
        assert kernel.is_closed
    finally:
        kernel.reading = os.open(os.devnull, os.O_RDONLY)


def test_what_a_full_kernel_refused_is_sent_later(kernel):
    pad = kernel.open()
    os.set_blocking(kernel.writing, False)
    with contextlib.suppress(BlockingIOError):
        while True:
            os.write(kernel.writing, bytes(4096))
    with pytest.raises(DeviceError, match="no longer takes input"):
        pad.write(GamepadState(1, frozenset({Button.A})))
    while kernel.take():
        pass
    pad.write(GamepadState(2, frozenset({Button.A})))
    assert kernel.take() == KEY_A_DOWN + SYN


def test_frames_of_two_threads_do_not_mix(kernel):
    """A writer and a watchdog at once: every frame in the pipe is whole and really a change."""
    pad = kernel.open()
    frames = []
    done = threading.Event()

    def press():
        for t_us in range(2_000):
            pad.write(GamepadState(t_us, frozenset({Button.A}), {Axis.LEFT_X: 1.0}))
        done.set()

    def release():
        while not done.is_set():
            pad.neutral()

    def collect():
        while not done.is_set() or frames[-1:] != [""]:
            frames.append(kernel.take())

    threads = [threading.Thread(target=work) for work in (press, release, collect)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    written = "".join(frames)
    down, up = KEY_A_DOWN + LEFT_X_FULL + SYN, KEY_A_UP + LEFT_X_REST + SYN
    assert written.startswith(down)
    assert written.removesuffix(down).replace(down + up, "") == ""


def test_no_node(tmp_path):
    with pytest.raises(DeviceError, match=r"There is no .*uinput here") as caught:
        open_uinput(tmp_path / "uinput")
    assert "modprobe uinput" in caught.value.hint
    assert "--device" in caught.value.hint


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

"""Pad, keyboard and mouse as one: which nodes there are, and in which order they are written."""

import threading

import pytest

from neurotouch_hid.device import CompositeDevice, ExtraDevice
from neurotouch_hid.errors import DeviceError
from neurotouch_hid.messages import Axis, Button, GamepadState
from tests.device.kernel import Kernel
from tests.device.test_uinput import CREATE, DESTROY, SYN, event

KEYBOARD, MOUSE = ExtraDevice.KEYBOARD, ExtraDevice.MOUSE
PAD_NAME = "Microsoft X-Box 360 pad"
CTRL_C = frozenset({"KEY_C", "KEY_LEFTCTRL"})
LEFT = frozenset({"BTN_LEFT"})
EVERYTHING = GamepadState(0, frozenset({Button.A}), {Axis.LEFT_X: 1.0}, CTRL_C, LEFT)
A_DOWN, A_UP = event(1, 0x130, 1), event(1, 0x130, 0)
LEFT_X_FULL, LEFT_X_REST = event(3, 0, 32767), event(3, 0, 0)
CTRL_C_DOWN = event(1, 29, 1) + event(1, 46, 1)
CTRL_C_UP = event(1, 46, 0) + event(1, 29, 0)
LEFT_DOWN, LEFT_UP = event(1, 0x110, 1), event(1, 0x110, 0)


@pytest.fixture
def kernel():
    kernel = Kernel()
    yield kernel
    kernel.close()


def make(kernel: Kernel, *extra_devices: ExtraDevice) -> CompositeDevice:
    return CompositeDevice(extra_devices, open_descriptor=kernel.open, ioctl=kernel.ioctl)


def take(kernel: Kernel) -> list[str]:
    return [node.take() for node in kernel.nodes]


def test_without_companions_there_is_only_the_pad(kernel):
    device = make(kernel)
    device.write(GamepadState(0, frozenset({Button.A})))
    device.write(GamepadState(10_000))
    device.neutral()
    assert [node.name for node in kernel.nodes] == [PAD_NAME]
    assert device.name == PAD_NAME


@pytest.mark.parametrize(
    ("extra_devices", "names"),
    [
        ([KEYBOARD], [PAD_NAME, "NeuroTouch Keyboard"]),
        ([MOUSE], [PAD_NAME, "NeuroTouch Mouse"]),
        ([KEYBOARD, MOUSE], [PAD_NAME, "NeuroTouch Keyboard", "NeuroTouch Mouse"]),
    ],
)
def test_companions_are_made_at_once_and_only_once(kernel, extra_devices, names):
    device = make(kernel, *extra_devices)
    device.prepare(extra_devices)
    assert [node.name for node in kernel.nodes] == names
    assert device.name == " + ".join(names)
    assert all(node.calls[-1] == (CREATE, 0) for node in kernel.nodes)


def test_a_profile_that_comes_later_gets_what_it_needs(kernel):
    device = make(kernel, MOUSE)
    device.prepare([KEYBOARD])
    device.prepare([])
    assert [node.name for node in kernel.nodes[1:]] == ["NeuroTouch Mouse", "NeuroTouch Keyboard"]


@pytest.mark.parametrize(
    ("state", "name"),
    [
        (GamepadState(0, keys=CTRL_C), "NeuroTouch Keyboard"),
        (GamepadState(0, mouse_buttons=LEFT), "NeuroTouch Mouse"),
        (GamepadState(0, pointer=(0.0, -1.0)), "NeuroTouch Mouse"),
        (GamepadState(0, wheel=1.0), "NeuroTouch Mouse"),
    ],
)
def test_what_nobody_prepared_is_made_for_the_state_that_needs_it(kernel, state, name):
    make(kernel).write(state)
    assert [node.name for node in kernel.nodes] == [PAD_NAME, name]


def test_each_node_gets_its_part_in_one_frame(kernel):
    device = make(kernel, KEYBOARD, MOUSE)
    device.write(EVERYTHING)
    pressed = [A_DOWN + LEFT_X_FULL + SYN, CTRL_C_DOWN + SYN, LEFT_DOWN + SYN]
    assert take(kernel) == pressed
    device.write(EVERYTHING)
    assert take(kernel) == ["", "", ""]
    device.neutral()
    released = [LEFT_X_REST + A_UP + SYN, CTRL_C_UP + SYN, LEFT_UP + SYN]
    assert take(kernel) == released
    device.neutral()
    assert take(kernel) == ["", "", ""]
    device.write(EVERYTHING)
    assert take(kernel) == pressed


def test_only_the_node_that_changes_is_written(kernel):
    device = make(kernel, KEYBOARD, MOUSE)
    device.write(GamepadState(0, keys=CTRL_C))
    assert take(kernel) == ["", CTRL_C_DOWN + SYN, ""]
    device.write(GamepadState(10_000, keys=CTRL_C, pointer=(500.0, 0.0)))
    assert take(kernel) == ["", "", event(2, 0, 5) + SYN]


def test_the_pointer_does_not_leap_after_a_neutral(kernel):
    device = make(kernel, MOUSE)
    device.write(GamepadState(0, pointer=(500.0, 0.0)))
    device.neutral()
    device.write(GamepadState(40_000, pointer=(500.0, 0.0)))
    assert take(kernel)[1] == ""
    device.write(GamepadState(50_000, pointer=(500.0, 0.0)))
    assert take(kernel)[1] == event(2, 0, 5) + SYN


def test_a_ctrl_click_is_one_from_its_begin_to_its_end(kernel, monkeypatch):
    """Ctrl goes down before the button and comes up after it, although they are two nodes."""
    device = make(kernel, KEYBOARD, MOUSE)
    written = []
    with monkeypatch.context() as patch:
        names = {node.writing: node.name for node in kernel.nodes}
        patch.setattr("os.write", lambda descriptor, _: written.append(names[descriptor]))
        device.write(GamepadState(0, keys=frozenset({"KEY_LEFTCTRL"}), mouse_buttons=LEFT))
        device.write(GamepadState(10_000))
    down, up = (
        ["NeuroTouch Keyboard", "NeuroTouch Mouse"],
        ["NeuroTouch Mouse", "NeuroTouch Keyboard"],
    )
    assert written == down + up


def test_closing_releases_all_then_removes_all_the_pad_last(kernel):
    with make(kernel, KEYBOARD, MOUSE) as device:
        device.write(EVERYTHING)
        take(kernel)
    assert take(kernel) == [LEFT_X_REST + A_UP + SYN, CTRL_C_UP + SYN, LEFT_UP + SYN]
    for node in kernel.nodes:
        assert node.calls[-1] == (DESTROY, 0)
        assert node.is_closed
    device.close()
    device.neutral()
    with pytest.raises(DeviceError, match="already closed"):
        device.write(GamepadState(1))
    with pytest.raises(DeviceError, match="already closed"):
        device.prepare([MOUSE])


def test_a_refused_companion_takes_the_pad_away_again(kernel):
    kernel.refused = (2, CREATE)
    with pytest.raises(DeviceError, match="refuses to create the NeuroTouch Keyboard"):
        make(kernel, KEYBOARD)
    assert [node.is_closed for node in kernel.nodes] == [True, True]
    assert kernel.nodes[0].calls[-1] == (DESTROY, 0)


@pytest.mark.parametrize("lost", [0, 1, 2])
def test_a_lost_node_does_not_keep_the_others_pressed(kernel, lost):
    device = make(kernel, KEYBOARD, MOUSE)
    device.write(EVERYTHING)
    take(kernel)
    kernel.nodes[lost].vanish()
    with pytest.raises(DeviceError, match="no longer takes input"):
        device.neutral()
    released = [LEFT_X_REST + A_UP + SYN, CTRL_C_UP + SYN, LEFT_UP + SYN]
    assert take(kernel) == [*released[:lost], "", *released[lost + 1 :]]
    device.close()
    assert all(node.is_closed for node in kernel.nodes)


def test_frames_of_two_threads_do_not_mix(kernel):
    """A writer and a watchdog at once: every frame in the pipe is whole and really a change."""
    pad = make(kernel)
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
            frames.append(kernel.nodes[0].take())

    threads = [threading.Thread(target=work) for work in (press, release, collect)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    written = "".join(frames)
    down, up = A_DOWN + LEFT_X_FULL + SYN, LEFT_X_REST + A_UP + SYN
    assert written.startswith(down)
    assert written.removesuffix(down).replace(down + up, "") == ""

"""The pad that remembers, and the way to get a device by its name."""

import math

import pytest

from neurotouch_hid.device import MemoryDevice, open_device
from neurotouch_hid.errors import DeviceError
from neurotouch_hid.messages import Axis, Button, GamepadState


def test_only_changes_are_kept():
    device = MemoryDevice()
    pressed = GamepadState(20, frozenset({Button.A}))
    device.write(GamepadState(10))
    device.write(pressed)
    device.write(GamepadState(30, frozenset({Button.A}), {Axis.LEFT_X: 1e-9}))
    device.write(GamepadState(40, frozenset({Button.A}), {Axis.LEFT_X: math.nan}))
    released = GamepadState(50)
    device.write(released)
    assert list(device.states) == [pressed, released]


def test_neutral_releases_at_the_last_moment():
    device = MemoryDevice()
    device.neutral()
    device.write(GamepadState(20, axes={Axis.LEFT_X: 0.5}))
    device.write(GamepadState(30, axes={Axis.LEFT_X: 0.5}))
    device.neutral()
    device.neutral()
    assert [state.t_us for state in device.states] == [20, 30]
    assert device.states[-1].is_neutral


def test_close_releases_and_ends_it():
    with MemoryDevice() as device:
        device.write(GamepadState(20, frozenset({Button.X})))
    assert device.states[-1] == GamepadState(20)
    device.close()
    device.neutral()
    assert len(device.states) == 2
    with pytest.raises(DeviceError, match="already closed"):
        device.write(GamepadState(30))


def test_a_long_dry_run_does_not_grow():
    device = MemoryDevice()
    for t_us in range(25_000):
        device.write(GamepadState(t_us, axes={Axis.LEFT_X: t_us % 2}))
    assert len(device.states) == 10_000
    assert device.states[-1].t_us == 24_999


def test_devices_are_opened_by_name():
    assert isinstance(open_device("memory"), MemoryDevice)
    with pytest.raises(DeviceError, match="'joystick'") as caught:
        open_device("joystick")
    assert caught.value.hint == "Use uinput or memory."

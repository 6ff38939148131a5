"""The device that remembers, and the way to get a device by its name."""

import math

import pytest

from neurotouch_hid.device import ExtraDevice, MemoryDevice, open_device
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


@pytest.mark.parametrize(
    "state",
    [
        GamepadState(20, keys=frozenset({"KEY_A"})),
        GamepadState(20, mouse_buttons=frozenset({"BTN_LEFT"})),
    ],
)
def test_keys_and_mouse_buttons_are_kept(state):
    device = MemoryDevice()
    device.write(GamepadState(10))
    device.write(state)
    device.write(state)
    device.neutral()
    assert list(device.states) == [state, GamepadState(20)]


def test_the_mouse_moving_and_stopping_is_kept_and_the_way_is_summed():
    device = MemoryDevice()
    moving = [
        GamepadState(t_us, pointer=(60.0, -200.0), wheel=12.0) for t_us in range(0, 100_001, 10_000)
    ]
    for state in moving:
        device.write(state)
    device.write(GamepadState(110_000, pointer=(1.0, 0.0)))
    stopped = GamepadState(120_000)
    device.write(stopped)
    device.write(GamepadState(130_000))
    assert list(device.states) == [*moving, stopped]
    assert device.travel == {0: 6, 1: -20, 8: 1, 11: 144}


def test_the_way_to_a_neutral_does_not_count():
    device = MemoryDevice()
    device.write(GamepadState(0, pointer=(100.0, 0.0)))
    device.neutral()
    device.write(GamepadState(40_000, pointer=(100.0, 0.0)))
    assert not device.travel


def test_it_knows_what_would_stand_beside_the_pad():
    device = MemoryDevice()
    device.write(GamepadState(10, frozenset({Button.A})))
    assert device.extra_devices == set()
    device.prepare([ExtraDevice.KEYBOARD])
    assert device.extra_devices == {ExtraDevice.KEYBOARD}
    device.write(GamepadState(20, wheel=1.0))
    assert device.extra_devices == {ExtraDevice.KEYBOARD, ExtraDevice.MOUSE}


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
    for t_us in range(2_500):
        device.write(GamepadState(t_us, axes={Axis.LEFT_X: t_us % 2}))
    assert len(device.states) == 1_000
    assert device.states[-1].t_us == 2_499


def test_devices_are_opened_by_name():
    device = open_device("memory", [ExtraDevice.MOUSE])
    assert isinstance(device, MemoryDevice)
    assert device.extra_devices == {ExtraDevice.MOUSE}
    with pytest.raises(DeviceError, match="'joystick'") as caught:
        open_device("joystick")
    assert caught.value.hint == "Use uinput, hid or memory."

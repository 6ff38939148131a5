"""The gel's side of a shared pad; the helper's is tested in a real kernel."""

from dataclasses import replace

import pytest

from neurotouch_hid.device import ExtraDevice, MemoryDevice, MergedDevice
from neurotouch_hid.device.inputs import merged_device
from neurotouch_hid.device.inputs.contribution import Contribution
from neurotouch_hid.messages import Axis, Button, GamepadState

PRESS = GamepadState(10_000, frozenset({Button.A}), {Axis.LEFT_X: 0.5}, pointer=(100.0, 0.0))


def test_without_a_helper_the_gel_plays_alone():
    memory = MemoryDevice()
    with MergedDevice(memory, yield_to_mouse_s=0.0) as pad:
        assert pad.name == "memory"
        assert pad.helper_buttons == frozenset()
        pad.prepare([ExtraDevice.KEYBOARD])
        pad.write(PRESS)
        pad.neutral()
        assert memory.states[-1].is_neutral
    assert [state.buttons for state in memory.states] == [{Button.A}, frozenset()]
    assert memory.states[0] == PRESS
    assert memory.extra_devices == {ExtraDevice.KEYBOARD, ExtraDevice.MOUSE}
    assert pad.describe_mouse() == "nothing moves the pointer"


def test_closing_closes_what_it_is_shown_on():
    memory = MemoryDevice()
    pad = MergedDevice(memory)
    pad.write(PRESS)
    pad.close()
    pad.close()
    assert memory.states[-1].is_neutral


class Helper:
    """A helper's device, whose state a test sets."""

    is_closed = False

    def start(self, hear):
        self.hold = hear

    def close(self):
        self.is_closed = True


@pytest.mark.parametrize(
    "share",
    [
        Contribution(frozenset({Button.B})),
        Contribution(axes={Axis.RIGHT_X: -1.0}),
        Contribution(frozenset({Button.B}), {Axis.RIGHT_X: -1.0}),
    ],
)
def test_a_fault_of_the_gel_releases_the_gel_although_the_helper_holds_something(share):
    memory, helper = MemoryDevice(), Helper()
    with MergedDevice(memory, helper) as pad:
        pad.write(PRESS)
        helper.hold(share)
        assert memory.states[-1].buttons == {Button.A, *share.buttons}
        pad.neutral()
        assert memory.states[-1].buttons == share.buttons
        assert {a: v for a, v in memory.states[-1].axes.items() if v} == share.axes
        helper.hold(Contribution())
        assert memory.states[-1].is_neutral


def test_a_helper_plays_before_the_gel_does():
    memory, helper = MemoryDevice(), Helper()
    with MergedDevice(memory, helper) as pad:
        helper.hold(Contribution(frozenset({Button.B})))
        assert list(memory.states) == [GamepadState(0, frozenset({Button.B}))]
        assert pad.helper_buttons == {Button.B}
    assert helper.is_closed


class Mice:
    """The watch over the real mice, whose last motion a test sets."""

    def __init__(self):
        self.quiet_s = 1e9
        self.is_closed = False

    def close(self):
        self.is_closed = True


@pytest.fixture
def watches(monkeypatch):
    """Every watch that has been made."""
    made = []

    def make():
        made.append(Mice())
        return made[-1]

    monkeypatch.setattr(merged_device, "MouseWatch", make)
    return made


def test_the_pointer_rests_until_the_mouse_has_been_quiet_for_long_enough(watches):
    memory = MemoryDevice()
    with MergedDevice(memory, yield_to_mouse_s=1.5) as pad:
        pad.prepare([ExtraDevice.MOUSE])
        pad.prepare([ExtraDevice.MOUSE])
        (mice,) = watches
        mice.quiet_s = 1.4
        pad.write(replace(PRESS, wheel=1.0))
        assert memory.states[-1] == replace(PRESS, pointer=(0.0, 0.0))
        mice.quiet_s = 1.5
        pad.write(PRESS)
        assert memory.states[-1] == PRESS
        assert not mice.is_closed
    assert mice.is_closed


@pytest.mark.parametrize(
    ("extra_device", "yield_s"), [(ExtraDevice.KEYBOARD, 1.5), (ExtraDevice.MOUSE, 0.0)]
)
def test_no_mouse_is_read_for_nothing(watches, extra_device, yield_s):
    with MergedDevice(MemoryDevice(), yield_to_mouse_s=yield_s) as pad:
        pad.prepare([extra_device])
    assert watches == []

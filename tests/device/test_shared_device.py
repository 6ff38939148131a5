"""The gel's side of a shared pad; the helper's is tested in a real kernel."""

import pytest

from neurotouch_hid.device import ExtraDevice, MemoryDevice, SharedDevice
from neurotouch_hid.device.inputs.contribution import Contribution
from neurotouch_hid.messages import Axis, Button, GamepadState

PRESS = GamepadState(10_000, frozenset({Button.A}), {Axis.LEFT_X: 0.5}, pointer=(100.0, 0.0))


def test_without_a_helper_the_gel_plays_alone():
    memory = MemoryDevice()
    with SharedDevice(memory, yield_to_mouse_s=0.0) as pad:
        assert pad.name == "memory"
        assert pad.helper_buttons == frozenset()
        pad.prepare([ExtraDevice.MOUSE])
        pad.write(PRESS)
        pad.neutral()
    assert [state.buttons for state in memory.states] == [{Button.A}, frozenset()]
    assert memory.states[0] == PRESS
    assert memory.extra_devices == {ExtraDevice.MOUSE}
    assert pad.describe_mouse() == "nothing moves the pointer"


def test_closing_closes_what_it_is_shown_on():
    memory = MemoryDevice()
    pad = SharedDevice(memory)
    pad.write(PRESS)
    pad.close()
    pad.close()
    assert memory.states[-1].is_neutral


class Helper:
    """A helper's device, whose state a test sets."""

    def start(self, hear):
        self.hold = hear

    def close(self):
        pass


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
    with SharedDevice(memory, helper) as pad:
        pad.write(PRESS)
        helper.hold(share)
        assert memory.states[-1].buttons == {Button.A, *share.buttons}
        pad.neutral()
        assert memory.states[-1].buttons == share.buttons
        assert {a: v for a, v in memory.states[-1].axes.items() if v} == share.axes
        helper.hold(Contribution())
        assert memory.states[-1].is_neutral

"""One virtual pad for two: the gel and a helper on a physical device."""

from collections.abc import Iterable
from contextlib import suppress
from dataclasses import replace
from threading import Lock

from neurotouch_hid.closing import Closing
from neurotouch_hid.device.device import Device
from neurotouch_hid.device.inputs.contribution import Contribution, Priority, merge
from neurotouch_hid.device.inputs.copilot import Copilot
from neurotouch_hid.device.inputs.mouse_watch import MouseWatch
from neurotouch_hid.device.outputs.spec import ExtraDevice
from neurotouch_hid.errors import DeviceError
from neurotouch_hid.messages import Button, GamepadState

YIELD_TO_MOUSE_S = 1.5
"""Time without mouse motion after which the gel moves the pointer again."""


class MergedDevice(Closing):
    """Writes the merged state of gel and co-pilot to a device; the pointer yields to the mouse.

    ``neutral`` releases only the contribution of the gel: the helper may be steering meanwhile.
    Unplugging the helper's device releases only the helper's contribution.

    Args:
        device: receives the merged state; closed with this one.
        copilot: the helper's device, if there is one; closed with this one.
        priority: the hand that decides about a stick or trigger that both move; ``equal``: the
            hand that moves it further.
        yield_to_mouse_s: time without motion of the real mouse after which our pointer moves; 0:
            it never waits.
    """

    def __init__(
        self,
        device: Device,
        copilot: Copilot | None = None,
        *,
        priority: Priority = "equal",
        yield_to_mouse_s: float = YIELD_TO_MOUSE_S,
    ) -> None:
        self._device = device
        self._copilot = copilot
        self._priority = priority
        self._yield_s = yield_to_mouse_s
        self._mice: MouseWatch | None = None
        self._gel = GamepadState(0)
        self._helper = Contribution()
        self._lock = Lock()
        if copilot is not None:
            copilot.start(self._take)

    @property
    def name(self) -> str:
        """The name that the user sees."""
        return self._device.name

    @property
    def helper_buttons(self) -> frozenset[Button]:
        """The buttons that the helper presses now."""
        return self._helper.buttons

    def describe_mouse(self) -> str:
        """Returns whether the pointer yields to the mouse."""
        return "nothing moves the pointer" if self._mice is None else self._mice.describe()

    def prepare(self, extra_devices: Iterable[ExtraDevice]) -> None:
        """Creates the extra devices that are still missing.

        Raises:
            DeviceError: they cannot be made.
        """
        extra_devices = frozenset(extra_devices)
        self._device.prepare(extra_devices)
        if ExtraDevice.MOUSE in extra_devices and self._yield_s and self._mice is None:
            self._mice = MouseWatch()

    def write(self, state: GamepadState) -> None:
        """Writes this state of the gel, merged with the helper's contribution.

        Raises:
            DeviceError: the state cannot be written.
        """
        with self._lock:
            self._gel = self._yield_to_mouse(state)
            self._device.write(self._unite())

    def neutral(self) -> None:
        """Releases the gel's contribution; the helper's stays.

        Raises:
            DeviceError: the kernel does not take it.
        """
        with self._lock:
            self._gel = GamepadState(self._gel.t_us)
            if self._helper.buttons or self._helper.axes:
                self._device.write(self._unite())
            else:
                self._device.neutral()

    def close(self) -> None:
        """Releases the helper's device and all buttons, and removes the pad."""
        if self._copilot is not None:  # its thread may wait for the lock
            self._copilot.close()
        if self._mice is not None:
            self._mice.close()
        with self._lock:
            self._device.close()

    def _take(self, share: Contribution) -> None:
        """Writes a change by the helper, in the co-pilot's thread."""
        with self._lock, suppress(DeviceError):  # the pipeline's next write reports it
            self._helper = share
            self._device.write(self._unite())

    def _unite(self) -> GamepadState:
        if not (self._helper.buttons or self._helper.axes):
            return self._gel
        both = merge(Contribution(self._gel.buttons, self._gel.axes), self._helper, self._priority)
        return replace(self._gel, buttons=both.buttons, axes=both.axes)

    def _yield_to_mouse(self, state: GamepadState) -> GamepadState:
        mice = self._mice
        if mice is None or mice.quiet_s >= self._yield_s:
            return state
        return replace(state, pointer=(0.0, 0.0), wheel=0.0)

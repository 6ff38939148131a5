"""The pad with its keyboard and mouse as one device, written with one state."""

import time
from collections.abc import Callable, Iterable
from dataclasses import replace
from threading import Lock

from neurotouch_hid.closing import Closing
from neurotouch_hid.device.outputs import keyboard, mouse
from neurotouch_hid.device.outputs.clock import SensorClock
from neurotouch_hid.device.outputs.identity import Identity, PadKind, load_identities
from neurotouch_hid.device.outputs.rumble import HearRumble
from neurotouch_hid.device.outputs.spec import ExtraDevice, Steps, VirtualDevice, find_needed
from neurotouch_hid.device.outputs.uhid import UhidNode, open_uhid
from neurotouch_hid.device.outputs.uinput import Ioctl, UinputNode, call_kernel, open_uinput
from neurotouch_hid.errors import DeviceError
from neurotouch_hid.messages import GamepadState

_EXTRA_SPECS = {ExtraDevice.KEYBOARD: keyboard.SPEC, ExtraDevice.MOUSE: mouse.SPEC}

_PARTING_S = 0.05
"""Time for readers to take the last frame: they lose unread events when a node is removed."""


class CompositeDevice(Closing):
    """One to three nodes of the kernel that act as one device.

    The pad is always there: games look for it when they start, and one that comes later takes
    another place among the players. Keyboard and mouse come with the first profile that uses them,
    and stay to the end.

    One lock guards all nodes, so that a watchdog's thread may call ``neutral`` while the pipeline
    writes.
    """

    def __init__(
        self,
        extra_devices: Iterable[ExtraDevice] = (),
        *,
        kind: PadKind = "uinput",
        identity: Identity | None = None,
        player: int = 1,
        hear_rumble: HearRumble | None = None,
        open_descriptor: Callable[[], int] = open_uinput,
        ioctl: Ioctl = call_kernel,
    ) -> None:
        """Creates the nodes, at rest.

        Args:
            extra_devices: the devices to create beside the pad.
            kind: ``uinput`` or ``hid`` for the pad; the others always use ``/dev/uinput``.
            identity: the controller model to emulate; if None, an Xbox 360 pad.
            player: number of the player, from 1; it is part of the physical path of the nodes.
            hear_rumble: called when games shake the pad; if None, the pad does not offer rumble.
            open_descriptor: gives ``/dev/uinput``, opened for each node; a service manager may
                have opened it.
            ioctl: the system call; tests record it.

        Raises:
            DeviceError: ``/dev/uinput`` or ``/dev/uhid`` cannot be used, or the kernel refuses a
                node.
        """
        self._open_descriptor = open_descriptor
        self._ioctl = ioctl
        self._player = player
        self._identity = identity or load_identities()["xbox360"]
        self._layout = self._identity.layout
        self._clock = SensorClock()
        self._pad = self._make_pad(kind, hear_rumble)
        self._extra_devices: dict[ExtraDevice, UinputNode] = {}
        self._motion = mouse.PointerMotion()
        self._mouse_buttons: frozenset[str] = frozenset()
        self._closed = False
        self._lock = Lock()
        try:
            self.prepare(extra_devices)
        except DeviceError:
            self.close()
            raise

    @property
    def name(self) -> str:
        """The name that the user sees: the nodes, as other programs show them."""
        names = (spec.name for key, spec in _EXTRA_SPECS.items() if key in self._extra_devices)
        return " + ".join((self._identity.name, *names))

    def prepare(self, extra_devices: Iterable[ExtraDevice]) -> None:
        """Creates the nodes that are still missing.

        A desktop takes a moment to notice a node and misses everything written before. So the
        driver calls this when it loads a profile, not at the first press.

        Raises:
            DeviceError: the device is closed, ``/dev/uinput`` cannot be used, or the kernel
                refuses a node.
        """
        with self._lock:
            self._require_open()
            self._add(extra_devices)

    def write(self, state: GamepadState) -> None:
        """Writes this state: one write for each node on which something changed.

        A node that the state needs and that is still missing is created.

        Raises:
            DeviceError: the kernel refuses it, or the device is closed.
        """
        with self._lock:
            self._require_open()
            self._add(find_needed(state))
            self._show(state, self._motion.compute_steps(state), self._clock.stamp(state.t_us))

    def neutral(self) -> None:
        """Releases everything on all nodes now, even if one of them fails.

        Raises:
            DeviceError: the kernel refuses it.
        """
        with self._lock:
            if not self._closed:
                self._release()

    def close(self) -> None:
        """Releases everything and removes the nodes, the pad last."""
        with self._lock:
            if self._closed:
                return
            self._closed = True
            try:
                self._release()
            except DeviceError:
                pass  # a node is gone already, which has released its keys
            finally:
                time.sleep(_PARTING_S)
                for node in (*self._extra_devices.values(), self._pad):
                    node.close()

    def _make_pad(self, kind: PadKind, hear: HearRumble | None) -> VirtualDevice:
        if kind == "hid":  # Linux has no simple rumble for pads of no known maker
            return UhidNode(open_uhid(), self._identity.make_spec(self._player))
        spec = self._identity.make_spec(self._player, rumbles=hear is not None)
        return UinputNode(self._open_descriptor(), spec, ioctl=self._ioctl, hear=hear)

    def _make_extra_device(self, extra_device: ExtraDevice) -> UinputNode:
        spec = replace(
            _EXTRA_SPECS[extra_device], phys=f"neurotouch/{extra_device}{self._player - 1}"
        )
        return UinputNode(self._open_descriptor(), spec, ioctl=self._ioctl)

    def _require_open(self) -> None:
        if self._closed:
            raise DeviceError("The virtual gamepad is already closed.")

    def _add(self, extra_devices: Iterable[ExtraDevice]) -> None:
        for extra_device in extra_devices:
            if extra_device not in self._extra_devices:
                self._extra_devices[extra_device] = self._make_extra_device(extra_device)

    def _release(self) -> None:
        self._motion = mouse.PointerMotion()  # the time until the next state does not count
        self._show(GamepadState(0), (), self._clock.now())

    def _show(self, state: GamepadState, steps: Steps, stamp_ns: int) -> None:
        """Writes to every node, even if one fails; raises the first failure."""
        reports: list[tuple[VirtualDevice | None, tuple[int, ...], Steps]] = [
            (self._pad, self._layout.encode(state), ()),
            (self._extra_devices.get(ExtraDevice.KEYBOARD), keyboard.encode_keys(state), ()),
            (self._extra_devices.get(ExtraDevice.MOUSE), mouse.encode_buttons(state), steps),
        ]
        if self._mouse_buttons - state.mouse_buttons:
            # The button comes up before ctrl: otherwise a ctrl+click would end as a plain click.
            reports.reverse()
        self._mouse_buttons = state.mouse_buttons
        failures = []
        for node, report, motion in reports:
            if node is not None:
                try:
                    node.write_report(report, motion, stamp_ns)
                except DeviceError as error:
                    failures.append(error)
        if failures:
            raise failures[0]

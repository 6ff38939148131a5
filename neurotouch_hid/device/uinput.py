"""A gamepad made by the Linux kernel through ``/dev/uinput``.

Own ioctls instead of evdev's ``UInput``: that one cannot use a descriptor handed over by systemd,
wants to read the new event node (and waits 2 s when it may not), writes every event by itself, and
can leave a ghost pad behind when its constructor fails.
"""

import errno
import fcntl
import os
import struct
import time
from collections.abc import Callable
from pathlib import Path
from threading import Lock
from types import TracebackType
from typing import Self

from evdev import ecodes

from neurotouch_hid.device import gamepad
from neurotouch_hid.errors import DeviceError
from neurotouch_hid.messages import GamepadState

NODE = Path("/dev/uinput")

RULE = 'KERNEL=="uinput", SUBSYSTEM=="misc", TAG+="uaccess", OPTIONS+="static_node=uinput"'
"""The udev rule of ``udev/70-neurotouch-uinput.rules``."""

_PARTING_S = 0.05
"""Time for readers to take the last frame: what is unread when a pad goes away is lost to them."""

# linux/uinput.h and linux/input.h
_INPUT_EVENT = struct.Struct("@llHHi")  # seconds, microseconds, type, code, value
_SETUP = struct.Struct("@HHHH80sI")  # bus, vendor, product, version, name, ff_effects_max
_ABS_SETUP = struct.Struct("@H2x6i")  # code, value, minimum, maximum, fuzz, flat, resolution


def _write_request(number: int, size: int) -> int:
    """Return the number of an ioctl that hands ``size`` bytes to uinput: ``_IOW('U', …)``."""
    return 1 << 30 | size << 16 | ord("U") << 8 | number


UI_DEV_CREATE = ord("U") << 8 | 1
UI_DEV_DESTROY = ord("U") << 8 | 2
UI_DEV_SETUP = _write_request(3, _SETUP.size)
UI_ABS_SETUP = _write_request(4, _ABS_SETUP.size)
UI_SET_EVBIT = _write_request(100, struct.calcsize("@i"))
UI_SET_KEYBIT = _write_request(101, struct.calcsize("@i"))
UI_SET_PHYS = _write_request(108, struct.calcsize("@P"))

Ioctl = Callable[[int, int, int | bytes], None]


def _ioctl(descriptor: int, request: int, argument: int | bytes) -> None:
    """Make the system call; uinput takes numbers by value and structures by their bytes."""
    fcntl.ioctl(descriptor, request, argument)


def open_uinput(node: Path = NODE) -> int:
    """Return an open descriptor of the node.

    Raises:
        DeviceError: there is no node, no module behind it, or no right to use it.
    """
    try:
        return os.open(node, os.O_WRONLY | os.O_CLOEXEC)
    except OSError as error:
        raise _explain_opening(node, error) from error


class UinputDevice:
    """The pad of ``gamepad.py`` as a device of the kernel, visible to all programs at once.

    If the process dies, the kernel releases the pressed keys and removes the pad. One lock guards
    the descriptor, so that a watchdog's thread may call ``neutral`` while the line writes.

    No force feedback is declared: a pad that declares it and does not answer freezes games for
    half a minute.

    Attributes:
        name: what the user is told it is, and what games show.
    """

    name = gamepad.NAME

    def __init__(self, descriptor: int, *, ioctl: Ioctl = _ioctl) -> None:
        """Create the pad, at rest.

        Args:
            descriptor: ``/dev/uinput`` opened for writing, by ``open_uinput`` or by the service
                manager. The device owns it from here on, also when this call fails.
            ioctl: the system call; tests record it.

        Raises:
            DeviceError: the kernel refuses the pad.
        """
        self._descriptor: int | None = descriptor
        self._ioctl = ioctl
        self._report = gamepad.NEUTRAL
        self._lock = Lock()
        try:
            self._create(descriptor)
        except OSError as error:
            os.close(descriptor)
            raise DeviceError(
                f"The kernel refuses to create the virtual gamepad: {error.strerror}."
            ) from error

    def write(self, state: GamepadState) -> None:
        """Show the pad in this state: one write with all that changed, none if nothing did.

        A failure means that the pad is gone, so it is not hidden by a new pad, which games would
        take for another player's: the program ends, and the service manager starts it again. A
        caller that goes on all the same loses nothing, the next call sends what is still unsent.

        Raises:
            DeviceError: the kernel does not take it, or the device is closed.
        """
        with self._lock:
            if self._descriptor is None:
                raise DeviceError("The virtual gamepad is already closed.")
            self._show(self._descriptor, gamepad.encode(state))

    def neutral(self) -> None:
        """Release everything now.

        Raises:
            DeviceError: the kernel does not take it.
        """
        with self._lock:
            if self._descriptor is not None:
                self._show(self._descriptor, gamepad.NEUTRAL)

    def close(self) -> None:
        """Release everything and remove the pad."""
        with self._lock:
            if self._descriptor is None:
                return
            descriptor, self._descriptor = self._descriptor, None
            try:
                self._show(descriptor, gamepad.NEUTRAL)
                time.sleep(_PARTING_S)
                self._ioctl(descriptor, UI_DEV_DESTROY, 0)
            except (DeviceError, OSError):
                # The pad is gone already. Closing the descriptor below removes whatever is left,
                # and releases its keys.
                pass
            finally:
                os.close(descriptor)

    def __enter__(self) -> Self:
        """Return the device itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Close the device."""
        self.close()

    def _create(self, descriptor: int) -> None:
        self._ioctl(descriptor, UI_SET_EVBIT, ecodes.EV_KEY)
        for key in gamepad.BUTTONS.values():
            self._ioctl(descriptor, UI_SET_KEYBIT, key.code)
        self._ioctl(descriptor, UI_SET_EVBIT, ecodes.EV_ABS)
        for axis in gamepad.AXES.values():
            # Value, fuzz, flat and resolution are 0. Fuzz as the real pad declares it would keep
            # a released stick off its centre.
            setup = _ABS_SETUP.pack(axis.code, 0, axis.minimum, axis.maximum, 0, 0, 0)
            self._ioctl(descriptor, UI_ABS_SETUP, setup)
        self._ioctl(descriptor, UI_SET_PHYS, gamepad.PHYS.encode() + b"\0")
        identity = (gamepad.BUS, gamepad.VENDOR, gamepad.PRODUCT, gamepad.VERSION)
        self._ioctl(descriptor, UI_DEV_SETUP, _SETUP.pack(*identity, gamepad.NAME.encode(), 0))
        self._ioctl(descriptor, UI_DEV_CREATE, 0)

    def _show(self, descriptor: int, report: tuple[int, ...]) -> None:
        """Write the controls that differ from the last report, and the end of the frame."""
        changes = [
            # A stamp of 0 lets the kernel take its own time.
            _INPUT_EVENT.pack(0, 0, control.type, control.code, value)
            for control, old, value in zip(gamepad.CONTROLS, self._report, report, strict=True)
            if value != old
        ]
        if not changes:
            return
        changes.append(_INPUT_EVENT.pack(0, 0, ecodes.EV_SYN, ecodes.SYN_REPORT, 0))
        frame = b"".join(changes)
        try:
            os.write(descriptor, frame)
        except OSError as error:
            raise DeviceError(
                f"The kernel no longer takes input for the virtual gamepad: {error.strerror}.",
                hint="Start the program again; it will make a new pad.",
            ) from error
        self._report = report


def _explain_opening(node: Path, error: OSError) -> DeviceError:
    """Say which of the three usual reasons it is, and the way out."""
    if error.errno == errno.ENOENT:
        return DeviceError(
            f"There is no {node} here, so no virtual gamepad can be made.",
            hint="Load the module: sudo modprobe uinput. "
            f"In a container, hand the host's node in: --device {node}.",
        )
    if error.errno in (errno.ENODEV, errno.ENXIO):
        return DeviceError(
            f"{node} exists, but the kernel module behind it is missing.",
            hint="Load it: sudo modprobe uinput. If it is not found, this kernel was built "
            "without it: install your distribution's package of extra kernel modules.",
        )
    if error.errno in (errno.EACCES, errno.EPERM):
        mode = node.stat().st_mode & 0o777
        return DeviceError(
            f"You have no right to write to {node} (its mode is {mode:04o}).",
            hint="Allow it for whoever sits at the machine:\n"
            f"  echo '{RULE}' | sudo tee /etc/udev/rules.d/70-neurotouch-uinput.rules\n"
            "  sudo udevadm control --reload && sudo udevadm trigger --name-match=uinput\n"
            "In a container the host must grant the device as well.",
        )
    return DeviceError(f"{node} cannot be opened: {error.strerror}.")

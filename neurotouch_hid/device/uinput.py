"""Nodes made by the Linux kernel through ``/dev/uinput``.

Own ioctls instead of evdev's ``UInput``: that one cannot use a descriptor handed over by systemd,
wants to read the new event node (and waits 2 s when it may not), writes every event by itself, and
can leave a ghost pad behind when its constructor fails.
"""

import errno
import fcntl
import os
import struct
from collections.abc import Callable
from pathlib import Path

from evdev import ecodes

from neurotouch_hid.device.claim import Claim, Steps
from neurotouch_hid.errors import DeviceError

NODE = Path("/dev/uinput")

RULE = 'KERNEL=="uinput", SUBSYSTEM=="misc", TAG+="uaccess", OPTIONS+="static_node=uinput"'
"""The udev rule of ``udev/70-neurotouch-uinput.rules``."""

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
UI_SET_RELBIT = _write_request(102, struct.calcsize("@i"))
UI_SET_PHYS = _write_request(108, struct.calcsize("@P"))

Ioctl = Callable[[int, int, int | bytes], None]


def call_kernel(descriptor: int, request: int, argument: int | bytes) -> None:
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


class UinputNode:
    """One device of the kernel, visible to all programs at once; at rest when it is made.

    If the process dies, the kernel releases the pressed keys and removes the node. The caller sees
    to it that two threads do not write at once.

    No force feedback is declared: a pad that declares it and does not answer freezes games for
    half a minute.
    """

    def __init__(self, descriptor: int, claim: Claim, *, ioctl: Ioctl = call_kernel) -> None:
        """Create the node.

        Args:
            descriptor: ``/dev/uinput`` opened for writing, by ``open_uinput`` or by the service
                manager. The node owns it from here on, also when this call fails.
            claim: what it claims to be.
            ioctl: the system call; tests record it.

        Raises:
            DeviceError: the kernel refuses it.
        """
        self._descriptor = descriptor
        self._claim = claim
        self._ioctl = ioctl
        self._report = claim.neutral
        try:
            self._create()
        except OSError as error:
            os.close(descriptor)
            raise DeviceError(
                f"The kernel refuses to create the {claim.name}: {error.strerror}."
            ) from error

    def show(self, report: tuple[int, ...], steps: Steps = ()) -> None:
        """Write one frame with all that changed, in one write; nothing if nothing did.

        Steps come first, so that a click is where the pointer then is. What is released comes
        before what is pressed, and in the opposite order: the letter of a chord before its ctrl.

        A failure means that the node is gone, so it is not hidden by a new one, which games would
        take for another player's: the program ends, and the service manager starts it again. A
        caller that goes on all the same loses no press or release, the next call sends what is
        still unsent.

        Args:
            report: the value of every control of the claim, in its order.
            steps: how far the claim's motions go now, as (code, steps).

        Raises:
            DeviceError: the kernel does not take it.
        """
        changes = [
            (control.type, control.code, value)
            for control, old, value in zip(self._claim.controls, self._report, report, strict=True)
            if value != old
        ]
        frame = [
            *((ecodes.EV_REL, code, n_steps) for code, n_steps in steps),
            *(change for change in reversed(changes) if change[2] == 0),
            *(change for change in changes if change[2] != 0),
        ]
        if not frame:
            return
        frame.append((ecodes.EV_SYN, ecodes.SYN_REPORT, 0))
        try:
            # Stamps of 0 let the kernel take its own time.
            os.write(self._descriptor, b"".join(_INPUT_EVENT.pack(0, 0, *event) for event in frame))
        except OSError as error:
            raise DeviceError(
                f"The kernel no longer takes input for the {self._claim.name}: {error.strerror}.",
                hint="Start the program again; it will make a new one.",
            ) from error
        self._report = report

    def close(self) -> None:
        """Remove the node."""
        try:
            self._ioctl(self._descriptor, UI_DEV_DESTROY, 0)
        except OSError:
            pass  # it is gone already; closing the descriptor removes whatever is left
        finally:
            os.close(self._descriptor)

    def _create(self) -> None:
        for type_ in sorted({control.type for control in self._claim.controls}):
            self._set(UI_SET_EVBIT, type_)
        for control in self._claim.controls:
            if control.type == ecodes.EV_KEY:
                self._set(UI_SET_KEYBIT, control.code)
            else:
                # Value, fuzz, flat and resolution are 0. Fuzz as the real pad declares it would
                # keep a released stick off its centre.
                range_ = (control.minimum, control.maximum)
                self._set(UI_ABS_SETUP, _ABS_SETUP.pack(control.code, 0, *range_, 0, 0, 0))
        if self._claim.motions:
            self._set(UI_SET_EVBIT, ecodes.EV_REL)
        for motion in self._claim.motions:
            self._set(UI_SET_RELBIT, motion)
        self._set(UI_SET_PHYS, self._claim.phys.encode() + b"\0")
        self._set(UI_DEV_SETUP, _SETUP.pack(*self._claim.ids, self._claim.name.encode(), 0))
        self._set(UI_DEV_CREATE, 0)

    def _set(self, request: int, argument: int | bytes) -> None:
        self._ioctl(self._descriptor, request, argument)


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

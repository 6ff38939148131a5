"""Virtual devices that the Linux kernel makes through ``/dev/uinput``.

Own ioctls instead of evdev's ``UInput``: that one cannot use a descriptor handed over by systemd,
wants to read the new event node (and waits 2 s when it may not), writes every event by itself, and
can leave a ghost pad behind when its constructor fails.
"""

import fcntl
import os
import struct
from collections.abc import Callable
from pathlib import Path

from evdev import ecodes

from neurotouch_hid.device.outputs.opening import DeviceNode
from neurotouch_hid.device.outputs.rumble import EFFECT_CODES, N_EFFECTS, HearRumble, RumbleServer
from neurotouch_hid.device.outputs.spec import DeviceSpec, Steps
from neurotouch_hid.errors import DeviceError

NODE = Path("/dev/uinput")

RULE = 'KERNEL=="uinput", SUBSYSTEM=="misc", TAG+="uaccess", OPTIONS+="static_node=uinput"'
"""The udev rule of ``udev/70-neurotouch-uinput.rules``."""

_MAKER = DeviceNode(NODE, "uinput", RULE, "70-neurotouch-uinput.rules")

# linux/uinput.h and linux/input.h
_INPUT_EVENT = struct.Struct("@llHHi")  # seconds, microseconds, type, code, value
_SETUP = struct.Struct("@HHHH80sI")  # bus, vendor, product, version, name, ff_effects_max
_ABS_SETUP = struct.Struct("@H2x6i")  # code, value, minimum, maximum, fuzz, flat, resolution


def _write_request(number: int, size: int) -> int:
    """Returns the number of an ioctl that hands ``size`` bytes to uinput: ``_IOW('U', …)``."""
    return 1 << 30 | size << 16 | ord("U") << 8 | number


UI_DEV_CREATE = ord("U") << 8 | 1
UI_DEV_DESTROY = ord("U") << 8 | 2
UI_DEV_SETUP = _write_request(3, _SETUP.size)
UI_ABS_SETUP = _write_request(4, _ABS_SETUP.size)
UI_SET_EVBIT = _write_request(100, struct.calcsize("@i"))
UI_SET_KEYBIT = _write_request(101, struct.calcsize("@i"))
UI_SET_RELBIT = _write_request(102, struct.calcsize("@i"))
UI_SET_FFBIT = _write_request(107, struct.calcsize("@i"))
UI_SET_PHYS = _write_request(108, struct.calcsize("@P"))

Ioctl = Callable[[int, int, int | bytes], None]


def call_kernel(descriptor: int, request: int, argument: int | bytes) -> None:
    """Makes the system call; uinput takes numbers by value and structures by their bytes."""
    fcntl.ioctl(descriptor, request, argument)


def open_uinput(node: Path = NODE) -> int:
    """Returns an open descriptor of the node.

    Raises:
        DeviceError: there is no node, no module behind it, or no right to use it.
    """
    return _MAKER.open(node)


class UinputNode:
    """One device of the kernel, visible to all programs at once; at rest when it is made.

    If the process dies, the kernel releases the pressed keys and removes the node. The caller must
    make sure that two threads do not write at the same time.

    Force feedback is declared only with ``hear``: a pad that declares it and does not answer
    freezes games for a minute.
    """

    def __init__(
        self,
        descriptor: int,
        spec: DeviceSpec,
        *,
        ioctl: Ioctl = call_kernel,
        hear: HearRumble | None = None,
    ) -> None:
        """Creates the node.

        Args:
            descriptor: ``/dev/uinput`` opened by ``open_uinput`` or by the service manager, for
                writing, and for reading too if it rumbles. From now on the node owns it, even if
                this call fails.
            spec: description of the device.
            ioctl: the system call; tests record it.
            hear: called when games shake it; needed if it rumbles.

        Raises:
            DeviceError: the kernel refuses it.
        """
        self._descriptor = descriptor
        self._spec = spec
        self._ioctl = ioctl
        self._report = spec.neutral
        # It must run before games can see the pad.
        self._rumble = RumbleServer(descriptor, hear) if spec.rumbles and hear else None
        try:
            self._create()
        except OSError as error:
            self._end_rumble()
            os.close(descriptor)
            raise DeviceError(
                f"The kernel refuses to create the {spec.name}: {error.strerror}."
            ) from error

    def write_report(self, report: tuple[int, ...], steps: Steps = (), stamp_ns: int = 0) -> None:
        """Writes all changes as one frame, in one write; nothing if nothing changed.

        Steps come first, so that a click happens at the new place of the pointer. Releases come
        before presses, and in the opposite order: the letter of a chord before its ctrl.

        A failure means that the node is gone. A new node would not hide that: games would take it
        for another player. So the program ends, and the service manager starts it again. A caller
        that continues loses no press or release: the next call sends everything still unsent.

        Args:
            report: the value of every control of the description, in its order.
            steps: the motions, as (code, steps).
            stamp_ns: time of the report on CLOCK_MONOTONIC; 0 lets the kernel take its own time,
                which kernels before 6.8 always do.

        Raises:
            DeviceError: the kernel refuses it.
        """
        if report == self._report and not steps:
            return
        changes = [
            (control.type, control.code, value)
            for control, old, value in zip(self._spec.controls, self._report, report, strict=True)
            if value != old
        ]
        frame = [
            *((ecodes.EV_REL, code, n_steps) for code, n_steps in steps),
            *(change for change in reversed(changes) if change[2] == 0),
            *(change for change in changes if change[2] != 0),
        ]
        frame.append((ecodes.EV_SYN, ecodes.SYN_REPORT, 0))
        try:
            at = stamp_ns // 1_000_000_000, stamp_ns // 1_000 % 1_000_000
            os.write(self._descriptor, b"".join(_INPUT_EVENT.pack(*at, *event) for event in frame))
        except OSError as error:
            raise DeviceError(
                f"The kernel no longer takes input for the {self._spec.name}: {error.strerror}.",
                hint="Start the program again; it will make a new one.",
            ) from error
        self._report = report

    def close(self) -> None:
        """Removes the node."""
        self._end_rumble()
        try:
            self._ioctl(self._descriptor, UI_DEV_DESTROY, 0)
        except OSError:
            pass  # it is gone already; closing the descriptor removes the rest
        finally:
            os.close(self._descriptor)

    def _create(self) -> None:
        for type_ in sorted({control.type for control in self._spec.controls}):
            self._set(UI_SET_EVBIT, type_)
        if self._rumble is not None:
            self._set(UI_SET_EVBIT, ecodes.EV_FF)
            for code in EFFECT_CODES:
                self._set(UI_SET_FFBIT, code)
        for control in self._spec.controls:
            if control.type == ecodes.EV_KEY:
                self._set(UI_SET_KEYBIT, control.code)
            else:
                # Fuzz, flat and resolution are 0. Fuzz as the real pad declares it would keep a
                # released stick off its centre.
                range_ = (control.rest, control.minimum, control.maximum)
                self._set(UI_ABS_SETUP, _ABS_SETUP.pack(control.code, *range_, 0, 0, 0))
        if self._spec.motions:
            self._set(UI_SET_EVBIT, ecodes.EV_REL)
        for motion in self._spec.motions:
            self._set(UI_SET_RELBIT, motion)
        self._set(UI_SET_PHYS, self._spec.phys.encode() + b"\0")
        n_effects = N_EFFECTS if self._rumble is not None else 0
        self._set(UI_DEV_SETUP, _SETUP.pack(*self._spec.ids, self._spec.name.encode(), n_effects))
        self._set(UI_DEV_CREATE, 0)

    def _end_rumble(self) -> None:
        if self._rumble is not None:
            self._rumble.close()

    def _set(self, request: int, argument: int | bytes) -> None:
        self._ioctl(self._descriptor, request, argument)

"""A HID gamepad through ``/dev/uhid``: event node, joystick node and hidraw node.

The kernel treats it as it treats a pad on a cable: its own HID driver reads our reports by our
descriptor, and other programs can read the same reports through hidraw (hidapi).
"""

import os
import select
import struct
import threading
import time
from contextlib import suppress
from errno import EIO
from pathlib import Path
from typing import Final

from neurotouch_hid.device.outputs.descriptor import ReportFormat
from neurotouch_hid.device.outputs.opening import DeviceNode
from neurotouch_hid.device.outputs.spec import DeviceSpec, Steps
from neurotouch_hid.errors import DeviceError

NODE: Final = Path("/dev/uhid")

RULE: Final = 'KERNEL=="uhid", SUBSYSTEM=="misc", TAG+="uaccess", OPTIONS+="static_node=uhid"'
RULES_FILE: Final = "70-neurotouch-hid.rules"
"""Name of the rule's file in ``udev``."""

_MAKER: Final = DeviceNode(NODE, "uhid", RULE, RULES_FILE)

# linux/uhid.h: every event begins with its type.
_DESTROY, _START, _GET_REPORT, _GET_REPORT_REPLY = 1, 2, 9, 10
_CREATE2, _INPUT2, _SET_REPORT, _SET_REPORT_REPLY = 11, 12, 13, 14
_LARGEST: Final = 4380
_TYPE: Final = struct.Struct("=I")
_CREATE: Final = struct.Struct("=I128s64s64sHHIIII")  # then the descriptor
_INPUT: Final = struct.Struct("=IH")  # type, size; then the report
_REQUEST: Final = struct.Struct("=IIBB")  # type, id, number and kind of the report
_GET_REPLY: Final = struct.Struct("=IIHH")  # type, id, error, size; then the report
_SET_REPLY: Final = struct.Struct("=IIH")  # type, id, error
_INPUT_REPORT: Final = 2

START_S: Final = 10.0
"""Time for the kernel to find a driver; it usually takes some milliseconds."""

BINDING_S: Final = 1.0
"""Time for that driver to begin. Until then the kernel drops reports, and tells nobody."""


def open_uhid(node: Path = NODE) -> int:
    """Returns an open descriptor of the node.

    Raises:
        DeviceError: there is no node, no module behind it, or no right to use it.
    """
    return _MAKER.open(node)


class UhidNode:
    """One HID device of the kernel; at rest when it is made.

    A thread answers the kernel from before the device exists: a program that asks for a report
    would otherwise hang for five seconds. If the process dies, the kernel removes the device.
    """

    def __init__(self, descriptor: int, spec: DeviceSpec, *, patience_s: float = START_S) -> None:
        """Creates the device and waits until the kernel reads it.

        Args:
            descriptor: ``/dev/uhid``, opened. From now on the node owns it, even if this call
                fails.
            spec: description of a pad, without motions and rumble.
            patience_s: how long the kernel may take.

        Raises:
            DeviceError: the kernel refuses it, or has no driver for it.
        """
        self._descriptor = descriptor
        self._spec = spec
        self._format = ReportFormat(spec.controls)
        self._report = spec.neutral
        self._started = threading.Event()
        self._wake_read, self._wake_write = os.pipe2(os.O_CLOEXEC)
        self._thread = threading.Thread(target=self._answer_on, name="uhid", daemon=True)
        self._thread.start()
        try:
            os.write(descriptor, self._make_creation())
        except OSError as error:
            self.close()
            raise DeviceError(
                f"The kernel refuses to create the {spec.name}: {error.strerror}."
            ) from error
        if not self._started.wait(patience_s):
            self.close()
            raise DeviceError(
                f"The kernel has found no driver for the {spec.name}.",
                hint="Load it: sudo modprobe hid-generic.",
            )
        self._repeat_until_s = time.monotonic() + BINDING_S

    def write_report(
        self,
        report: tuple[int, ...],
        steps: Steps = (),  # noqa: ARG002  # a pad does not move in steps
        stamp_ns: int = 0,  # noqa: ARG002  # HID reports carry no time
    ) -> None:
        """Writes one report if anything has changed, or if the driver may not have begun yet.

        Args:
            report: the value of every control of the description, in its order.
            steps: none; a pad does not move in steps.
            stamp_ns: not used: HID reports carry no time.

        Raises:
            DeviceError: the kernel refuses it.
        """
        if report == self._report and time.monotonic() > self._repeat_until_s:
            return
        data = self._format.pack(report)
        try:
            os.write(self._descriptor, _INPUT.pack(_INPUT2, len(data)) + data)
        except OSError as error:
            raise DeviceError(
                f"The kernel no longer takes input for the {self._spec.name}: {error.strerror}.",
                hint="Start the program again; it will make a new one.",
            ) from error
        self._report = report

    def close(self) -> None:
        """Removes the device."""
        with suppress(OSError):  # it is gone already, or never came to be
            os.write(self._descriptor, _TYPE.pack(_DESTROY))
        os.write(self._wake_write, b"x")
        self._thread.join()
        for descriptor in (self._descriptor, self._wake_read, self._wake_write):
            os.close(descriptor)

    def _make_creation(self) -> bytes:
        text = self._format.descriptor
        bus, vendor, product, version = self._spec.ids
        name, place = self._spec.name.encode(), self._spec.phys.encode()
        head = (name, place, place, len(text), bus, vendor, product, version, 0)
        return _CREATE.pack(_CREATE2, *head) + text

    def _answer_on(self) -> None:
        watched = [self._descriptor, self._wake_read]
        while True:
            ready, _, _ = select.select(watched, [], [])
            if self._wake_read in ready:
                return
            try:
                event = os.read(self._descriptor, _LARGEST)
                if not event:  # the other end is gone
                    return
                reply = self._answer(event)
                if reply:
                    os.write(self._descriptor, reply)
            except OSError:
                return

    def _answer(self, event: bytes) -> bytes:
        """Returns the answer to a message of the kernel, empty if it needs none."""
        if len(event) < _REQUEST.size:
            return b""
        kind = _TYPE.unpack_from(event)[0]
        if kind == _START:
            self._started.set()
        elif kind == _GET_REPORT:
            _, request, number, report_kind = _REQUEST.unpack_from(event)
            if (number, report_kind) == (0, _INPUT_REPORT):
                data = self._format.pack(self._report)
                return _GET_REPLY.pack(_GET_REPORT_REPLY, request, 0, len(data)) + data
            return _GET_REPLY.pack(_GET_REPORT_REPLY, request, EIO, 0)
        elif kind == _SET_REPORT:
            request = _REQUEST.unpack_from(event)[1]
            return _SET_REPLY.pack(_SET_REPORT_REPLY, request, EIO)
        return b""

"""What a HID pad hears from the kernel and what others read of it: nothing ends its answers."""

import atexit
import random
import socket
import struct
from functools import cache
from typing import Any, Final

from neurotouch_hid.device.inputs.hid_pad_reader import Report, read_reports_of
from neurotouch_hid.device.outputs.identity import load_identities
from neurotouch_hid.device.outputs.uhid import UhidNode

LIMIT_S: Final = 5.0
_LARGEST: Final = 4380
_PAD: Final = load_identities()["own"]
_START, _GET_REPORT, _GET_REPORT_REPLY = 2, 9, 10
_KINDS: Final = (*range(16), 255, 1 << 16, (1 << 32) - 1)
_ID: Final = 0xF17E


def make(rng: random.Random) -> bytes:
    """Returns a message of the kernel, then a zero or one, then a report of a pad."""
    kind, size = rng.choice(_KINDS), rng.choice((1, 2, 3, 4, 5, 8, 9, 10, 60, _LARGEST))
    message = struct.pack("=I", kind) + rng.randbytes(rng.choice((4, 6, 12)))
    report = rng.randbytes(rng.choice((1, 12, 13, 13, 13, 14, 64)))
    return struct.pack("=H", size) + message[:size].ljust(size, b"\0") + report


def check(case: bytes) -> None:
    """Sends the message to a pad, then asks for its report; reads the other report.

    Raises:
        AssertionError: the pad does not answer, or a report has become what no pad can be.
    """
    case = case.ljust(3, b"\0")
    size = max(1, struct.unpack_from("=H", case)[0])  # the kernel sends no empty message
    message, report = case[2 : 2 + size], case[2 + size :]
    kernel = _open_pad()
    kernel.send(message)
    kernel.send(struct.pack("=IIBB", _GET_REPORT, _ID, 0, 2).ljust(_LARGEST, b"\0"))
    while True:
        answer = kernel.recv(_LARGEST)
        kind, request = struct.unpack_from("=II", answer)
        if (kind, request) == (_GET_REPORT_REPLY, _ID):
            break
    for read in read_reports_of(_Given(report), _PAD.layout):
        if read is None:  # hidapi's empty answer: nothing came in time
            continue
        assert isinstance(read, Report), read
        assert all(-1.0 <= value <= 1.0 for value in read.axes.values()), read


class _Given:
    """Stands in for hidapi's device: one report, then the pad is gone."""

    def __init__(self, report: bytes) -> None:
        self._reports = [report]

    def read(self, _size: int, timeout_ms: int) -> Any:
        if not self._reports:
            raise OSError
        return self._reports.pop()

    def close(self) -> None:
        """Does nothing."""


@cache
def _open_pad() -> socket.socket:
    """Returns the kernel's end of a pad, which lives as long as this process."""
    kernel, ours = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    kernel.settimeout(LIMIT_S)
    kernel.send(struct.pack("=IQ", _START, 0).ljust(_LARGEST, b"\0"))
    pad = UhidNode(ours.detach(), _PAD.make_spec())
    atexit.register(pad.close)
    return kernel

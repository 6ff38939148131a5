"""The USB port of a camera: takes transfers and returns their completions, for any transport."""

import errno
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Protocol

from neurotouch_devtools.emulator.camera import EmulatedCamera
from neurotouch_devtools.emulator.faults import FaultError, FaultKind
from neurotouch_devtools.emulator.ps3eye import EyeCamera, EyeControl, EyeStream
from neurotouch_devtools.emulator.requests import ControlEndpoint
from neurotouch_devtools.emulator.transfers import DataEndpoint
from neurotouch_devtools.emulator.usb import Endpoint0, Setup
from neurotouch_devtools.emulator.uvc import UvcCamera, UvcControl, UvcStream

Camera = EmulatedCamera | UvcCamera
"""Every camera that can be plugged in."""

_STATUS = {
    FaultKind.STALL: -errno.EPIPE,
    FaultKind.PROTOCOL: -errno.EPROTO,
    FaultKind.BABBLE: -errno.EOVERFLOW,
}
_SETTLE_NS = 100_000_000
"""At the start, data waits until the host has queued no more transfers for this time: a driver that
queues them after it has switched the stream on would get the first ones out of order."""


class UnpluggedError(Exception):
    """The camera has gone."""


@dataclass(frozen=True, slots=True)
class Completion:
    """The end of a transfer.

    Attributes:
        number: the host's number for it.
        status: 0 or a negative errno.
        data: the data for the host.
        length: bytes transferred, in whichever direction.
    """

    number: int
    status: int
    data: bytes
    length: int


class Stream(Protocol):
    """The endpoint of a device that streams.

    Attributes:
        address: its address.
    """

    address: int

    def answer(self, length: int) -> bytes | None:
        """Returns the data of a transfer of ``length`` bytes, or None while there is none.

        Raises:
            FaultError: the transfer ends otherwise. With TIMEOUT and LOST it never ends.
        """

    def clear_halt(self) -> None:
        """Carries out the host's request that ends a halt."""


def open_endpoints(camera: Camera) -> tuple[Endpoint0, Stream]:
    """Returns the endpoints of a camera that was just plugged in."""
    if isinstance(camera, EyeCamera):
        return EyeControl(camera), EyeStream(camera)
    if isinstance(camera, UvcCamera):
        return UvcControl(camera), UvcStream(camera)
    data = DataEndpoint(camera)
    return ControlEndpoint(camera, data), data


class Port:
    """Takes the host's transfers and ends them, in the order of each endpoint.

    Args:
        camera: the camera.
        clock_ns: host time.
    """

    def __init__(self, camera: Camera, clock_ns: Callable[[], int] = time.monotonic_ns) -> None:
        self._camera, self._clock_ns = camera, clock_ns
        self._control, self._data = open_endpoints(camera)
        self._waiting: dict[int, int] = {}  # number: length, oldest first
        self._hanging: set[int] = set()  # will never end by themselves
        self._lost: set[int] = set()  # will never end
        self._settled = False
        self._last_submit_ns = 0

    @property
    def patience_s(self) -> float | None:
        """Time after which to ask for completions again; None: after the next transfer."""
        return self._camera.patience_us / 1e6 if self._camera.streaming else None

    def submit(self, number: int, endpoint: int, length: int) -> None:
        """Queues a transfer from an endpoint; no other than the stream's ever has data."""
        if endpoint != self._data.address:
            self._hanging.add(number)
            return
        self._last_submit_ns = self._clock_ns()
        self._waiting[number] = length

    def control(self, number: int, setup: Setup, data: bytes) -> Completion | None:
        """Returns the answer to a control transfer; None if it hangs.

        Raises:
            UnpluggedError: a fault has struck.
        """
        try:
            answer = self._control.answer(setup, data)
        except FaultError as fault:
            return self._end(number, fault.kind)
        length = len(answer) if setup.is_in else len(data)
        return Completion(number, 0, answer, length)

    def cancel(self, number: int) -> bool | None:
        """Forgets a transfer; False if it has ended already, None if the host gets no answer."""
        if number in self._lost:
            return None
        waited = number in self._hanging or number in self._waiting
        self._hanging.discard(number)
        self._waiting.pop(number, None)
        return waited

    def clear_halt(self) -> None:
        """Ends the stall of the data endpoint."""
        self._data.clear_halt()

    def completions(self) -> Iterator[Completion]:
        """Returns the transfers that end now; call it again after ``patience_s``.

        Raises:
            UnpluggedError: a fault has struck.
        """
        self._camera.advance()
        if not self._ready():
            return
        while self._waiting:
            number, length = next(iter(self._waiting.items()))
            try:
                data = self._data.answer(length)
            except FaultError as fault:
                del self._waiting[number]
                failed = self._end(number, fault.kind)
                if failed:
                    yield failed
                continue
            if data is None:
                return
            del self._waiting[number]
            yield Completion(number, 0, data, len(data))

    def _ready(self) -> bool:
        if not self._camera.streaming:
            self._settled = False
        elif self._waiting and self._clock_ns() - self._last_submit_ns >= _SETTLE_NS:
            self._settled = True
        return self._settled

    def _end(self, number: int, kind: FaultKind) -> Completion | None:
        if kind is FaultKind.UNPLUG:
            raise UnpluggedError
        if kind in {FaultKind.TIMEOUT, FaultKind.LOST}:
            (self._hanging if kind is FaultKind.TIMEOUT else self._lost).add(number)
            return None
        return Completion(number, _STATUS[kind], b"", 0)

"""The emulated UVC camera itself: requests in, pictures out, at the rate that the host chose."""

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from neurotouch_devtools.emulator.faults import Fault, FaultError, FaultKind, Script, Stage
from neurotouch_devtools.emulator.usb import IN, Endpoint0, Setup
from neurotouch_devtools.emulator.uvc.controls import Controls
from neurotouch_devtools.emulator.uvc.descriptors import (
    CONTROL_INTERFACE,
    DATA_ENDPOINT,
    STREAMING_INTERFACE,
    UvcIdentity,
)
from neurotouch_devtools.emulator.uvc.film import Film
from neurotouch_devtools.emulator.uvc.modes import Mode
from neurotouch_devtools.emulator.uvc.negotiation import Agreement, Negotiation
from neurotouch_devtools.emulator.uvc.payloads import Picture, cut
from neurotouch_hid.errors import SourceError

_PACKETS_PER_PAYLOAD = 32
"""So a payload fills one transfer of Linux's ``uvcvideo``."""
_SILENCE_NS = 100_000_000
_DAMAGE_SEED = 1
_OF_TRANSFERS = frozenset(
    {
        *(FaultKind.UNPLUG, FaultKind.STALL, FaultKind.TIMEOUT, FaultKind.PROTOCOL),
        *(FaultKind.SHORT, FaultKind.LOST, FaultKind.BABBLE),
    }
)


@dataclass(frozen=True, slots=True)
class UvcConfig:
    """Properties of an emulated UVC camera.

    Attributes:
        identity: names, speed, modes and settings of the USB side.
        n_buffered: pictures that wait for a slow host; those after them are lost.
        unpaced: pictures go as fast as the host reads, and none is lost; otherwise they come at
            the rate that the host chose.
    """

    identity: UvcIdentity = field(default_factory=UvcIdentity)
    n_buffered: int = 2
    unpaced: bool = False


class UvcCamera:
    """An emulated UVC camera: answers requests and sends pictures, for any transport.

    Args:
        film: what it sees. Time passes there only while the camera streams.
        config: its properties.
        faults: the faults to inject.
        clock_ns: host time.

    Raises:
        SourceError: one of the faults cannot happen to such a camera.

    Attributes:
        config: its properties.
        film: what it sees; another one may be put there at any time.
        script: counts the host's requests, its transfers and the pictures, and injects faults.
        controls: the settings.
        agreement: the mode of the stream; None while there is none.
        n_sent: pictures sent.
        n_lost: pictures lost because the host did not read.
    """

    def __init__(
        self,
        film: Film,
        config: UvcConfig | None = None,
        faults: Sequence[Fault] = (),
        *,
        clock_ns: Callable[[], int] = time.monotonic_ns,
    ) -> None:
        for fault in faults:
            if fault.stage is Stage.STREAM and fault.kind not in _OF_TRANSFERS:
                raise SourceError(f"The fault {fault.kind} never happens to a UVC camera's stream.")
        self.config = config or UvcConfig()
        self.film = film
        self.script = Script(faults)
        self.controls = Controls(self.config.identity.controls)
        self.agreement: Agreement | None = None
        self.n_sent = self.n_lost = 0
        self._clock_ns = clock_ns
        self._sending: Iterator[bytes] = iter(())
        self._last_data = b""
        self._is_read = False  # only then do pictures come, and time passes in the film
        self._due_ns = 0  # when the next picture is complete
        self._scene_ns = 0  # time in the film

    @property
    def super_speed(self) -> bool:
        """True if it is plugged into a port of USB 3."""
        return self.config.identity.super_speed

    @property
    def payload_bytes(self) -> int:
        """Bytes of a payload."""
        return _PACKETS_PER_PAYLOAD * (1024 if self.super_speed else 512)

    @property
    def streaming(self) -> bool:
        """True if data passes to USB."""
        return self.agreement is not None

    @property
    def patience_us(self) -> float:
        """Time after which a transport must ask for data again."""
        if self.config.unpaced or not self._is_read:
            return 1000.0
        return max(self._due_ns - self._clock_ns(), 0) / 1000

    def advance(self) -> None:
        """Does nothing: the time of a picture is reckoned when the host reads."""

    def begin(self, agreement: Agreement) -> None:
        """Begins the stream."""
        self.agreement = agreement
        self._sending = iter(())
        self._last_data = b""
        self._is_read = False

    def end(self) -> None:
        """Ends the stream."""
        self.agreement = None

    def read(self) -> bytes | None:
        """Returns the next payload, or None while there is none.

        Raises:
            FaultError: the camera has gone.
        """
        payload = next(self._sending, None)
        if payload is not None or self.agreement is None:
            return payload
        if not self._is_read:
            self._is_read = True
            self._due_ns = self._clock_ns() + 100 * self.agreement.interval
        return next(self._sending) if self._expose(self.agreement) else None

    def _expose(self, agreement: Agreement) -> bool:
        """Takes the next picture that is complete; False if there is none."""
        now_ns = self._clock_ns()
        # It takes what was agreed, or more if the exposure takes longer.
        period_ns = max(100 * agreement.interval, 1000 * self.controls.exposure_us)
        unpaced = self.config.unpaced
        while unpaced or self._due_ns <= now_ns:
            if not unpaced and now_ns - self._due_ns >= self.config.n_buffered * period_ns:
                self.n_lost += 1
                picture = None
            else:
                picture = self._take(agreement.mode, self._due_ns - period_ns, period_ns)
            self._due_ns += period_ns
            self._scene_ns += period_ns
            if picture is not None:
                self._sending = cut(picture, self.payload_bytes, now_ns)
                self.n_sent += 1
                return True
        return False

    def _take(self, mode: Mode, exposed_ns: int, period_ns: int) -> Picture | None:
        """Returns the next picture, or None if a fault strikes it."""
        kind = self.script.strike(Stage.PICTURE)
        match kind:
            case FaultKind.UNPLUG:
                raise FaultError(kind)
            case FaultKind.DROPPED:
                return None
            case FaultKind.SILENCE:
                self._due_ns += _SILENCE_NS
                return None
            case FaultKind.SLOW:
                self._due_ns += period_ns
        if kind is not FaultKind.DOUBLED or not self._last_data:
            self._last_data = mode.write(self.film.find(self._scene_ns // 1000))
        data = _damage(self._last_data) if kind is FaultKind.DAMAGED else self._last_data
        return Picture(data, self.n_sent, exposed_ns, kind is FaultKind.ERROR)


class UvcControl(Endpoint0):
    """Answers the control requests to one camera.

    Args:
        camera: the camera.
    """

    def __init__(self, camera: UvcCamera) -> None:
        identity = camera.config.identity
        # A stream of bulk transfers has no other end than this request (Linux, uvc_video.c).
        super().__init__(camera.script, identity.describe, DATA_ENDPOINT, camera.end)
        self._camera = camera
        self._negotiation = Negotiation(identity.modes, camera.payload_bytes, camera.begin)

    def _stage(self, setup: Setup, _: bytes) -> Stage:
        return Stage.OPEN if setup.is_in else Stage.CONFIGURE

    def _carry_out_own(self, setup: Setup, data: bytes) -> bytes:
        unit, interface = divmod(setup.index, 0x100)
        selector = setup.value >> 8
        if bool(setup.request & IN) != setup.is_in:
            raise FaultError(FaultKind.STALL)
        if interface == CONTROL_INTERFACE:
            return self._camera.controls.answer(unit, selector, setup.request, data)
        if interface == STREAMING_INTERFACE and not unit:
            return self._negotiation.answer(selector, setup.request, data)
        raise FaultError(FaultKind.STALL)


class UvcStream:
    """Answers the bulk transfers from one camera.

    Args:
        camera: the camera.

    Attributes:
        address: the endpoint's address.
    """

    address = DATA_ENDPOINT

    def __init__(self, camera: UvcCamera) -> None:
        self._camera = camera

    def answer(self, length: int) -> bytes | None:
        """Returns the data of a transfer of ``length`` bytes, or None while there is none.

        Raises:
            FaultError: the transfer ends otherwise, and its data is lost.
        """
        data = self._take(length)
        if data is None:
            return None
        kind = self._camera.script.strike(Stage.STREAM)
        if kind is FaultKind.SHORT:
            return data[: len(data) // 2]
        if kind is not None:
            raise FaultError(kind)
        if len(data) > length:
            raise FaultError(FaultKind.BABBLE)
        return data

    def clear_halt(self) -> None:
        """Ends the stream."""
        self._camera.end()

    def _take(self, _: int) -> bytes | None:
        return self._camera.read()


def _damage(data: bytes) -> bytes:
    """Returns the data with noise in its middle third; of a JPEG, the headers stay."""
    third = len(data) // 3
    noise = np.random.default_rng(_DAMAGE_SEED).bytes(third)
    return data[:third] + noise + data[2 * third :]

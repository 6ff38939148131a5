"""Shared by every USB device: standard descriptors, and the standard requests to endpoint 0."""

import struct
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum

from neurotouch_devtools.emulator.faults import FaultError, FaultKind, Script, Stage

DEVICE, CONFIGURATION, STRING, INTERFACE, ENDPOINT = 1, 2, 3, 4, 5
QUALIFIER, BOS, CAPABILITY, COMPANION = 6, 15, 16, 48
BULK, INTERRUPT = 2, 3
IN = 0x80

_ENGLISH = 0x0409
_TYPE_MASK, _STANDARD = 0x60, 0x00
_TO_ENDPOINT = 2
_ENDPOINT_HALT = 0


class Standard(IntEnum):
    """Requests that every device answers."""

    GET_STATUS = 0
    CLEAR_FEATURE = 1
    SET_FEATURE = 3
    SET_ADDRESS = 5
    GET_DESCRIPTOR = 6
    GET_CONFIGURATION = 8
    SET_CONFIGURATION = 9
    GET_INTERFACE = 10
    SET_INTERFACE = 11
    SET_SEL = 0x30
    SET_ISOCH_DELAY = 0x31


@dataclass(frozen=True, slots=True)
class Setup:
    """The eight bytes that begin a control transfer."""

    request_type: int
    request: int
    value: int
    index: int
    length: int

    @classmethod
    def parse(cls, data: bytes) -> "Setup":
        """Parses the bytes on the wire."""
        return cls(*struct.unpack("<BBHHH", data))

    @property
    def is_in(self) -> bool:
        """True if the host asks for data."""
        return bool(self.request_type & IN)

    @property
    def is_standard(self) -> bool:
        """True if every device knows the request; otherwise its class or its maker defines it."""
        return self.request_type & _TYPE_MASK == _STANDARD


class Endpoint0(ABC):
    """Answers the control requests to one device.

    Args:
        script: counts the requests, and injects faults.
        describe: returns a descriptor by type and index, None if there is none.
        data_endpoint: address of the endpoint that streams.
        clear_halt: ends the halt of that endpoint.
    """

    def __init__(
        self,
        script: Script,
        describe: Callable[[int, int], bytes | None],
        data_endpoint: int,
        clear_halt: Callable[[], None],
    ) -> None:
        self._script, self._describe = script, describe
        self._data_endpoint, self._clear_halt = data_endpoint, clear_halt
        self._configuration = 0

    def answer(self, setup: Setup, data: bytes = b"") -> bytes:
        """Carries out a request.

        Args:
            setup: the request.
            data: data from the host.

        Returns:
            Data for the host, at most ``setup.length`` bytes.

        Raises:
            FaultError: the device does not know the request (STALL), or a fault strikes.
        """
        stage = Stage.PLUGGED if setup.is_standard else self._stage(setup, data)
        kind = self._script.strike(stage)
        if kind is FaultKind.SHORT:
            return self._carry_out(setup, data)[: setup.length // 2]
        if kind is not None:
            raise FaultError(kind)
        return self._carry_out(setup, data)

    @abstractmethod
    def _stage(self, setup: Setup, data: bytes) -> Stage:
        """Returns the stage of the host's work, judging by a request that is not standard."""

    @abstractmethod
    def _carry_out_own(self, setup: Setup, data: bytes) -> bytes:
        """Carries out a request that is not standard."""

    def _carry_out(self, setup: Setup, data: bytes) -> bytes:
        own = not setup.is_standard
        answer = self._carry_out_own(setup, data) if own else self._carry_out_standard(setup)
        return answer[: setup.length]

    def _carry_out_standard(self, setup: Setup) -> bytes:
        match setup.request:
            case Standard.GET_DESCRIPTOR:
                answer = self._describe(*divmod(setup.value, 0x100))
                if answer is None:
                    raise FaultError(FaultKind.STALL)
                return answer
            case Standard.GET_STATUS | Standard.GET_INTERFACE:
                return bytes(setup.length)
            case Standard.GET_CONFIGURATION:
                return bytes([self._configuration])
            case Standard.SET_CONFIGURATION:
                self._configuration = setup.value
            case Standard.CLEAR_FEATURE:
                to_endpoint = setup.request_type & 0x1F == _TO_ENDPOINT
                halt = setup.value == _ENDPOINT_HALT and setup.index == self._data_endpoint
                if to_endpoint and halt:
                    self._clear_halt()
            case (
                Standard.SET_FEATURE
                | Standard.SET_ADDRESS
                | Standard.SET_INTERFACE
                | Standard.SET_SEL
                | Standard.SET_ISOCH_DELAY
            ):
                pass  # nothing depends on them here
            case _:
                raise FaultError(FaultKind.STALL)
        return b""


def describe_configuration(
    body: bytes, *, n_interfaces: int, milliamperes: int, super_speed: bool
) -> bytes:
    """Returns the descriptor of a configuration, the descriptors of its interfaces included."""
    power = milliamperes // (8 if super_speed else 2)
    head = struct.pack(
        "<BBHBBBBB", 9, CONFIGURATION, 9 + len(body), n_interfaces, 1, 0, 0x80, power
    )
    return head + body


def describe_bulk_endpoint(address: int, *, burst: int, super_speed: bool) -> bytes:
    """Returns the descriptors of a bulk endpoint; ``burst`` packets follow the first at once."""
    packet_size = 1024 if super_speed else 512
    endpoint = struct.pack("<BBBBHB", 7, ENDPOINT, address, BULK, packet_size, 0)
    return endpoint + (struct.pack("<BBBBH", 6, COMPANION, burst, 0, 0) if super_speed else b"")


def describe_string(index: int, texts: dict[int, str | None]) -> bytes | None:
    """Returns the string of an index, the languages for index 0; None if there is none."""
    if index == 0:
        return struct.pack("<BBH", 4, STRING, _ENGLISH)
    text = texts.get(index)
    if text is None:
        return None
    encoded = text.encode("utf-16-le")
    return struct.pack("<BB", 2 + len(encoded), STRING) + encoded


def describe_device(
    device_class: tuple[int, int, int],
    product: tuple[int, int],
    version: int,
    *,
    has_serial: bool,
    super_speed: bool,
) -> bytes:
    """Returns the descriptor of a device; its strings are maker, product and serial number.

    Args:
        device_class: class, subclass and protocol.
        product: the numbers of maker and product.
        version: ``bcdDevice``.
        has_serial: it has a serial number.
        super_speed: it is at super speed.
    """
    usb, packet_0 = (0x0300, 9) if super_speed else (0x0200, 64)  # 9: 2 to the 9th
    head = struct.pack("<BBHBBBB", 18, DEVICE, usb, *device_class, packet_0)
    return head + struct.pack("<HHHBBBB", *product, version, 1, 2, 3 * has_serial, 1)


def describe_qualifier(device_class: tuple[int, int, int]) -> bytes:
    """Returns the descriptor of a high-speed device at its other speed."""
    return struct.pack("<BBHBBBBBB", 10, QUALIFIER, 0x0200, *device_class, 64, 1, 0)


def describe_bos() -> bytes:
    """Returns the BOS without link power management: a real camera's kernel log says it is off."""
    usb_2 = struct.pack("<BBBI", 7, CAPABILITY, 2, 0)
    super_speed = struct.pack("<BBBBHBBH", 10, CAPABILITY, 3, 0, 0b1110, 3, 0, 0)
    return struct.pack("<BBHB", 5, BOS, 5 + len(usb_2) + len(super_speed), 2) + usb_2 + super_speed

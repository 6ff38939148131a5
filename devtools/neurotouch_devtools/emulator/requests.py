"""Endpoint 0: the standard requests of USB and the vendor requests of the camera."""

import struct
from dataclasses import dataclass
from enum import IntEnum

from neurotouch_devtools.emulator import registers as reg
from neurotouch_devtools.emulator.camera import EmulatedCamera
from neurotouch_devtools.emulator.descriptors import DATA_ENDPOINT
from neurotouch_devtools.emulator.faults import FaultError, FaultKind, Stage
from neurotouch_devtools.emulator.transfers import DataEndpoint


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


class Vendor(IntEnum):
    """Requests of the camera's firmware."""

    LOG_LEVEL = 0xB1  # dv-processing sends it; its meaning is unknown
    REGISTER = 0xBF
    REGISTERS = 0xC2
    FLUSH = 0xC6


IN = 0x80
_TYPE_MASK, _VENDOR = 0x60, 0x40
_TO_ENDPOINT = 2
_ENDPOINT_HALT = 0
_SWITCHES = (
    *(reg.DVS_RUN, reg.APS_RUN, reg.MUX_RUN, reg.TIMESTAMP_RUN, reg.USB_RUN, reg.CHIP_RUN),
    *((reg.Module.IMU, parameter) for parameter in (2, 3, 4)),
    *((reg.Module.EXTERNAL_INPUT, parameter) for parameter in (0, 11)),
)
_ENTRY = struct.Struct(">BBI")


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
    def is_vendor(self) -> bool:
        """True if the request is for the camera's firmware."""
        return self.request_type & _TYPE_MASK == _VENDOR


class ControlEndpoint:
    """Answers the control requests to one camera.

    Args:
        camera: the camera.
        data: its other endpoint, for the request that ends its halt.
    """

    def __init__(self, camera: EmulatedCamera, data: DataEndpoint) -> None:
        self._camera, self._data = camera, data
        self._configuration = 0
        self._stopping = False

    def answer(self, setup: Setup, data: bytes = b"") -> bytes:
        """Carries out a request.

        Args:
            setup: the request.
            data: data from the host.

        Returns:
            Data for the host, at most ``setup.length`` bytes.

        Raises:
            FaultError: the camera does not know the request (STALL), or a fault strikes.
        """
        kind = self._camera.script.strike(self._stage(setup, data))
        if kind is FaultKind.SHORT:
            return self._carry_out(setup, data)[: setup.length // 2]
        if kind is not None:
            raise FaultError(kind)
        return self._carry_out(setup, data)

    def _carry_out(self, setup: Setup, data: bytes) -> bytes:
        answer = self._vendor(setup, data) if setup.is_vendor else self._standard(setup)
        return answer[: setup.length]

    def _stage(self, setup: Setup, data: bytes) -> Stage:
        """Returns the stage of the host's work, judging by the request."""
        if not setup.is_vendor:
            return Stage.PLUGGED
        if setup.is_in:
            self._stopping = False
            return Stage.OPEN
        if self._camera.streaming:
            self._stopping = (setup.value, setup.index) in _SWITCHES and not any(data)
        return Stage.STOP if self._stopping else Stage.CONFIGURE

    def _vendor(self, setup: Setup, data: bytes) -> bytes:
        reads = setup.is_in
        if setup.request == Vendor.REGISTER and reads:
            return self._camera.registers[setup.value, setup.index].to_bytes(4, "big")
        if setup.request == Vendor.REGISTER and len(data) == 4:
            self._camera.write((setup.value, setup.index), int.from_bytes(data, "big"))
            return b""
        if setup.request == Vendor.REGISTERS and not reads:
            if len(data) != setup.value * _ENTRY.size:
                raise FaultError(FaultKind.STALL)
            for module, parameter, value in _ENTRY.iter_unpack(data):
                self._camera.write((module, parameter), value)
            return b""
        if setup.request == Vendor.FLUSH and not reads:
            self._camera.flush()
            return b""
        if setup.request == Vendor.LOG_LEVEL and not reads:
            return b""
        raise FaultError(FaultKind.STALL)

    def _standard(self, setup: Setup) -> bytes:
        match setup.request:
            case Standard.GET_DESCRIPTOR:
                kind, index = divmod(setup.value, 0x100)
                answer = self._camera.config.identity.describe(kind, index)
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
                if to_endpoint and setup.value == _ENDPOINT_HALT and setup.index == DATA_ENDPOINT:
                    self._data.clear_halt()
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

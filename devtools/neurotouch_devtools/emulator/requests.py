"""Endpoint 0 of the DAVIS-346: the vendor requests of its firmware, beside those of USB."""

import struct
from enum import IntEnum

from neurotouch_devtools.emulator import registers as reg
from neurotouch_devtools.emulator.camera import EmulatedCamera
from neurotouch_devtools.emulator.descriptors import DATA_ENDPOINT
from neurotouch_devtools.emulator.faults import FaultError, FaultKind, Stage
from neurotouch_devtools.emulator.transfers import DataEndpoint
from neurotouch_devtools.emulator.usb import Endpoint0, Setup


class Vendor(IntEnum):
    """Requests of the camera's firmware."""

    LOG_LEVEL = 0xB1  # dv-processing sends it; its meaning is unknown
    REGISTER = 0xBF
    REGISTERS = 0xC2
    FLUSH = 0xC6


_SWITCHES = (
    *(reg.DVS_RUN, reg.APS_RUN, reg.MUX_RUN, reg.TIMESTAMP_RUN, reg.USB_RUN, reg.CHIP_RUN),
    *((reg.Module.IMU, parameter) for parameter in (2, 3, 4)),
    *((reg.Module.EXTERNAL_INPUT, parameter) for parameter in (0, 11)),
)
_ENTRY = struct.Struct(">BBI")


class ControlEndpoint(Endpoint0):
    """Answers the control requests to one camera.

    Args:
        camera: the camera.
        data: its other endpoint, for the request that ends its halt.
    """

    def __init__(self, camera: EmulatedCamera, data: DataEndpoint) -> None:
        super().__init__(
            camera.script, camera.config.identity.describe, DATA_ENDPOINT, data.clear_halt
        )
        self._camera = camera
        self._stopping = False

    def _stage(self, setup: Setup, data: bytes) -> Stage:
        if setup.is_in:
            self._stopping = False
            return Stage.OPEN
        if self._camera.streaming:
            self._stopping = (setup.value, setup.index) in _SWITCHES and not any(data)
        return Stage.STOP if self._stopping else Stage.CONFIGURE

    def _carry_out_own(self, setup: Setup, data: bytes) -> bytes:
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

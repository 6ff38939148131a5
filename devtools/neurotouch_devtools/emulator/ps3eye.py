"""An emulated PS3 Eye, which the kernel's own driver ``gspca_ov534`` takes for a real one.

It is no UVC camera: one vendor request reads and writes the registers of its bridge, and through
these those of its sensor. Its pictures have UVC's payload headers, eight payloads a transfer. What
is known of it comes from Linux (drivers/media/usb/gspca/ov534.c). It has no microphones here.
"""

import struct
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

from neurotouch_devtools.emulator.faults import Fault, FaultError, FaultKind, Stage
from neurotouch_devtools.emulator.usb import (
    CONFIGURATION,
    DEVICE,
    INTERFACE,
    QUALIFIER,
    STRING,
    Endpoint0,
    Setup,
    describe_bulk_endpoint,
    describe_configuration,
    describe_device,
    describe_qualifier,
    describe_string,
)
from neurotouch_devtools.emulator.uvc.camera import UvcCamera, UvcConfig, UvcStream
from neurotouch_devtools.emulator.uvc.descriptors import DATA_ENDPOINT, UvcIdentity
from neurotouch_devtools.emulator.uvc.film import Film
from neurotouch_devtools.emulator.uvc.modes import Mode, PixelFormat
from neurotouch_devtools.emulator.uvc.negotiation import Agreement

PAYLOAD_BYTES: Final = 2048

_VENDOR_ID, _PRODUCT_ID, _RELEASE = 0x1415, 0x2000, 0x0100
_CLASS, _OWN_CLASS = (0, 0, 0), 0xFF
_REGISTER: Final = 1
"""The only request: a byte of the bridge; its register is the index."""

_STREAM, _RATE_FACTOR = 0xE0, 0xE5
_COLUMNS, _ROWS, _INPUT = 0xC0, 0xC1, 0xC2
_SUB_ADDRESS, _TO_WRITE, _WAS_READ, _OPERATION, _STATUS = 0xF2, 0xF3, 0xF4, 0xF5, 0xF6
"""Registers of the bridge: the stream, the picture's size, and the way to the sensor."""

_WRITE, _READ = 0x37, 0xF9
_YUYV = 0x0C
_ID_HIGH, _ID_LOW, _SENSOR_ID = 0x0A, 0x0B, (0x77, 0x21)
_CLOCK, _MULTIPLIER, _RESET = 0x11, 0x0D, (0x12, 0x80)
"""Registers of the sensor; a second number is a bit or a value."""

_MULTIPLIES: Final = (1, 4, 6, 8)
_SLOWEST_HZ: Final = {320: 37.5, 640: 15.0}
"""Pictures a second by the width, with clocks neither multiplied nor divided."""


@dataclass(frozen=True, slots=True)
class EyeIdentity(UvcIdentity):
    """The names of a PS3 Eye; its driver knows the modes and the settings without being told."""

    product: str = "USB Camera-B4.04.27.1"
    serial: str | None = None
    super_speed: bool = False
    modes: tuple[Mode, ...] = ()

    @property
    def controls(self) -> frozenset[str]:
        """None of UVC's."""
        return frozenset()

    def describe(self, kind: int, index: int) -> bytes | None:
        """Returns a descriptor of the given type and index, or None if the camera has none."""
        if kind == DEVICE:
            product = (_VENDOR_ID, _PRODUCT_ID)
            return describe_device(_CLASS, product, _RELEASE, has_serial=False, super_speed=False)
        if kind == CONFIGURATION and index == 0:
            video = struct.pack("<BBBBBBBBB", 9, INTERFACE, 0, 0, 1, _OWN_CLASS, 0, 0, 0)
            video += describe_bulk_endpoint(DATA_ENDPOINT, burst=0, super_speed=False)
            return describe_configuration(
                video, n_interfaces=1, milliamperes=500, super_speed=False
            )
        if kind == STRING:
            return describe_string(index, {1: "OmniVision Technologies, Inc.", 2: self.product})
        return describe_qualifier(_CLASS) if kind == QUALIFIER else None


class EyeCamera(UvcCamera):
    """An emulated PS3 Eye: its pictures, their pace and its faults are those of ``UvcCamera``.

    Args:
        film: what it sees.
        unpaced: pictures go as fast as the host reads, and none is lost.
        faults: the faults to inject.
        clock_ns: host time.

    Attributes:
        bridge, sensor: their registers, 256 bytes each.
    """

    def __init__(
        self,
        film: Film,
        *,
        unpaced: bool = False,
        faults: Sequence[Fault] = (),
        **clock: Callable[[], int],
    ) -> None:
        super().__init__(film, UvcConfig(EyeIdentity(), unpaced=unpaced), faults, **clock)
        self.bridge, self.sensor = bytearray(256), bytearray(256)
        self.reset_sensor()

    @property
    def payload_bytes(self) -> int:
        """Bytes of a payload."""
        return PAYLOAD_BYTES

    def reset_sensor(self) -> None:
        """Brings the sensor's registers to 0; its number stays."""
        self.sensor[:] = bytes(256)
        self.sensor[_ID_HIGH], self.sensor[_ID_LOW] = _SENSOR_ID

    def write(self, register: int, value: int) -> None:
        """Writes a register of the bridge, and carries out what that means."""
        bridge = self.bridge
        bridge[register] = value
        if register == _OPERATION:
            at, bridge[_STATUS] = bridge[_SUB_ADDRESS], 0
            if value == _READ:
                bridge[_WAS_READ] = self.sensor[at]
            elif value == _WRITE and (at, bridge[_TO_WRITE]) == _RESET:
                self.reset_sensor()
            elif value == _WRITE and at not in (_ID_HIGH, _ID_LOW):
                self.sensor[at] = bridge[_TO_WRITE]
        elif register == _STREAM and not value:
            self.begin(self._read_mode())
        elif register == _STREAM:
            self.end()

    def _read_mode(self) -> Agreement:
        """Returns the mode that the registers describe."""
        width, height = 8 * self.bridge[_COLUMNS], 8 * self.bridge[_ROWS]
        if width not in _SLOWEST_HZ or self.bridge[_INPUT] != _YUYV:
            raise FaultError(FaultKind.STALL)
        times = _MULTIPLIES[self.sensor[_MULTIPLIER] >> 6] / (1 + (self.sensor[_CLOCK] & 0x3F))
        faster = 5.0 / 3.0 if self.bridge[_RATE_FACTOR] == 2 else 1.0
        interval = round(1e7 / (_SLOWEST_HZ[width] * times * faster))
        return Agreement(Mode(PixelFormat.YUYV, width, height, (interval,)), interval)


class EyeControl(Endpoint0):
    """Answers the control requests to one camera.

    Args:
        camera: the camera.
    """

    def __init__(self, camera: EyeCamera) -> None:
        super().__init__(camera.script, camera.config.identity.describe, DATA_ENDPOINT, camera.end)
        self._camera = camera

    def _stage(self, setup: Setup, _: bytes) -> Stage:
        return Stage.OPEN if setup.is_in else Stage.CONFIGURE

    def _carry_out_own(self, setup: Setup, data: bytes) -> bytes:
        if setup.request != _REGISTER or setup.index >= len(self._camera.bridge):
            raise FaultError(FaultKind.STALL)
        if setup.is_in:
            return bytes([self._camera.bridge[setup.index]])
        if len(data) != 1:
            raise FaultError(FaultKind.STALL)
        self._camera.write(setup.index, data[0])
        return b""


class EyeStream(UvcStream):
    """Answers the bulk transfers from one camera: each has several payloads of one picture."""

    def _take(self, length: int) -> bytes | None:
        parts: list[bytes] = []
        while PAYLOAD_BYTES * (len(parts) + 1) <= length:
            part = self._camera.read()
            if part is None:
                break
            parts.append(part)
            if len(part) < PAYLOAD_BYTES:  # the end of the picture, and so of the transfer
                break
        return b"".join(parts) or None

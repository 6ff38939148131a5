"""The camera's own description when it is plugged in: the USB descriptors, byte by byte."""

import struct
from dataclasses import dataclass

VENDOR_ID, PRODUCT_ID = 0x152A, 0x841A
DATA_ENDPOINT, DEBUG_ENDPOINT = 0x82, 0x81

DEVICE, CONFIGURATION, STRING, INTERFACE, ENDPOINT = 1, 2, 3, 4, 5
QUALIFIER, BOS, CAPABILITY, COMPANION = 6, 15, 16, 48

_ENGLISH = 0x0409
_VENDOR_CLASS = 0xFF
_BULK, _INTERRUPT = 2, 3


@dataclass(frozen=True, slots=True)
class Identity:
    """Properties that differ between cameras.

    Attributes:
        serial: eight digits on real cameras; None leaves the string out.
        product: the product's name; that of a real camera is not certain.
        firmware: low byte of the device's version; drivers accept 6 only.
        board: high byte, 2 for the "blue" case, 3 for the "red" one.
        super_speed: on a USB 3 port; else USB 2 high speed.
    """

    serial: str | None = "00000001"
    product: str = "DAVIS 346"
    firmware: int = 6
    board: int = 3
    super_speed: bool = True

    @property
    def packet_size(self) -> int:
        """Bytes in a full bulk packet."""
        return 1024 if self.super_speed else 512

    @property
    def version(self) -> int:
        """``bcdDevice``: board and firmware."""
        return self.board << 8 | self.firmware

    def describe(self, kind: int, index: int) -> bytes | None:
        """Returns a descriptor of the given type and index, or None if the camera has none."""
        if kind == DEVICE:
            return self._device()
        if kind == CONFIGURATION and index == 0:
            return self._configuration()
        if kind == STRING:
            return self._string(index)
        if kind == BOS and self.super_speed:
            return _bos()
        if kind == QUALIFIER and not self.super_speed:
            return struct.pack("<BBHBBBBBB", 10, QUALIFIER, 0x0200, *_class(), 64, 1, 0)
        return None

    def _device(self) -> bytes:
        usb, packet_0 = (0x0300, 9) if self.super_speed else (0x0200, 64)  # 9: 2 to the 9th
        strings = (1, 2, 0 if self.serial is None else 3)
        head = struct.pack("<BBHBBBB", 18, DEVICE, usb, *_class(), packet_0)
        return head + struct.pack("<HHHBBBB", VENDOR_ID, PRODUCT_ID, self.version, *strings, 1)

    def _configuration(self) -> bytes:
        extra_device = struct.pack("<BBBBH", 6, COMPANION, 0, 0, 64) if self.super_speed else b""
        burst = struct.pack("<BBBBH", 6, COMPANION, 15, 0, 0) if self.super_speed else b""
        # An interval is 2**(n - 1) microframes at both speeds: 1 is 125 µs.
        body = b"".join(
            (
                struct.pack("<BBBBBBBBB", 9, INTERFACE, 0, 0, 2, *_class(), 0),
                struct.pack("<BBBBHB", 7, ENDPOINT, DEBUG_ENDPOINT, _INTERRUPT, 64, 1),
                extra_device,
                struct.pack("<BBBBHB", 7, ENDPOINT, DATA_ENDPOINT, _BULK, self.packet_size, 0),
                burst,
            )
        )
        power = 180 // 8 if self.super_speed else 180 // 2  # 180 mA in units of 8 or 2 mA
        return (
            struct.pack("<BBHBBBBB", 9, CONFIGURATION, 9 + len(body), 1, 1, 0, 0x80, power) + body
        )

    def _string(self, index: int) -> bytes | None:
        if index == 0:
            return struct.pack("<BBH", 4, STRING, _ENGLISH)
        text = {1: "iniVation", 2: self.product, 3: self.serial}.get(index)
        if text is None:
            return None
        encoded = text.encode("utf-16-le")
        return struct.pack("<BB", 2 + len(encoded), STRING) + encoded


def _class() -> tuple[int, int, int]:
    return _VENDOR_CLASS, 0, 0


def _bos() -> bytes:
    """Returns the BOS without link power management: a real camera's kernel log says it is off."""
    usb_2 = struct.pack("<BBBI", 7, CAPABILITY, 2, 0)
    super_speed = struct.pack("<BBBBHBBH", 10, CAPABILITY, 3, 0, 0b1110, 3, 0, 0)
    return struct.pack("<BBHB", 5, BOS, 5 + len(usb_2) + len(super_speed), 2) + usb_2 + super_speed

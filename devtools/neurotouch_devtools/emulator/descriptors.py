"""The camera's own description when it is plugged in: the USB descriptors, byte by byte."""

import struct
from dataclasses import dataclass

from neurotouch_devtools.emulator.usb import (
    BOS,
    COMPANION,
    CONFIGURATION,
    DEVICE,
    ENDPOINT,
    INTERFACE,
    INTERRUPT,
    QUALIFIER,
    STRING,
    describe_bos,
    describe_bulk_endpoint,
    describe_configuration,
    describe_device,
    describe_qualifier,
    describe_string,
)

VENDOR_ID, PRODUCT_ID = 0x152A, 0x841A
DATA_ENDPOINT, DEBUG_ENDPOINT = 0x82, 0x81

_CLASS = (0xFF, 0, 0)
"""Defined by the maker."""


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
    def version(self) -> int:
        """``bcdDevice``: board and firmware."""
        return self.board << 8 | self.firmware

    def describe(self, kind: int, index: int) -> bytes | None:
        """Returns a descriptor of the given type and index, or None if the camera has none."""
        if kind == DEVICE:
            return describe_device(
                _CLASS,
                (VENDOR_ID, PRODUCT_ID),
                self.version,
                has_serial=self.serial is not None,
                super_speed=self.super_speed,
            )
        if kind == CONFIGURATION and index == 0:
            return self._configuration()
        if kind == STRING:
            return describe_string(index, {1: "iniVation", 2: self.product, 3: self.serial})
        if kind == BOS and self.super_speed:
            return describe_bos()
        if kind == QUALIFIER and not self.super_speed:
            return describe_qualifier(_CLASS)
        return None

    def _configuration(self) -> bytes:
        extra_device = struct.pack("<BBBBH", 6, COMPANION, 0, 0, 64) if self.super_speed else b""
        # An interval is 2**(n - 1) microframes at both speeds: 1 is 125 µs.
        body = b"".join(
            (
                struct.pack("<BBBBBBBBB", 9, INTERFACE, 0, 0, 2, *_CLASS, 0),
                struct.pack("<BBBBHB", 7, ENDPOINT, DEBUG_ENDPOINT, INTERRUPT, 64, 1),
                extra_device,
                describe_bulk_endpoint(DATA_ENDPOINT, burst=15, super_speed=self.super_speed),
            )
        )
        return describe_configuration(
            body, n_interfaces=1, milliamperes=180, super_speed=self.super_speed
        )

"""The description of a UVC camera: its units, settings, formats and sizes, byte by byte."""

import struct
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from neurotouch_devtools.emulator.usb import (
    BOS,
    CONFIGURATION,
    DEVICE,
    INTERFACE,
    QUALIFIER,
    STRING,
    describe_bos,
    describe_bulk_endpoint,
    describe_configuration,
    describe_device,
    describe_qualifier,
    describe_string,
)
from neurotouch_devtools.emulator.uvc.controls import CONTROLS, PROCESSING, TERMINAL
from neurotouch_devtools.emulator.uvc.modes import MODES, Mode, PixelFormat
from neurotouch_devtools.emulator.uvc.negotiation import CLOCK_HZ, group_by_format

VENDOR_ID, PRODUCT_ID = 0x1D6B, 0x0102
"""Those of Linux's own webcam gadget: no maker has them."""
DATA_ENDPOINT = 0x81
CONTROL_INTERFACE, STREAMING_INTERFACE = 0, 1

_VERSION, _RELEASE = 0x0110, 0x0100  # of UVC, of this camera
_CLASS = (0xEF, 2, 1)
"""Interfaces that belong together are announced."""
_ASSOCIATION = 11
_VIDEO, _CONTROL, _STREAMING, _COLLECTION = 0x0E, 1, 2, 3
_CLASS_INTERFACE = 0x24
_HEADER, _INPUT_TERMINAL, _OUTPUT_TERMINAL, _PROCESSING_UNIT = 1, 2, 3, 5
_OUTPUT = 3
_CAMERA, _USB_STREAM = 0x0201, 0x0101
_INPUT_HEADER, _UNCOMPRESSED, _MJPEG, _COLOUR = 1, 4, 6, 13
_COLOUR_SPACE = (1, 1, 4)
"""BT.709, its gamma, the matrix of SMPTE 170M: what nearly all cameras say."""
_GUID_END = bytes.fromhex("00001000800000aa00389b71")
_GUIDS = {PixelFormat.GREY: b"Y800", PixelFormat.YUYV: b"YUY2", PixelFormat.NV12: b"NV12"}


@dataclass(frozen=True, slots=True)
class UvcIdentity:
    """Properties that differ between cameras.

    Attributes:
        product: the name.
        serial: None leaves the string out, as many cameras do.
        super_speed: on a USB 3 port; else USB 2 high speed.
        modes: formats and sizes, those of a format together, the best first.
        without: settings that it has not, names of ``CONTROLS``.
    """

    product: str = "Emulated UVC camera"
    serial: str | None = "00000001"
    super_speed: bool = True
    modes: tuple[Mode, ...] = MODES
    without: frozenset[str] = frozenset()

    @property
    def controls(self) -> frozenset[str]:
        """Names of its settings."""
        return frozenset(CONTROLS) - self.without

    def describe(self, kind: int, index: int) -> bytes | None:
        """Returns a descriptor of the given type and index, or None if the camera has none."""
        if kind == DEVICE:
            return describe_device(
                _CLASS,
                (VENDOR_ID, PRODUCT_ID),
                _RELEASE,
                has_serial=self.serial is not None,
                super_speed=self.super_speed,
            )
        if kind == CONFIGURATION and index == 0:
            body = self._association() + self._control() + self._streaming()
            return describe_configuration(
                body, n_interfaces=2, milliamperes=240, super_speed=self.super_speed
            )
        if kind == STRING:
            return describe_string(index, {1: "NeuroTouch", 2: self.product, 3: self.serial})
        if kind == BOS and self.super_speed:
            return describe_bos()
        if kind == QUALIFIER and not self.super_speed:
            return describe_qualifier(_CLASS)
        return None

    def _association(self) -> bytes:
        return struct.pack("<BBBBBBBB", 8, _ASSOCIATION, 0, 2, _VIDEO, _COLLECTION, 0, 0)

    def _control(self) -> bytes:
        interface = struct.pack(
            "<BBBBBBBBB", 9, INTERFACE, CONTROL_INTERFACE, 0, 0, _VIDEO, _CONTROL, 0, 0
        )
        units = (
            _piece(_INPUT_TERMINAL, "<BHBBHHHB", TERMINAL, _CAMERA, 0, 0, 0, 0, 0, 3)
            + self._list_controls(TERMINAL),
            _piece(_PROCESSING_UNIT, "<BBHB", PROCESSING, TERMINAL, 0, 3)
            + self._list_controls(PROCESSING)
            + bytes(2),
            _piece(_OUTPUT_TERMINAL, "<BHBBB", _OUTPUT, _USB_STREAM, 0, PROCESSING, 0),
        )
        body = b"".join(map(_close, units))
        length = 13 + len(body)
        header = _piece(_HEADER, "<HHIBB", _VERSION, length, CLOCK_HZ, 1, STREAMING_INTERFACE)
        return interface + _close(header) + body

    def _list_controls(self, unit: int) -> bytes:
        bits = sum(1 << CONTROLS[name].bit for name in self.controls if CONTROLS[name].unit == unit)
        return bits.to_bytes(3, "little")

    def _streaming(self) -> bytes:
        interface = struct.pack(
            "<BBBBBBBBB", 9, INTERFACE, STREAMING_INTERFACE, 0, 1, _VIDEO, _STREAMING, 0, 0
        )
        groups = group_by_format(self.modes)
        formats = b"".join(_format(n + 1, modes) for n, modes in enumerate(groups))
        length = 13 + len(groups) + len(formats)
        capabilities = (0, _OUTPUT, 0, 0, 0, 1)
        header = _piece(
            _INPUT_HEADER, "<BHBBBBBBB", len(groups), length, DATA_ENDPOINT, *capabilities
        ) + bytes(len(groups))
        endpoint = describe_bulk_endpoint(DATA_ENDPOINT, burst=15, super_speed=self.super_speed)
        return interface + _close(header) + formats + endpoint


def _format(number: int, modes: Sequence[Mode]) -> bytes:
    """Returns the descriptors of a format and its sizes."""
    pixel_format = modes[0].pixel_format
    if pixel_format is PixelFormat.MJPEG:
        head = _piece(_MJPEG, "<BBBBBBBB", number, len(modes), 1, 1, 0, 0, 0, 0)
    else:
        kind = _GUIDS[pixel_format] + _GUID_END
        bits = pixel_format.bits_per_pixel
        head = _piece(_UNCOMPRESSED, "<BB16sBBBBBB", number, len(modes), kind, bits, 1, 0, 0, 0, 0)
    kind_of_size = (_MJPEG if pixel_format is PixelFormat.MJPEG else _UNCOMPRESSED) + 1
    sizes = (_size(kind_of_size, n + 1, mode) for n, mode in enumerate(modes))
    colour = _piece(_COLOUR, "<BBB", *_COLOUR_SPACE)
    return _join((head, *sizes, colour))


def _size(kind: int, number: int, mode: Mode) -> bytes:
    """Returns the descriptor of a size and its intervals."""
    # bit/s = bits * 10**7 / interval; the field ends at 32 bits.
    rates = [min(80_000_000 * mode.max_bytes // t, 0xFFFFFFFF) for t in mode.intervals]
    head = _piece(
        kind,
        "<BBHHIIIIB",
        *(number, 0, mode.width, mode.height, min(rates), max(rates), mode.max_bytes),
        *(mode.intervals[0], len(mode.intervals)),
    )
    return head + struct.pack(f"<{len(mode.intervals)}I", *sorted(mode.intervals))


def _piece(subtype: int, layout: str, *values: int | bytes) -> bytes:
    """Returns a descriptor of the class, without its length."""
    return bytes([_CLASS_INTERFACE, subtype]) + struct.pack(layout, *values)


def _close(piece: bytes) -> bytes:
    """Puts the length in front."""
    return bytes([1 + len(piece)]) + piece


def _join(pieces: Iterable[bytes]) -> bytes:
    return b"".join(map(_close, pieces))

"""The report of a HID pad: its descriptor, and values to bytes and back.

The report has no id. First the axes of 16 bits, then those of 8 bits, then the hat in half a byte,
then one bit for each button; little endian, as HID is.
"""

import struct
from itertools import groupby
from typing import Final

from evdev import ecodes

from neurotouch_hid.device.outputs.spec import Control

# Items of a descriptor, by the HID specification 1.11, section 6.2.2; each takes this many bytes.
_USAGE_PAGE, _USAGE = 0x05, 0x09
_COLLECTION, _END = 0xA1, 0xC0
_LOGICAL_MIN, _LOGICAL_MAX = 0x14, 0x24
_PHYSICAL_MIN, _PHYSICAL_MAX = 0x34, 0x44
_UNIT, _SIZE, _COUNT, _INPUT = 0x65, 0x75, 0x95, 0x81

_DESKTOP, _BUTTON = 0x01, 0x09
_GAMEPAD, _MULTI_AXIS = 0x05, 0x08
_PHYSICAL, _APPLICATION = 0x00, 0x01
_VALUE, _CONSTANT, _VALUE_OR_NULL = 0x02, 0x01, 0x42
_DEGREES = 0x14

_AXES: Final = {
    ecodes.ABS_X: 0x30,
    ecodes.ABS_Y: 0x31,
    ecodes.ABS_Z: 0x32,
    ecodes.ABS_RX: 0x33,
    ecodes.ABS_RY: 0x34,
    ecodes.ABS_RZ: 0x35,
}
_EV_ABS: Final[int] = ecodes.EV_ABS
_HAT: Final = 0x39
_HAT_CODES: Final = (ecodes.ABS_HAT0X, ecodes.ABS_HAT0Y)
_HAT_PLACES: Final = ((0, 0), (0, -1), (1, -1), (1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1))
"""(x, y) of each value of the hat: 0 is centred, 1 up, then clockwise."""


class ReportFormat:
    """Packs the values of a pad's controls into a report, and unpacks them.

    Args:
        controls: the controls, in the order of the values.

    Attributes:
        descriptor: describes the report to the kernel and to programs.
    """

    def __init__(self, controls: tuple[Control, ...]) -> None:
        self._controls = controls
        places = range(len(controls))
        axes = [at for at in places if controls[at].code in _AXES and _is_axis(controls[at])]
        self._axes = sorted(axes, key=lambda at: not _is_wide(controls[at]))
        self._hat = tuple(
            next(at for at in places if _is_axis(controls[at]) and controls[at].code == code)
            for code in _HAT_CODES
        )
        self._buttons = [at for at in places if not _is_axis(controls[at])]
        letters = "".join("h" if _is_wide(controls[at]) else "B" for at in self._axes)
        self._n_button_bytes = (len(self._buttons) + 7) // 8
        self._struct = struct.Struct(f"<{letters}B{self._n_button_bytes}s")
        self.descriptor = self._describe()

    def pack(self, values: tuple[int, ...]) -> bytes:
        """Returns the report with these values."""
        axes = (values[at] for at in self._axes)
        x, y = (values[at] for at in self._hat)
        down = sum(values[at] << bit for bit, at in enumerate(self._buttons))
        buttons = down.to_bytes(self._n_button_bytes, "little")
        return self._struct.pack(*axes, _HAT_PLACES.index((x, y)), buttons)

    def unpack(self, report: bytes) -> tuple[int, ...]:
        """Returns the values in a report.

        Raises:
            ValueError: it has another length.
        """
        if len(report) != self._struct.size:
            raise ValueError(f"a report has {self._struct.size} bytes, not {len(report)}")
        *axes, hat, buttons = self._struct.unpack(report)
        values = [0] * len(self._controls)
        for at, value in zip(self._axes, axes, strict=True):
            values[at] = value
        place = hat & 0x0F
        direction = _HAT_PLACES[place if place < len(_HAT_PLACES) else 0]
        for at, value in zip(self._hat, direction, strict=True):
            values[at] = value
        down = int.from_bytes(buttons, "little")
        for bit, at in enumerate(self._buttons):
            values[at] = down >> bit & 1
        return tuple(values)

    def _describe(self) -> bytes:
        """Returns the descriptor.

        The outer collection is a multi-axis controller, because for a game pad the kernel would
        declare a fuzz of 1/256 of the range, and a released stick would not come back to 0. It
        names buttons by the inner collection, the game pad.
        """
        return b"".join(
            (
                *(bytes((_USAGE_PAGE, _DESKTOP, _USAGE, _MULTI_AXIS, _COLLECTION, _APPLICATION)),),
                *(bytes((_USAGE_PAGE, _DESKTOP, _USAGE, _GAMEPAD, _COLLECTION, _PHYSICAL)),),
                *self._describe_axes(),
                self._describe_hat(),
                self._describe_buttons(),
                bytes((_END, _END)),
            )
        )

    def _describe_axes(self) -> list[bytes]:
        groups = groupby(
            (self._controls[at] for at in self._axes), lambda axis: (axis.minimum, axis.maximum)
        )
        described = []
        for (minimum, maximum), group in groups:
            axes = list(group)
            size = 16 if _is_wide(axes[0]) else 8
            described += [
                *(bytes((_USAGE, _AXES[axis.code])) for axis in axes),
                _pack_number(_LOGICAL_MIN, minimum),
                _pack_number(_LOGICAL_MAX, maximum),
                bytes((_SIZE, size, _COUNT, len(axes), _INPUT, _VALUE)),
            ]
        return described

    def _describe_hat(self) -> bytes:
        return b"".join(
            (
                bytes((_USAGE, _HAT)),
                _pack_number(_LOGICAL_MIN, 1),
                _pack_number(_LOGICAL_MAX, 8),
                _pack_number(_PHYSICAL_MIN, 0),
                _pack_number(_PHYSICAL_MAX, 315),
                bytes((_UNIT, _DEGREES, _SIZE, 4, _COUNT, 1, _INPUT, _VALUE_OR_NULL)),
                bytes((_COUNT, 1, _INPUT, _CONSTANT)),
                _pack_number(_PHYSICAL_MAX, 0),
                bytes((_UNIT, 0)),
            )
        )

    def _describe_buttons(self) -> bytes:
        usages = [self._controls[at].code - ecodes.BTN_GAMEPAD + 1 for at in self._buttons]
        described = (
            bytes((_USAGE_PAGE, _BUTTON)),
            *(bytes((_USAGE, usage)) for usage in usages),
            _pack_number(_LOGICAL_MIN, 0),
            _pack_number(_LOGICAL_MAX, 1),
            bytes((_SIZE, 1, _COUNT, len(usages), _INPUT, _VALUE)),
        )
        left = -len(usages) % 8
        return b"".join(described) + (bytes((_COUNT, left, _INPUT, _CONSTANT)) if left else b"")


def _is_axis(control: Control) -> bool:
    return control.type == _EV_ABS


def _is_wide(control: Control) -> bool:
    return control.minimum < 0 or control.maximum > 0xFF


def _pack_number(item: int, value: int) -> bytes:
    """Returns an item with a signed number in as few bytes as possible."""
    for size_code, letter, reach in ((1, "b", 0x80), (2, "h", 0x8000)):
        if -reach <= value < reach:
            return bytes((item | size_code,)) + struct.pack(f"<{letter}", value)
    raise ValueError(f"{value} needs more than two bytes")

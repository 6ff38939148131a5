"""The camera's settings: exposure, gain, focus and so on, with their ranges (UVC 1.1, 4.2.2)."""

from dataclasses import dataclass
from enum import IntEnum

from neurotouch_devtools.emulator.faults import FaultError, FaultKind


class Request(IntEnum):
    """The requests of the class."""

    SET_CUR = 0x01
    GET_CUR = 0x81
    GET_MIN = 0x82
    GET_MAX = 0x83
    GET_RES = 0x84
    GET_LEN = 0x85
    GET_INFO = 0x86
    GET_DEF = 0x87


TERMINAL, PROCESSING = 1, 2
"""Numbers of the units with settings."""

MANUAL_EXPOSURE, AUTO_EXPOSURE = 0b0001, 0b1000
"""Values of the exposure mode; automatic means that the camera chooses the time."""

_CAN_GET, _CAN_SET, _IS_AUTOMATIC = 0b001, 0b010, 0b100
_ERROR_CODE_SELECTOR = 2
_NO_ERROR, _WRONG_STATE, _OUT_OF_RANGE, _UNKNOWN_CONTROL, _UNKNOWN_REQUEST = 0, 2, 4, 6, 7


@dataclass(frozen=True, slots=True)
class Control:
    """One setting.

    Attributes:
        unit: the unit that it belongs to.
        selector: its number there.
        bit: its place among the bits by which the unit lists its settings.
        n_bytes: bytes of a value.
        least: smallest value.
        most: greatest value.
        step: the step between values; of the exposure mode, the bits that may be set.
        default: value after plugging in.
        automatic: the setting that switches this one to automatic, and its value there.
    """

    unit: int
    selector: int
    bit: int
    n_bytes: int
    least: int
    most: int
    step: int
    default: int
    automatic: tuple[str, int] | None = None

    def write(self, value: int) -> bytes:
        """Returns the bytes of a value."""
        return value.to_bytes(self.n_bytes, "little", signed=self.least < 0)

    def read(self, data: bytes) -> int:
        """Returns the value of some bytes."""
        return int.from_bytes(data, "little", signed=self.least < 0)


_BOTH = MANUAL_EXPOSURE | AUTO_EXPOSURE
CONTROLS = {
    "auto_exposure": Control(TERMINAL, 0x02, 1, 1, 0, _BOTH, _BOTH, AUTO_EXPOSURE),
    "exposure": Control(TERMINAL, 0x04, 3, 4, 1, 5000, 1, 157, ("auto_exposure", AUTO_EXPOSURE)),
    "autofocus": Control(TERMINAL, 0x08, 17, 1, 0, 1, 1, 1),
    "focus": Control(TERMINAL, 0x06, 5, 2, 0, 250, 5, 0, ("autofocus", 1)),
    "brightness": Control(PROCESSING, 0x02, 0, 2, -64, 64, 1, 0),
    "gain": Control(PROCESSING, 0x04, 9, 2, 0, 100, 1, 0),
    "power_line_frequency": Control(PROCESSING, 0x05, 10, 1, 0, 2, 1, 1),
    "auto_white_balance": Control(PROCESSING, 0x0B, 12, 1, 0, 1, 1, 1),
    "white_balance": Control(
        PROCESSING, 0x0A, 6, 2, 2800, 6500, 1, 4600, ("auto_white_balance", 1)
    ),
}
"""All settings that the camera can have. Exposure is in units of 100 µs, white balance in kelvin.
Only exposure has an effect, on the rate; the pictures stay as they are."""


class Controls:
    """The settings of one camera and their values.

    Args:
        names: the settings that it has.
    """

    def __init__(self, names: frozenset[str]) -> None:
        self._controls = {name: CONTROLS[name] for name in CONTROLS if name in names}
        self._values = {name: control.default for name, control in self._controls.items()}
        self._error = _NO_ERROR

    @property
    def values(self) -> dict[str, int]:
        """The values, by name."""
        return dict(self._values)

    @property
    def exposure_us(self) -> int:
        """The chosen time of exposure, 0 if the camera chooses it."""
        manual = self._values.get("auto_exposure", MANUAL_EXPOSURE) == MANUAL_EXPOSURE
        return 100 * self._values["exposure"] if manual and "exposure" in self._values else 0

    def answer(self, unit: int, selector: int, request: int, data: bytes) -> bytes:
        """Carries out a request to a unit.

        Raises:
            FaultError: STALL; the host asks for the reason afterwards.
        """
        if (unit, selector) == (0, _ERROR_CODE_SELECTOR):
            return self._describe_error(request)
        found = [n for n, c in self._controls.items() if (c.unit, c.selector) == (unit, selector)]
        if not found:
            raise self._refuse(_UNKNOWN_CONTROL)
        (name,) = found
        if request == Request.SET_CUR:
            self._set(name, data)
            self._error = _NO_ERROR
            return b""
        answer = self._get(name, request)
        self._error = _NO_ERROR
        return answer

    def _get(self, name: str, request: int) -> bytes:
        control = self._controls[name]
        if request == Request.GET_LEN:
            return control.n_bytes.to_bytes(2, "little")
        if request == Request.GET_INFO:
            automatic = _IS_AUTOMATIC if self._is_automatic(control) else 0
            return bytes([_CAN_GET | _CAN_SET | automatic])
        values: dict[int, int] = {
            Request.GET_CUR: self._values[name],
            Request.GET_MIN: control.least,
            Request.GET_MAX: control.most,
            Request.GET_RES: control.step,
            Request.GET_DEF: control.default,
        }
        if request not in values:
            raise self._refuse(_UNKNOWN_REQUEST)
        return control.write(values[request])

    def _set(self, name: str, data: bytes) -> None:
        control = self._controls[name]
        value = control.read(data)
        if self._is_automatic(control):
            raise self._refuse(_WRONG_STATE)
        chosen = name != "auto_exposure" or value in {MANUAL_EXPOSURE, AUTO_EXPOSURE}
        if len(data) != control.n_bytes or not control.least <= value <= control.most or not chosen:
            raise self._refuse(_OUT_OF_RANGE)
        self._values[name] = value

    def _is_automatic(self, control: Control) -> bool:
        if control.automatic is None:
            return False
        name, value = control.automatic
        return self._values.get(name) == value

    def _refuse(self, reason: int) -> FaultError:
        self._error = reason
        return FaultError(FaultKind.STALL)

    def _describe_error(self, request: int) -> bytes:
        match request:
            case Request.GET_CUR:
                return bytes([self._error])
            case Request.GET_INFO:
                return bytes([_CAN_GET])
            case Request.GET_LEN:
                return b"\1\0"
            case _:
                raise FaultError(FaultKind.STALL)

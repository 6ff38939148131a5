"""The agreement of host and camera on a mode: probe and commit controls (UVC 1.1, 4.3.1.1)."""

import struct
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from neurotouch_devtools.emulator.faults import FaultError, FaultKind
from neurotouch_devtools.emulator.uvc.controls import Request
from neurotouch_devtools.emulator.uvc.modes import Mode, PixelFormat

CLOCK_HZ = 1_000_000
"""Of the time stamps in the payloads."""

_PROBE, _COMMIT = 1, 2
_AGREED = struct.Struct("<HBBIHHHHHIIIBBBB")
_DELAY_MS = 5
_HINT_INTERVAL = 1
_FRAMING = 0b11  # the payloads say which picture they belong to, and where it ends


@dataclass(frozen=True, slots=True)
class Agreement:
    """A mode and one of its intervals, in units of 100 ns, on which host and camera agree."""

    mode: Mode
    interval: int


class Negotiation:
    """Answers the requests that choose a mode.

    Args:
        modes: those on offer, the modes of a format together.
        payload_bytes: the size of a payload.
        begin: called when the host has chosen: the stream begins.
    """

    def __init__(
        self, modes: Sequence[Mode], payload_bytes: int, begin: Callable[[Agreement], None]
    ) -> None:
        self._formats = group_by_format(modes)
        self._payload_bytes, self._begin = payload_bytes, begin
        self._default = Agreement(modes[0], modes[0].intervals[0])
        self._current = self._default

    def answer(self, selector: int, request: int, data: bytes) -> bytes:
        """Carries out a request.

        Raises:
            FaultError: STALL, for what does not exist.
        """
        if selector not in {_PROBE, _COMMIT}:
            raise FaultError(FaultKind.STALL)
        match request:
            case Request.SET_CUR:
                self._current = self._read(data)
                if selector == _COMMIT:
                    self._begin(self._current)
                return b""
            case Request.GET_CUR:
                return self._write(self._current)
            case Request.GET_DEF:
                return self._write(self._default)
            case Request.GET_MIN | Request.GET_MAX:
                return self._write(self._current)
            case Request.GET_LEN:
                return _AGREED.size.to_bytes(2, "little")
            case Request.GET_INFO:
                return b"\x03"
            case _:
                raise FaultError(FaultKind.STALL)

    def _read(self, data: bytes) -> Agreement:
        """Returns the nearest to what the host wishes."""
        if len(data) != _AGREED.size:
            raise FaultError(FaultKind.STALL)
        _, n_format, n_size, interval, *_ = _AGREED.unpack(data)
        modes = self._formats[_clamp(n_format, len(self._formats))]
        mode = modes[_clamp(n_size, len(modes))]
        return Agreement(mode, min(mode.intervals, key=lambda offered: abs(offered - interval)))

    def _write(self, agreed: Agreement) -> bytes:
        of_format = [agreed.mode in modes for modes in self._formats].index(True)
        of_size = self._formats[of_format].index(agreed.mode)
        return _AGREED.pack(
            *(_HINT_INTERVAL, of_format + 1, of_size + 1, agreed.interval),
            *(0, 0, 0, 0, _DELAY_MS),
            *(agreed.mode.max_bytes, self._payload_bytes, CLOCK_HZ),
            *(_FRAMING, 0, 0, 0),
        )


def group_by_format(modes: Sequence[Mode]) -> list[list[Mode]]:
    """Returns the modes of each format."""
    groups: dict[PixelFormat, list[Mode]] = {}
    for mode in modes:
        groups.setdefault(mode.pixel_format, []).append(mode)
    return list(groups.values())


def _clamp(number: int, count: int) -> int:
    """Returns the index of a number that counts from 1."""
    return min(max(number, 1), count) - 1

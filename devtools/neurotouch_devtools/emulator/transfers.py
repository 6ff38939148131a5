"""Endpoint 0x82: bulk transfers with the stream, and their faults."""

import numpy as np

from neurotouch_devtools.emulator.camera import EmulatedCamera
from neurotouch_devtools.emulator.descriptors import DATA_ENDPOINT
from neurotouch_devtools.emulator.faults import FaultError, FaultKind, Stage

_END_TRANSFER = frozenset({FaultKind.UNPLUG, FaultKind.TIMEOUT, FaultKind.LOST, FaultKind.PROTOCOL})
_GARBAGE_SEED = 1
_ROW_CODE, _CODE_MASK = 0x10, 0xF0
"""Bit in the high byte of a word."""


class DataEndpoint:
    """Answers the bulk transfers from one camera.

    Args:
        camera: the camera.

    Attributes:
        address: the endpoint's address.
    """

    address = DATA_ENDPOINT

    def __init__(self, camera: EmulatedCamera) -> None:
        self._camera = camera
        self._halted = False
        self._random = np.random.default_rng(_GARBAGE_SEED)

    def answer(self, length: int) -> bytes | None:
        """Returns the data of a transfer of ``length`` bytes, or None while there is none.

        Raises:
            FaultError: the transfer ends otherwise. With TIMEOUT and LOST it never ends.
        """
        if self._halted:
            raise FaultError(FaultKind.STALL)
        data = self._camera.read(length)
        if data is None:
            return None
        kind = self._camera.script.strike(Stage.STREAM)
        if kind is None or kind is FaultKind.STALE:
            return data
        if kind is FaultKind.STALL:
            self._halted = True
        if kind in _END_TRANSFER or self._halted:
            self._camera.put_back(data)
            raise FaultError(kind)
        if kind is FaultKind.BABBLE:
            raise FaultError(kind)
        if kind in {FaultKind.SHORT, FaultKind.ODD}:
            n_bytes = _cut_after_row(data) if kind is FaultKind.SHORT else (len(data) - 1) | 1
            self._camera.put_back(data[n_bytes:])
            return data[:n_bytes]
        if kind is FaultKind.MISSING:
            return data[1:]
        if kind is FaultKind.GARBAGE:
            return self._random.bytes(len(data))
        self._camera.disturb(kind)
        return data

    def clear_halt(self) -> None:
        """Ends a stall for the host; the camera drops waiting data."""
        self._halted = False
        self._camera.flush()


def _cut_after_row(data: bytes) -> int:
    """Returns the cut in bytes: behind the first row word, or in the middle without one."""
    for high in range(1, len(data) - 2, 2):
        if data[high] & _CODE_MASK == _ROW_CODE:
            return high + 1
    return len(data) // 4 * 2 or len(data)

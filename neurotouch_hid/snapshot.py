"""The newest state of the pipeline as bytes: a head of JSON, then all 177 markers.

4 bytes   length of the head, little-endian
head      UTF-8 JSON, see ``StateEncoder.encode``
708 bytes int16 (177, 2): how far each marker is from its own rest, x and y, in 0.01 mm
177 bytes uint8: 1 where the marker is measured, 0 where it is a guess
"""

import json
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import N_MARKERS, fit_rig
from neurotouch_hid.messages import MarkerField

STEP_MM: Final = 0.01


class MarkerWriter:
    """Writes markers in steps; the rig is fitted again only when the rest has changed."""

    def __init__(self) -> None:
        self._rest_px: NDArray[np.float32] | None = None
        self._to_steps: np.complex64 | None = None

    def write(self, markers: MarkerField) -> bytes:
        """Returns displacements and flags of all markers; zeros while no gel has been found."""
        steps = self._find_moved(markers)
        if steps is None:
            return bytes(5 * N_MARKERS)
        return steps.astype(np.int16).tobytes() + markers.valid.tobytes()

    def measure(self, markers: MarkerField) -> NDArray[np.float32]:
        """Returns how far each marker is from its rest: (177, 2) float32, mm; zeros if unknown."""
        steps = self._find_moved(markers)
        if steps is None:
            return np.zeros((N_MARKERS, 2), np.float32)
        return steps * np.float32(STEP_MM)

    def _find_moved(self, markers: MarkerField) -> NDArray[np.float32] | None:
        if markers.rest_px is not self._rest_px:
            self._rest_px = markers.rest_px
            self._to_steps = _find_steps(markers.rest_px)
        if self._to_steps is None:
            return None
        moved_px = (markers.position_px - markers.rest_px).view(np.complex64)
        return (moved_px * self._to_steps).view(np.float32)


def _find_steps(rest_px: NDArray[np.float32]) -> np.complex64 | None:
    """What turns and scales displacements x + iy in pixels to steps; None while nobody knows.

    One product of complex numbers instead of a product of matrices, whose library is large and cold
    when it is called thirty times a second.
    """
    if not np.isfinite(rest_px).all():
        return None
    x, y = fit_rig(rest_px).vector_to_mm(np.array([[1.0, 0.0]]))[0] / STEP_MM
    return np.complex64(complex(x, y))


def pack(head: bytes, markers: bytes) -> bytes:
    """The bytes of a state."""
    return len(head).to_bytes(4, "little") + head + markers


def read_head(state: bytes) -> dict[str, Any]:
    """Returns the head of a state."""
    head: dict[str, Any] = json.loads(state[4 : _find_markers(state)])
    return head


def read_markers(state: bytes) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    """Returns the markers of a state.

    Returns:
        (177, 2) float32, how far each marker is from its rest, columns x, y, in mm; and (177,)
        bool, True where the marker is measured.
    """
    begin = _find_markers(state)
    steps = np.frombuffer(state, np.int16, 2 * N_MARKERS, begin).reshape(-1, 2)
    valid = np.frombuffer(state, np.bool_, N_MARKERS, begin + steps.nbytes)
    return steps * np.float32(STEP_MM), valid


def _find_markers(state: bytes) -> int:
    return 4 + int.from_bytes(state[:4], "little")

"""Finds a regular pattern in a picture in which the dots themselves cannot be made out."""

import math
from functools import cache
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import Gel
from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX

_SIZE: Final = 384  # of the spectrum; its middle is the frequency 0
_MIDDLE: Final = _SIZE // 2 - 1
_USUAL: Final = _SIZE / 10.0  # frequency of the usual pattern
_RATIO: Final = math.log(4.0)  # of patterns that are searched, to either side
_CLIP: Final = (-60.0, 99.8)  # grey levels and percentile: a lamp is no pattern
_PEAK: Final = 25.0  # times the usual strength at that frequency; pictures without dots reach 16
_DIAGONAL: Final = 0.3  # of that peak is the true one, if the diagonal of the pattern is stronger


class Pattern(NamedTuple):
    """A square pattern of dots.

    Attributes:
        px_per_mm: its scale.
        blur_px: how blurred the dots are, standard deviation.
    """

    px_per_mm: float
    blur_px: float


class _Tables(NamedTuple):
    """Tables that depend on the size of the spectrum only.

    Attributes:
        ring: how far each frequency is from the middle, (383, 383) int.
        by_ring: for each such distance, the places in the flattened spectrum, int.
        is_searched: whether a pattern of this frequency is searched, (383, 383) bool.
        window: fades a picture out towards its edges, (260, 346) float.
    """

    ring: NDArray[np.intp]
    by_ring: list[NDArray[np.intp]]
    is_searched: NDArray[np.bool_]
    window: NDArray[np.float64]


@cache  # 6 MB, which no start needs: only a gel that is not found is searched so
def _make_tables() -> _Tables:
    far = np.hypot(*np.mgrid[-_MIDDLE : _MIDDLE + 1, -_MIDDLE : _MIDDLE + 1])
    ring = far.astype(np.intp)
    ends = np.cumsum(np.bincount(ring.ravel()))
    by_ring = np.split(np.argsort(ring, axis=None, kind="stable"), ends[:-1])
    is_searched = np.abs(np.log(np.maximum(far, 1.0) / _USUAL)) < _RATIO
    window = np.hanning(SENSOR_HEIGHT_PX)[:, None] * np.hanning(SENSOR_WIDTH_PX)
    return _Tables(ring, by_ring, is_searched, window)


def find_pattern(pixels: NDArray[np.uint8], gel: Gel) -> Pattern | None:
    """Returns the square pattern of a gel in a picture, (260, 346) uint8; None if there is none.

    A square pattern has the same spectrum after a quarter turn. The blur is known from how much
    weaker the diagonal of the pattern is than its side.
    """
    tables = _make_tables()
    pixels = gel.lighten(pixels)
    grey = pixels - float(np.median(pixels))
    grey = np.clip(grey, _CLIP[0], np.percentile(grey, _CLIP[1]))
    spectrum = np.fft.fft2((grey - grey.mean()) * tables.window, (_SIZE, _SIZE))
    strength = np.abs(np.fft.fftshift(spectrum))[1:, 1:]
    power = strength * np.rot90(strength)
    usual = [np.median(power.ravel()[places]) for places in tables.by_ring]
    peak = tables.is_searched * power / np.maximum(np.array(usual)[tables.ring], 1e-9)
    row, column = np.unravel_index(peak.argmax(), peak.shape)
    if peak[row, column] < _PEAK:
        return None
    side = complex(int(column) - _MIDDLE, int(row) - _MIDDLE)
    to_diagonal = 1 + 1j
    if _find_largest(peak, side / to_diagonal) > _DIAGONAL * peak[row, column]:
        side /= to_diagonal
    pitch_px = _SIZE / abs(side)
    ratio = _find_largest(power, side) / max(_find_largest(power, side * to_diagonal), 1e-9)
    variance_px2 = (pitch_px / (2.0 * math.pi)) ** 2 * math.log(max(ratio, 1.0))
    dot_px2 = (gel.dot_mm / gel.pitch_mm * pitch_px) ** 2 / 16.0
    return Pattern(pitch_px / gel.pitch_mm, math.sqrt(max(variance_px2 - dot_px2, 0.0)))


def _find_largest(values: NDArray[np.float64], at: complex) -> float:
    """Returns the largest value around a frequency; 0 outside of the spectrum."""
    row, column = round(at.imag) + _MIDDLE, round(at.real) + _MIDDLE
    near = values[max(row - 1, 0) : max(row + 2, 0), max(column - 1, 0) : max(column + 2, 0)]
    return float(near.max(initial=0.0))

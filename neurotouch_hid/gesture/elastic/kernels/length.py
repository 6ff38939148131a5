"""The length of three numbers, as exact as Python's ``math.hypot``; that of a kernel is not."""

import math

from neurotouch_hid.process.kernel_cache import kernel

_SPLIT = 134217729.0  # 2**27 + 1: cuts a float into two halves, whose products are exact


@kernel(inline="always")
def _square(x: float) -> tuple[float, float]:
    """Returns a square and its rounding error [Dekker 1971]."""
    t = x * _SPLIT
    high = t - (t - x)
    low = x - high
    square = x * x
    return square, ((high * high - square) + 2.0 * high * low) + low * low


@kernel(inline="always")
def _add(total: float, error: float, x: float) -> tuple[float, float]:
    """Returns a sum with one square more, and its rounding error [Knuth, 2Sum]."""
    square, part = _square(x)
    more = total + square
    took = more - total
    return more, error + ((total - (more - took)) + (square - took)) + part


@kernel
def find_length(x: float, y: float, z: float) -> float:
    """Returns the square root of the sum of three squares, which is positive."""
    total, error = _square(x)
    total, error = _add(total, error, y)
    total, error = _add(total, error, z)
    length = math.sqrt(total + error)
    square, part = _square(length)
    return float(length + ((total - square) - part + error) / (2.0 * length))

"""Compiled loops over all markers: trust in each, what they share, how far they lie about it."""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@njit(cache=True, nogil=True)
def weigh_markers(
    use: NDArray[np.bool_], moved: Floats, residual: Floats, limit_mm2: float, weight: Floats
) -> tuple[float, float]:
    """Trust in each marker: one that was far off the last fit lost its dot.

    Args:
        use: (n,), measured markers.
        moved: (n, 2) mm, their displacement.
        residual: (n, 2) mm, of the last fit.
        limit_mm2: a marker so far off, squared, is trusted by half.
        weight: (n,) 0..1, written.

    Returns:
        The sum of the weights, and the weighted sum of the squared displacements, mm².
    """
    total, field = 0.0, 0.0
    for i in range(len(use)):
        far = (residual[i, 0] * residual[i, 0] + residual[i, 1] * residual[i, 1]) / limit_mm2
        weight[i] = 1.0 / (1.0 + far * far) if use[i] else 0.0
        total += weight[i]
        field += weight[i] * (moved[i, 0] * moved[i, 0] + moved[i, 1] * moved[i, 1])
    return total, field


@njit(cache=True, nogil=True)
def find_common(moved: Floats, weight: Floats) -> tuple[float, float]:
    """The median displacement of the trusted markers, x and y in mm; at least one is trusted.

    Args:
        moved: (n, 2) mm.
        weight: (n,), 0 for markers without any trust.
    """
    x, y = np.empty(len(weight)), np.empty(len(weight))
    n = 0
    for i in range(len(weight)):
        if weight[i] > 0.0:
            x[n], y[n] = moved[i, 0], moved[i, 1]
            n += 1
    return float(np.median(x[:n])), float(np.median(y[:n]))


@njit(cache=True, nogil=True)
def measure_sway(moved: Floats, weight: Floats, x: float, y: float) -> float:
    """How far three quarters of the trusted markers went along (x, y) at least, mm; not below 0.

    A knock moves all of them; of a touch a quarter, near the clamped rim, feel little.

    Args:
        moved: (n, 2) mm.
        weight: (n,), 0 for markers without any trust; at least one has some.
        x: of their median displacement, mm.
        y: of the same.
    """
    length = math.hypot(x, y)
    if length == 0.0:
        return 0.0
    along, n = np.empty(len(weight)), 0
    for i in range(len(weight)):
        if weight[i] > 0.0:
            along[n] = (moved[i, 0] * x + moved[i, 1] * y) / length
            n += 1
    return max(float(np.partition(along[:n], n // 4)[n // 4]), 0.0)


@njit(cache=True, nogil=True)
def measure_spread(moved: Floats, weight: Floats) -> float:
    """How far markers lie about their common motion: standard deviation of an axis, mm.

    From the median of the distances, so a few that moved do not count.

    Args:
        moved: (n, 2) mm.
        weight: (n,), 0 for markers without any trust; at least one has some.
    """
    x, y = find_common(moved, weight)
    away = np.empty(2 * len(weight))
    n = 0
    for i in range(len(weight)):
        if weight[i] > 0.0:
            away[n], away[n + 1] = abs(moved[i, 0] - x), abs(moved[i, 1] - y)
            n += 2
    return 1.4826 * float(np.median(away[:n]))

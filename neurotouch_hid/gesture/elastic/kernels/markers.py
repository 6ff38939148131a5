"""Computes the trust in each marker, their common motion and their spread about it."""

import math

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.kernels.order_statistics import median, select
from neurotouch_hid.process.kernel_cache import kernel

Floats = NDArray[np.float64]

LONE_SHARE = 0.5
"""If one marker is more than this share of what a finger explains, there is no finger. A fingertip
covers several markers, two or three of them beside the rim, and these move alike."""


@kernel
def weigh_markers(
    use: NDArray[np.bool_], moved: Floats, residual: Floats, limit_mm2: float, weight: Floats
) -> tuple[float, float, float]:
    """Writes the trust in each marker: one far from the last fit probably follows the wrong dot.

    Args:
        use: (n,) bool, measured markers.
        moved: (n, 2) float64 mm, displacement of each marker.
        residual: (n, 2) float64 mm, of the last fit.
        limit_mm2: squared residual that halves the weight.
        weight: (n,) float64 0..1, written.

    Returns:
        The sum of the weights; the weighted sum of the squared displacements, mm²; the sum of the
        squared residuals that the weights hide, mm².
    """
    total, field, hidden = 0.0, 0.0, 0.0
    for i in range(len(use)):
        square = residual[i, 0] * residual[i, 0] + residual[i, 1] * residual[i, 1]
        far = square / limit_mm2
        weight[i] = 1.0 / (1.0 + far * far) if use[i] else 0.0
        hidden += (1.0 - weight[i]) * square if use[i] else 0.0
        total += weight[i]
        field += weight[i] * (moved[i, 0] * moved[i, 0] + moved[i, 1] * moved[i, 1])
    return total, field, hidden


@kernel
def find_common(moved: Floats, weight: Floats) -> tuple[float, float]:
    """Returns the median displacement of the trusted markers, x and y in mm.

    Args:
        moved: (n, 2) float64 mm.
        weight: (n,) float64, 0 for markers without any trust; at least one has some.
    """
    x, y = np.empty(len(weight)), np.empty(len(weight))
    n = 0
    for i in range(len(weight)):
        if weight[i] > 0.0:
            x[n], y[n] = moved[i, 0], moved[i, 1]
            n += 1
    return float(median(x[:n])), float(median(y[:n]))


@kernel
def find_lone(before: Floats, after: Floats, weight: Floats) -> int:
    """Returns the marker to which a finger was fitted, if it is hardly any other's; else -1.

    Such a marker follows a speck: gel that is dragged takes its neighbours along.

    Args:
        before: (n, 2) float64 mm, what was left to explain without the finger.
        after: (n, 2) float64 mm, what is left with it.
        weight: (n,) float64, trust in each marker.
    """
    most, total, lone = 0.0, 0.0, -1
    for i in range(len(weight)):
        square = before[i, 0] * before[i, 0] + before[i, 1] * before[i, 1]
        left = after[i, 0] * after[i, 0] + after[i, 1] * after[i, 1]
        gain = max(weight[i] * (square - left), 0.0)
        total += gain
        if gain > most:
            most, lone = gain, i
    return lone if most > LONE_SHARE * total else -1


@kernel
def measure_sway(moved: Floats, weight: Floats, x: float, y: float) -> float:
    """Returns the distance along (x, y) that three quarters of the trusted markers reach, mm, >= 0.

    A knock moves all markers. A touch hardly moves a quarter of them, near the clamped rim.

    Args:
        moved: (n, 2) float64 mm.
        weight: (n,) float64, 0 for markers without any trust; at least one has some.
        x: of their median displacement, mm.
        y: of their median displacement, mm.
    """
    length = math.hypot(x, y)
    if length == 0.0:
        return 0.0
    along, n = np.empty(len(weight)), 0
    for i in range(len(weight)):
        if weight[i] > 0.0:
            along[n] = (moved[i, 0] * x + moved[i, 1] * y) / length
            n += 1
    return max(float(select(along[:n], n // 4)), 0.0)


@kernel
def measure_spread(moved: Floats, weight: Floats) -> float:
    """Returns the spread of the markers about their common motion: standard deviation, mm an axis.

    It comes from the median of the distances, so a few markers that moved do not count.

    Args:
        moved: (n, 2) float64 mm.
        weight: (n,) float64, 0 for markers without any trust; at least one has some.
    """
    x, y = find_common(moved, weight)
    away = np.empty(2 * len(weight))
    n = 0
    for i in range(len(weight)):
        if weight[i] > 0.0:
            away[n], away[n + 1] = abs(moved[i, 0] - x), abs(moved[i, 1] - y)
            n += 2
    return 1.4826 * float(median(away[:n]))

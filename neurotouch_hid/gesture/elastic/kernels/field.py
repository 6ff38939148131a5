"""Computes the displacement field in closed form: elasticity under a clamped rim."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.process.kernel_cache import kernel

Floats = NDArray[np.float64]

POISSON_RATIO = 0.49  # silicone is nearly incompressible
VIEW_MM = 100.0  # lens to gel: what sinks grows; the true length fits no better [notebook]

N_ROWS = 6
XX, XY, YY, TURN_X, TURN_Y, RATIO = range(N_ROWS)
"""The rows that ``respond_along`` writes: the numbers of ``respond``, then radius over distance, at
most 1."""


@kernel
def rim_window(r2: float, rim_mm: float) -> float:
    """Returns how freely the gel moves at squared distance ``r2`` from its centre, 0..1."""
    root = math.sqrt(math.sqrt(max(1.0 - r2 * (1.0 / (rim_mm * rim_mm)), 1e-3)))
    return root * math.sqrt(root)


@kernel(inline="always")
def measure_arc(x: float) -> float:
    """Returns the arc sine of 0 <= x <= 1, to 1e-10.

    The function of the system's library computes one number at a time. This is arithmetic alone, of
    which a processor does several at once: the arc cosine over the root of 1 - x, as a polynomial
    through 11 Chebyshev points.
    """
    t = 2.0 * x - 1.0
    value = 2.27023410595e-07
    value = value * t - 7.89197451242e-07
    value = value * t + 2.16442692584e-06
    value = value * t - 7.88840377665e-06
    value = value * t + 3.02102715839e-05
    value = value * t - 0.000117490891211
    value = value * t + 0.000482049927453
    value = value * t - 0.00214912170196
    value = value * t + 0.0110293135276
    value = value * t - 0.0760160919456
    value = value * t + 1.48096097939
    return 0.5 * math.pi - math.sqrt(1.0 - x) * value


@kernel
def respond(
    x: float, y: float, window: float, cx: float, cy: float, a: float, rim_mm: float
) -> tuple[float, float, float, float, float]:
    """Returns the response of the gel at (x, y) to one sticking patch of radius ``a`` at (cx, cy).

    The patch is rigid, on an elastic half space, dragged (Mindlin) and turned (Reissner-Sagoci).
    The result is multiplied by the share of the edge's motion that the clamped rim permits.

    Args:
        x: of the point, mm.
        y: of the point, mm.
        window: ``rim_window`` at the point.
        cx: of the patch's centre, mm.
        cy: of the patch's centre, mm.
        a: its radius, mm.
        rim_mm: where the gel is clamped.

    Returns:
        xx, xy, yy of the drag (mm per mm), and x, y of a clockwise turn by 1 rad (mm).
    """
    dx, dy = x - cx, y - cy
    r2 = dx * dx + dy * dy
    if r2 <= a * a:
        return 1.0, 0.0, 1.0, -dy, dx
    ratio = a / math.sqrt(r2)
    arc = measure_arc(ratio)
    b = ratio * math.sqrt(1.0 - ratio * ratio)
    ex, ey = cx + ratio * dx, cy + ratio * dy
    gain = 2.0 / math.pi * window / rim_window(ex * ex + ey * ey, rim_mm)
    along = gain * arc
    shear = gain * POISSON_RATIO / (2.0 - POISSON_RATIO) * b * (ratio * ratio * (1.0 / (a * a)))
    spin = gain * (arc - b)
    cos2, sin2 = (dx * dx - dy * dy) * shear, 2.0 * dx * dy * shear
    return along + cos2, sin2, along - cos2, -spin * dy, spin * dx


@kernel(error_model="numpy")
def respond_along(
    x: Floats,
    y: Floats,
    window: Floats,
    cx: float,
    cy: float,
    a: float,
    rim_mm: float,
    answer: Floats,
) -> None:
    """Writes ``respond`` for many points.

    There are no branches, so a processor takes several points at once.

    Args:
        x: (n,) float64 mm, of the points.
        y: (n,) float64 mm.
        window: (n,) float64, ``rim_window`` at the points.
        cx: of the patch's centre, mm.
        cy: of the patch's centre, mm.
        a: its radius, mm.
        rim_mm: where the gel is clamped.
        answer: (N_ROWS, n) float64, written, row by row.
    """
    per_a2 = 1.0 / (a * a)  # divisions are slow
    for i in range(len(x)):
        dx, dy = x[i] - cx, y[i] - cy
        r2 = dx * dx + dy * dy
        far = a / math.sqrt(r2)
        ratio = far if far < 1.0 else 1.0
        arc = measure_arc(ratio)
        b = ratio * math.sqrt(1.0 - ratio * ratio)
        ex, ey = cx + ratio * dx, cy + ratio * dy
        gain = 2.0 / math.pi * window[i] / rim_window(ex * ex + ey * ey, rim_mm)
        along = gain * arc
        shear = gain * POISSON_RATIO / (2.0 - POISSON_RATIO) * b * (ratio * ratio * per_a2)
        spin = gain * (arc - b)
        cos2, sin2 = (dx * dx - dy * dy) * shear, 2.0 * dx * dy * shear
        is_under = r2 <= a * a
        answer[RATIO, i] = ratio
        answer[XX, i] = 1.0 if is_under else along + cos2
        answer[XY, i] = 0.0 if is_under else sin2
        answer[YY, i] = 1.0 if is_under else along - cos2
        answer[TURN_X, i] = -dy if is_under else -spin * dy
        answer[TURN_Y, i] = dx if is_under else spin * dx


@kernel
def build_compliance(centres: Floats, radii: Floats, rim_mm: float) -> Floats:
    """Returns the motions of all patches per unit of load on each patch.

    Args:
        centres: (k, 2) float64 mm.
        radii: (k,) float64 mm.
        rim_mm: where the gel is clamped.

    Returns:
        (3 k, 3 k) float64; rows and columns are drag x, drag y and turn of each patch.
    """
    k = len(centres)
    matrix = np.zeros((3 * k, 3 * k))
    for i in range(k):
        arm = 0.6 * radii[i]
        for j in range(k):
            for s in range(5):
                ox = arm if s == 1 else (-arm if s == 2 else 0.0)
                oy = arm if s == 3 else (-arm if s == 4 else 0.0)
                x, y = centres[i, 0] + ox, centres[i, 1] + oy
                window = rim_window(x * x + y * y, rim_mm)
                xx, xy, yy, tx, ty = respond(
                    x, y, window, centres[j, 0], centres[j, 1], radii[j], rim_mm
                )
                matrix[3 * i, 3 * j] += xx / 5
                matrix[3 * i, 3 * j + 1] += xy / 5
                matrix[3 * i, 3 * j + 2] += tx / 5
                matrix[3 * i + 1, 3 * j] += xy / 5
                matrix[3 * i + 1, 3 * j + 1] += yy / 5
                matrix[3 * i + 1, 3 * j + 2] += ty / 5
                turn = 1.0 / (4.0 * arm * arm)
                matrix[3 * i + 2, 3 * j] += (ox * xy - oy * xx) * turn
                matrix[3 * i + 2, 3 * j + 1] += (ox * yy - oy * xy) * turn
                matrix[3 * i + 2, 3 * j + 2] += (ox * ty - oy * tx) * turn
    return matrix


@kernel
def fill_responses(
    points: Floats, sites: Floats, radius: float, rim_mm: float, atoms: Floats
) -> None:
    """Writes the responses of all markers to a patch at each site.

    Args:
        points: (n, 2) float64 mm, markers at rest.
        sites: (s, 2) float64 mm.
        radius: of the patches, mm.
        rim_mm: where the gel is clamped.
        atoms: (2 n, 3 s) float64, written: drag x, drag y, turn of each site. Rows are markers, so
            that sums over markers add whole rows, which is four times as fast.
    """
    for s in range(len(sites)):
        for i in range(len(points)):
            x, y = points[i, 0], points[i, 1]
            window = rim_window(x * x + y * y, rim_mm)
            xx, xy, yy, tx, ty = respond(x, y, window, sites[s, 0], sites[s, 1], radius, rim_mm)
            atoms[2 * i, 3 * s], atoms[2 * i + 1, 3 * s] = xx, xy
            atoms[2 * i, 3 * s + 1], atoms[2 * i + 1, 3 * s + 1] = xy, yy
            atoms[2 * i, 3 * s + 2], atoms[2 * i + 1, 3 * s + 2] = tx, ty


@kernel
def measure_gains(
    atoms: NDArray[np.float32],
    inverse: Floats,
    residual: Floats,
    weight: Floats,
    first: int,
    gains: Floats,
) -> None:
    """Writes how much of a field a finger at each site explains, from the site ``first`` on.

    Args:
        atoms: (2 n, 3 s) float32, see ``fill_responses``.
        inverse: (s, 3, 3) float64, inverse of their Gram matrices.
        residual: (n, 2) float64 mm, the field.
        weight: (n,) float64, trust in each marker.
        first: of the sites.
        gains: (s or fewer,) float64 mm², written from ``first`` on: sums of squares.
    """
    p = np.zeros(3 * (len(gains) - first))
    for i in range(len(residual)):
        x, y = weight[i] * residual[i, 0], weight[i] * residual[i, 1]
        row_x, row_y = atoms[2 * i, 3 * first :], atoms[2 * i + 1, 3 * first :]
        for k in range(len(p)):
            p[k] += x * row_x[k] + y * row_y[k]
    for s in range(first, len(gains)):
        gain = 0.0
        for a in range(3):
            for b in range(3):
                gain += p[3 * (s - first) + a] * inverse[s, a, b] * p[3 * (s - first) + b]
        gains[s] = gain


@kernel
def bound_gain(residual: Floats, weight: Floats) -> float:
    """Returns an upper bound for the gain of one more finger anywhere, mm².

    A projection is no longer than the vector that is projected. The bound takes a fiftieth of the
    time of all sites, whose data exceed a processor's near caches.

    Args:
        residual: (n, 2) float64 mm, the part of the field that is not explained yet.
        weight: (n,) float64, at most 1, so the weighted sum of squares is such a bound as well.
    """
    most = 0.0
    for i in range(len(residual)):
        x, y = weight[i] * residual[i, 0], weight[i] * residual[i, 1]
        most += x * x + y * y
    return most


@kernel
def find_site(
    arrays: Any,
    residual: Floats,
    weight: Floats,
    centres: Floats,
    fresh_mm: float,
    least_mm2: float,
) -> tuple[int, float]:
    """Returns the site where one more finger explains most, and how much, mm².

    The first sites, every fourth, are computed alone, and the others only if one of the first
    explains half of the least. This is safe: for 99 fingers of 100 one of the first sites explains
    two thirds of what the best site does. The data of all sites exceed a processor's near caches.

    Args:
        arrays: see ``FingerArrays``; the sites and what belongs to them are read.
        residual: (n, 2) float64 mm, the part of the field that is not explained yet.
        weight: (n,) float64.
        centres: (k, 2) float64 mm, of the fingers that are known.
        fresh_mm: no site nearer than this to a known finger counts.
        least_mm2: the least that a finger must explain.
    """
    atoms, inverse, sites = arrays.atoms, arrays.inverse, arrays.sites
    n_coarse = arrays.gel[0].n_coarse
    gains = np.empty(len(sites))
    measure_gains(atoms, inverse, residual, weight, 0, gains[:n_coarse])
    if gains[:n_coarse].max() < 0.5 * least_mm2:
        return 0, 0.0
    measure_gains(atoms, inverse, residual, weight, n_coarse, gains)
    best, best_gain = 0, 0.0
    for s in range(len(sites)):
        is_free = True
        for j in range(len(centres)):
            dx, dy = sites[s, 0] - centres[j, 0], sites[s, 1] - centres[j, 1]
            is_free = is_free and dx * dx + dy * dy >= fresh_mm * fresh_mm
        if is_free and gains[s] > best_gain:
            best, best_gain = s, gains[s]
    return best, best_gain

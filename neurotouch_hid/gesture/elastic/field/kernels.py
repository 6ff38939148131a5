"""Compiled loops of the field: closed forms of elasticity under a clamped rim."""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]

POISSON_RATIO = 0.49  # silicone is nearly incompressible
CLAMP_MM = 31.0  # where the rim holds the gel: just outside the last markers


@njit(cache=True, nogil=True)
def rim_window(r2: float) -> float:
    """How freely the gel gives way at squared distance ``r2`` from its centre: w**(3/8), 0..1."""
    root = math.sqrt(math.sqrt(max(1.0 - r2 / (CLAMP_MM * CLAMP_MM), 1e-3)))
    return root * math.sqrt(root)


@njit(cache=True, nogil=True)
def respond(
    x: float, y: float, window: float, cx: float, cy: float, a: float
) -> tuple[float, float, float, float, float]:
    """Response of the gel at (x, y) mm to one sticking patch of radius ``a`` mm at (cx, cy).

    A rigid patch on an elastic half space, dragged (Mindlin) and turned (Reissner-Sagoci), times
    how much of the motion at the patch's edge the clamped rim lets through.

    Args:
        x: of the point, mm.
        y: of the point, mm.
        window: ``rim_window`` there.
        cx: of the patch's centre, mm.
        cy: of the patch's centre, mm.
        a: its radius, mm.

    Returns:
        xx, xy, yy of the drag (mm per mm), and x, y of a clockwise turn by 1 rad (mm).
    """
    dx, dy = x - cx, y - cy
    r2 = dx * dx + dy * dy
    if r2 <= a * a:
        return 1.0, 0.0, 1.0, -dy, dx
    ratio = a / math.sqrt(r2)
    arc = math.asin(ratio)
    b = ratio * math.sqrt(1.0 - ratio * ratio)
    ex, ey = cx + ratio * dx, cy + ratio * dy
    gain = 2.0 / math.pi * window / rim_window(ex * ex + ey * ey)
    along = gain * arc
    shear = gain * POISSON_RATIO / (2.0 - POISSON_RATIO) * b / r2
    spin = gain * (arc - b)
    cos2, sin2 = (dx * dx - dy * dy) * shear, 2.0 * dx * dy * shear
    return along + cos2, sin2, along - cos2, -spin * dy, spin * dx


@njit(cache=True, nogil=True)
def couple(centres: Floats, radii: Floats) -> Floats:
    """Motions of all patches per unit of load on each, (3k, 3k): drag x, drag y, turn of each."""
    k = len(centres)
    matrix = np.zeros((3 * k, 3 * k))
    for i in range(k):
        arm = 0.6 * radii[i]
        for j in range(k):
            for s in range(5):
                ox = arm if s == 1 else (-arm if s == 2 else 0.0)
                oy = arm if s == 3 else (-arm if s == 4 else 0.0)
                x, y = centres[i, 0] + ox, centres[i, 1] + oy
                xx, xy, yy, tx, ty = respond(
                    x, y, rim_window(x * x + y * y), centres[j, 0], centres[j, 1], radii[j]
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


@njit(cache=True, nogil=True)
def fill_responses(points: Floats, sites: Floats, radius: float, atoms: Floats) -> None:
    """Responses of all markers to a patch at each site.

    Args:
        points: (n, 2) mm, markers at rest.
        sites: (s, 2) mm.
        radius: of the patches, mm.
        atoms: (3 s, 2 n), written: drag x, drag y, turn of each site.
    """
    for s in range(len(sites)):
        for i in range(len(points)):
            x, y = points[i, 0], points[i, 1]
            xx, xy, yy, tx, ty = respond(
                x, y, rim_window(x * x + y * y), sites[s, 0], sites[s, 1], radius
            )
            atoms[3 * s, 2 * i], atoms[3 * s, 2 * i + 1] = xx, xy
            atoms[3 * s + 1, 2 * i], atoms[3 * s + 1, 2 * i + 1] = xy, yy
            atoms[3 * s + 2, 2 * i], atoms[3 * s + 2, 2 * i + 1] = tx, ty


@njit(cache=True, nogil=True)
def measure_gains(
    atoms: Floats,
    inverse: Floats,
    residual: Floats,
    weight: Floats,
    gains: Floats,
) -> None:
    """How much of a field a finger at each site explains.

    Args:
        atoms: (3 s, 2 n), see ``fill_responses``.
        inverse: (s, 3, 3), inverse of their Gram matrices.
        residual: (n, 2) mm.
        weight: (n,).
        gains: (s,) mm², written: sum of squares.
    """
    n = len(residual)
    target = np.empty(2 * n)
    for i in range(n):
        target[2 * i], target[2 * i + 1] = weight[i] * residual[i, 0], weight[i] * residual[i, 1]
    p = np.empty(3)
    for s in range(len(gains)):
        for a in range(3):
            row = atoms[3 * s + a]
            p0 = p1 = p2 = p3 = 0.0
            i = 0
            while i + 3 < 2 * n:
                p0 += row[i] * target[i]
                p1 += row[i + 1] * target[i + 1]
                p2 += row[i + 2] * target[i + 2]
                p3 += row[i + 3] * target[i + 3]
                i += 4
            while i < 2 * n:
                p0 += row[i] * target[i]
                i += 1
            p[a] = p0 + p1 + p2 + p3
        gain = 0.0
        for a in range(3):
            for b in range(3):
                gain += p[a] * inverse[s, a, b] * p[b]
        gains[s] = gain

"""Compiled loops of the elastic fit: the field of sticking fingers, and its least squares."""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]

POISSON_RATIO = 0.49  # silicone is nearly incompressible
CLAMP_MM = 31.0  # where the rim holds the gel: just outside the last markers
CLAMP_POWER = 0.37  # fitted to finite elements of a dome
GRADIENT_MM = 0.8  # step of the differences; a marker's pitch is 4 mm, so the patch edge is blurred


@njit(cache=True, nogil=True)
def rim_window(r2: float) -> float:
    """How freely the gel gives way at squared distance ``r2`` from its centre, 0..1."""
    return math.pow(max(1.0 - r2 / (CLAMP_MM * CLAMP_MM), 1e-3), CLAMP_POWER)


@njit(cache=True, nogil=True)
def respond(
    x: float, y: float, cx: float, cy: float, a: float
) -> tuple[float, float, float, float, float]:
    """Response of the gel at (x, y) mm to one sticking patch of radius ``a`` mm at (cx, cy).

    A rigid patch on an elastic half space, dragged (Mindlin) and turned (Reissner-Sagoci), times
    how much of the motion at the patch's edge the clamped rim lets through.

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
    window = rim_window(x * x + y * y) / rim_window(ex * ex + ey * ey)
    gain = 2.0 * window / math.pi
    along = gain * arc
    shear = gain * POISSON_RATIO / (2.0 - POISSON_RATIO) * b / r2
    spin = gain * (arc - b)
    cos2, sin2 = (dx * dx - dy * dy) * shear, 2.0 * dx * dy * shear
    return along + cos2, sin2, along - cos2, -spin * dy, spin * dx


@njit(cache=True, nogil=True)
def solve(matrix: Floats, vector: Floats) -> bool:
    """Solves the symmetric positive system in place (Cholesky); False if it is singular.

    Args:
        matrix: (n, n) float64; its lower half becomes the factor.
        vector: (n, k) float64; becomes the answer.
    """
    n = len(matrix)
    for i in range(n):
        for j in range(i + 1):
            s = matrix[i, j]
            for k in range(j):
                s -= matrix[i, k] * matrix[j, k]
            if i == j:
                if s <= 0.0:
                    return False
                matrix[i, i] = math.sqrt(s)
            else:
                matrix[i, j] = s / matrix[j, j]
    for c in range(vector.shape[1]):
        for i in range(n):
            s = vector[i, c]
            for k in range(i):
                s -= matrix[i, k] * vector[k, c]
            vector[i, c] = s / matrix[i, i]
        for i in range(n - 1, -1, -1):
            s = vector[i, c]
            for k in range(i + 1, n):
                s -= matrix[k, i] * vector[k, c]
            vector[i, c] = s / matrix[i, i]
    return True


@njit(cache=True, nogil=True)
def invert(matrix: Floats) -> Floats:
    """The inverse of a general matrix (n, n) with dominant diagonal (Gauss-Jordan, pivoting)."""
    n = len(matrix)
    work = np.zeros((n, 2 * n))
    work[:, :n] = matrix
    for i in range(n):
        work[i, n + i] = 1.0
    for i in range(n):
        best = i
        for j in range(i + 1, n):
            if abs(work[j, i]) > abs(work[best, i]):
                best = j
        if best != i:
            for k in range(2 * n):
                work[i, k], work[best, k] = work[best, k], work[i, k]
        pivot = work[i, i]
        if abs(pivot) < 1e-9:
            pivot = 1e-9
        for k in range(2 * n):
            work[i, k] /= pivot
        for j in range(n):
            if j != i:
                factor = work[j, i]
                if factor != 0.0:
                    for k in range(2 * n):
                        work[j, k] -= factor * work[i, k]
    return work[:, n:].copy()


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
                xx, xy, yy, tx, ty = respond(
                    centres[i, 0] + ox, centres[i, 1] + oy, centres[j, 0], centres[j, 1], radii[j]
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
def refine(
    points: Floats,
    moved: Floats,
    weight: Floats,
    centres: Floats,
    radii: Floats,
    prior_centres: Floats,
    prior_weight: Floats,
    motions: Floats,
    offset: Floats,
    residual: Floats,
    noise_mm: float,
    model_error: float,
    n_steps: int,
) -> float:
    """Fits fingers to displacements by Gauss-Newton; one linear solve for their motions at the end.

    Args:
        points: (n, 2) mm, markers at rest.
        moved: (n, 2) mm, their displacement.
        weight: (n,) 0..1, trust in each marker.
        centres: (k, 2) mm, patch centres on the gel at rest; updated.
        radii: (k,) mm; updated.
        prior_centres: (k, 2) mm, what earlier slices say.
        prior_weight: (k,) 1/mm², how surely.
        motions: (k, 3) mm, mm, rad; written.
        offset: (2,) mm, motion of everything; written.
        residual: (n, 2) mm; written.
        noise_mm: of a marker, one axis.
        model_error: of the field, rms share of the largest motion.
        n_steps: of Gauss-Newton; 0 keeps centres and radii.

    Returns:
        The weighted sum of squared residuals, mm².
    """
    n, k = len(points), len(centres)
    cost = 0.0
    for step in range(n_steps + 1):
        last = step == n_steps
        m = 3 * k + 2
        size = m if last else m + 3 * k
        inverse = invert(couple(centres, radii))
        basis = np.empty((n, 2, size))
        for i in range(n):
            x, y = points[i, 0], points[i, 1]
            for j in range(k):
                xx, xy, yy, tx, ty = respond(x, y, centres[j, 0], centres[j, 1], radii[j])
                basis[i, 0, 3 * j], basis[i, 1, 3 * j] = xx, xy
                basis[i, 0, 3 * j + 1], basis[i, 1, 3 * j + 1] = xy, yy
                basis[i, 0, 3 * j + 2], basis[i, 1, 3 * j + 2] = tx, ty
        if not last:
            loads = np.zeros(3 * k)
            for a in range(3 * k):
                for b in range(3 * k):
                    loads[a] += inverse[a, b] * motions[b // 3, b % 3]
            h = GRADIENT_MM
            for i in range(n):
                x, y = points[i, 0], points[i, 1]
                for j in range(k):
                    qx, qy, qt = loads[3 * j], loads[3 * j + 1], loads[3 * j + 2]
                    for p in range(3):
                        sx = h if p == 0 else 0.0
                        sy = h if p == 1 else 0.0
                        sa = h if p == 2 else 0.0
                        xx, xy, yy, tx, ty = respond(
                            x, y, centres[j, 0] + sx, centres[j, 1] + sy, radii[j] + sa
                        )
                        px, py, pyy, ptx, pty = respond(
                            x, y, centres[j, 0] - sx, centres[j, 1] - sy, radii[j] - sa
                        )
                        basis[i, 0, m + 3 * j + p] = (
                            (xx - px) * qx + (xy - py) * qy + (tx - ptx) * qt
                        ) / (2 * h)
                        basis[i, 1, m + 3 * j + p] = (
                            (xy - py) * qx + (yy - pyy) * qy + (ty - pty) * qt
                        ) / (2 * h)
        row = np.empty(3 * k)
        for i in range(n):
            holder = -1
            for j in range(k):
                dx, dy = points[i, 0] - centres[j, 0], points[i, 1] - centres[j, 1]
                if dx * dx + dy * dy <= radii[j] * radii[j]:
                    holder = j
            for axis in range(2):
                for b in range(3 * k):
                    s = 0.0
                    if holder < 0:
                        for a in range(3 * k):
                            s += basis[i, axis, a] * inverse[a, b]
                    elif b // 3 == holder:
                        s = basis[i, axis, b]
                    row[b] = s
                for b in range(3 * k):
                    basis[i, axis, b] = row[b]
            basis[i, 0, 3 * k], basis[i, 0, 3 * k + 1] = 1.0, 0.0
            basis[i, 1, 3 * k], basis[i, 1, 3 * k + 1] = 0.0, 1.0
        # normal equations
        normal, right = np.zeros((size, size)), np.zeros((size, 1))
        for i in range(n):
            w = weight[i]
            if w == 0.0:
                continue
            for axis in range(2):
                for a in range(size):
                    f = w * basis[i, axis, a]
                    right[a, 0] += f * moved[i, axis]
                    for b in range(a + 1):
                        normal[a, b] += f * basis[i, axis, b]
        largest = 0.0
        for j in range(k):
            largest = max(largest, motions[j, 0] ** 2 + motions[j, 1] ** 2)
        variance = noise_mm * noise_mm + model_error * model_error * largest
        for j in range(k):
            normal[3 * j, 3 * j] += variance / 20.0**2
            normal[3 * j + 1, 3 * j + 1] += variance / 20.0**2
            normal[3 * j + 2, 3 * j + 2] += variance / 0.4**2
        normal[3 * k, 3 * k] += variance / 0.2**2
        normal[3 * k + 1, 3 * k + 1] += variance / 0.2**2
        if not last:
            for j in range(k):
                for p in range(2):
                    a = m + 3 * j + p
                    f = variance * prior_weight[j]
                    normal[a, a] += f + variance / 2.0**2
                    right[a, 0] += f * (prior_centres[j, p] - centres[j, p])
                a = m + 3 * j + 2
                normal[a, a] += variance / 0.8**2
                right[a, 0] += variance / 0.8**2 * (6.5 - radii[j])
        if not solve(normal, right):
            break
        for j in range(k):
            for p in range(3):
                motions[j, p] = right[3 * j + p, 0]
        offset[0], offset[1] = right[3 * k, 0], right[3 * k + 1, 0]
        if last:
            cost = 0.0
            for i in range(n):
                for axis in range(2):
                    s = moved[i, axis]
                    for a in range(size):
                        s -= basis[i, axis, a] * right[a, 0]
                    residual[i, axis] = s
                    cost += weight[i] * s * s
        else:
            for j in range(k):
                for p in range(2):
                    centres[j, p] += min(max(right[m + 3 * j + p, 0], -2.0), 2.0)
                r = math.hypot(centres[j, 0], centres[j, 1])
                if r > 27.0:
                    centres[j, 0] *= 27.0 / r
                    centres[j, 1] *= 27.0 / r
                radii[j] += min(max(right[m + 3 * j + 2, 0], -1.0), 1.0)
                radii[j] = min(max(radii[j], 4.5), 9.0)
    return cost


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
            xx, xy, yy, tx, ty = respond(
                points[i, 0], points[i, 1], sites[s, 0], sites[s, 1], radius
            )
            atoms[3 * s, 2 * i], atoms[3 * s, 2 * i + 1] = xx, xy
            atoms[3 * s + 1, 2 * i], atoms[3 * s + 1, 2 * i + 1] = xy, yy
            atoms[3 * s + 2, 2 * i], atoms[3 * s + 2, 2 * i + 1] = tx, ty

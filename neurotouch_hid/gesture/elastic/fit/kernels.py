"""Compiled loops of the fit: linearised model, normal equations, Gauss-Newton."""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from neurotouch_hid.gesture.elastic.field.kernels import couple, respond

Floats = NDArray[np.float64]

GRADIENT_MM = 0.8  # step of the differences; the pitch is 4 mm, so the patch's edge is blurred
DRAG_MM = 20.0  # prior width of a drag: hardly any
TURN_RAD = 0.4  # prior width of a finger's turn about itself
PRESS_MM = 1.5  # prior width of a press
HEIGHT_MM = 20.0  # of the gel under a finger: what is pressed down flows aside
VIEW_MM = 100.0  # from the lens to the gel: what sinks grows
OFFSET_MM = 0.2  # prior width of a motion of the whole gel: a knock at the table
SWAY_RAD = 0.01  # prior width of a turn of the whole gel under the camera
RADIUS_MM = 0.8  # prior width of the radius of a contact patch
LEAST_RADIUS_MM, MOST_RADIUS_MM = 4.5, 9.0
STEP_MM = 2.0  # longest step of a centre
REACH_MM = 27.0  # no finger's middle is further out
NEAR_MM = 9.0  # beyond a patch's edge where shifting it changes little


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
def build_columns(
    points: Floats,
    window: Floats,
    centres: Floats,
    radii: Floats,
    motions: Floats,
    inverse: Floats,
    slopes: bool,
    columns: Floats,
    bent: Floats,
) -> None:
    """Columns of the linearised model: how each marker moves with each unknown.

    Under a finger markers move as the finger; elsewhere every finger pulls with the load that makes
    it move so although the others pull at it.

    Args:
        points: (n, 2) mm, markers at rest.
        window: (n,), ``rim_window`` there.
        centres: (k, 2) mm.
        radii: (k,) mm.
        motions: (k, 3): drag x, drag y in mm, sine of the turn.
        inverse: (3 k, 3 k), of ``couple``.
        slopes: also write the columns of centres and radii.
        columns: (n, 2, 4 k + 3 or 7 k + 3), written: motions, presses, offset (x, y, turn) of
            everything, then x, y and radius of each finger.
        bent: (n, 2) mm, written: what a finite turn adds to the linear one.
    """
    k = len(centres)
    first = 4 * k + 3
    loads = np.zeros(3 * k)
    for a in range(3 * k):
        for b in range(3 * k):
            loads[a] += inverse[a, b] * motions[b // 3, b % 3]
    bend = np.empty(k)
    for j in range(k):
        bend[j] = math.sqrt(max(1.0 - motions[j, 2] ** 2, 0.0)) - 1.0
    alone = np.empty((2, 3 * k))
    for i in range(len(points)):
        x, y = points[i, 0], points[i, 1]
        holder = -1
        bent[i, 0] = bent[i, 1] = 0.0
        for j in range(k):
            cx, cy, a = centres[j, 0], centres[j, 1], radii[j]
            xx, xy, yy, tx, ty = respond(x, y, window[i], cx, cy, a)
            alone[0, 3 * j], alone[0, 3 * j + 1], alone[0, 3 * j + 2] = xx, xy, tx
            alone[1, 3 * j], alone[1, 3 * j + 1], alone[1, 3 * j + 2] = xy, yy, ty
            r2 = (x - cx) ** 2 + (y - cy) ** 2
            if r2 <= a * a:
                holder = j
                bent[i, 0], bent[i, 1] = bend[j] * ty, -bend[j] * tx
            elif holder < 0:
                bent[i, 0] += bend[j] * ty
                bent[i, 1] -= bend[j] * tx
            depth = max(1.0 - 0.5 * r2 / (a * a), 0.0) if r2 < a * a else 0.5 * (a * a / r2) ** 0.75
            flow = a * a / (2.0 * HEIGHT_MM * (a * a + r2))
            columns[i, 0, 3 * k + j] = depth / VIEW_MM * x + flow * (x - cx)
            columns[i, 1, 3 * k + j] = depth / VIEW_MM * y + flow * (y - cy)
            if slopes:
                at = first + 3 * j
                if r2 > (a + NEAR_MM) ** 2:
                    for p in range(3):
                        columns[i, 0, at + p] = columns[i, 1, at + p] = 0.0
                    continue
                qx, qy, qt = loads[3 * j], loads[3 * j + 1], loads[3 * j + 2]
                for p in range(3):
                    sx = GRADIENT_MM if p == 0 else 0.0
                    sy = GRADIENT_MM if p == 1 else 0.0
                    sa = GRADIENT_MM if p == 2 else 0.0
                    pxx, pxy, pyy, ptx, pty = respond(x, y, window[i], cx + sx, cy + sy, a + sa)
                    mxx, mxy, myy, mtx, mty = respond(x, y, window[i], cx - sx, cy - sy, a - sa)
                    h = 0.5 / GRADIENT_MM
                    ux = (pxx - mxx) * qx + (pxy - mxy) * qy + (ptx - mtx) * qt
                    uy = (pxy - mxy) * qx + (pyy - myy) * qy + (pty - mty) * qt
                    columns[i, 0, at + p], columns[i, 1, at + p] = h * ux, h * uy
        for axis in range(2):
            for b in range(3 * k):
                s = 0.0
                if holder < 0:
                    for a in range(3 * k):
                        s += alone[axis, a] * inverse[a, b]
                elif b // 3 == holder:
                    s = alone[axis, b]
                columns[i, axis, b] = s
            columns[i, axis, 4 * k] = 1.0 - axis
            columns[i, axis, 4 * k + 1] = axis
        columns[i, 0, 4 * k + 2], columns[i, 1, 4 * k + 2] = -y, x


@njit(cache=True, nogil=True)
def accumulate(
    columns: Floats, target: Floats, bent: Floats, weight: Floats, normal: Floats, right: Floats
) -> None:
    """Normal equations of the weighted least squares, lower half.

    Args:
        columns: (n, 2, m).
        target: (n, 2) mm, displacements.
        bent: (n, 2) mm, part of them that is known.
        weight: (n,).
        normal: (m, m), written.
        right: (m, 1), written.
    """
    m = len(normal)
    normal[:] = 0.0
    right[:] = 0.0
    for i in range(len(columns)):
        w = weight[i]
        if w == 0.0:
            continue
        for axis in range(2):
            row = columns[i, axis]
            value = target[i, axis] - bent[i, axis]
            for a in range(m):
                f = w * row[a]
                if f != 0.0:
                    right[a, 0] += f * value
                    for b in range(a + 1):
                        normal[a, b] += f * row[b]


@njit(cache=True, nogil=True)
def refine(
    points: Floats,
    window: Floats,
    moved: Floats,
    weight: Floats,
    centres: Floats,
    radii: Floats,
    usual_radius: float,
    trust: Floats,
    motions: Floats,
    press: Floats,
    offset: Floats,
    residual: Floats,
    noise_mm: float,
    model_error: float,
    n_steps: int,
) -> float:
    """Fits fingers to displacements: Gauss-Newton, then one linear solve for the motions alone.

    Args:
        points: (n, 2) mm, markers at rest.
        window: (n,), ``rim_window`` there.
        moved: (n, 2) mm, their displacement.
        weight: (n,) 0..1, trust in each marker.
        centres: (k, 2) mm, patch centres on the gel at rest; updated.
        radii: (k,) mm; updated.
        usual_radius: mm, what radii are pulled to.
        trust: (k,) 1/mm², how surely earlier slices know the centres.
        motions: (k, 3): drag x, drag y in mm, sine of the turn; updated.
        press: (k,) mm, how deep each finger presses; written.
        offset: (3,): mm, mm, rad, motion of everything; written.
        residual: (n, 2) mm; written.
        noise_mm: of a marker, one axis.
        model_error: of the field, rms share of the largest motion.
        n_steps: of Gauss-Newton; 0 keeps centres and radii.

    Returns:
        The weighted sum of squared residuals, mm²; infinite where the fingers cannot be told apart,
        and then nothing that is updated or written means anything.
    """
    n, k = len(points), len(centres)
    known = centres.copy()
    bent = np.empty((n, 2))
    cost = 0.0
    for step in range(n_steps + 1):
        is_last = step == n_steps
        m = 4 * k + 3 if is_last else 7 * k + 3
        columns = np.empty((n, 2, m))
        inverse = invert(couple(centres, radii))
        build_columns(points, window, centres, radii, motions, inverse, not is_last, columns, bent)
        normal, right = np.empty((m, m)), np.empty((m, 1))
        accumulate(columns, moved, bent, weight, normal, right)
        largest2 = 0.0
        for j in range(k):
            largest2 = max(largest2, motions[j, 0] ** 2 + motions[j, 1] ** 2)
        variance = noise_mm * noise_mm + model_error * model_error * largest2
        for j in range(k):
            normal[3 * j, 3 * j] += variance / DRAG_MM**2
            normal[3 * j + 1, 3 * j + 1] += variance / DRAG_MM**2
            normal[3 * j + 2, 3 * j + 2] += variance / TURN_RAD**2
            normal[3 * k + j, 3 * k + j] += variance / PRESS_MM**2
            if not is_last:
                at = 4 * k + 3 + 3 * j
                for p in range(2):
                    normal[at + p, at + p] += variance * (trust[j] + 1.0 / STEP_MM**2)
                    right[at + p, 0] += variance * trust[j] * (known[j, p] - centres[j, p])
                normal[at + 2, at + 2] += variance / RADIUS_MM**2
                right[at + 2, 0] += variance / RADIUS_MM**2 * (usual_radius - radii[j])
        for p in range(2):
            normal[4 * k + p, 4 * k + p] += variance / OFFSET_MM**2
        normal[4 * k + 2, 4 * k + 2] += variance / SWAY_RAD**2
        if not solve(normal, right):
            return np.inf
        for j in range(k):
            for p in range(3):
                motions[j, p] = right[3 * j + p, 0]
            motions[j, 2] = min(max(motions[j, 2], -0.95), 0.95)
        offset[0], offset[1], offset[2] = right[4 * k, 0], right[4 * k + 1, 0], right[4 * k + 2, 0]
        for j in range(k):
            press[j] = right[3 * k + j, 0]
        if is_last:
            for i in range(n):
                for axis in range(2):
                    s = moved[i, axis] - bent[i, axis]
                    for a in range(m):
                        s -= columns[i, axis, a] * right[a, 0]
                    residual[i, axis] = s
                    cost += weight[i] * s * s
            break
        for j in range(k):
            at = 4 * k + 3 + 3 * j
            for p in range(2):
                centres[j, p] += min(max(right[at + p, 0], -STEP_MM), STEP_MM)
            far = math.hypot(centres[j, 0], centres[j, 1])
            if far > REACH_MM:
                centres[j, 0] *= REACH_MM / far
                centres[j, 1] *= REACH_MM / far
            radius = radii[j] + min(max(right[at + 2, 0], -1.0), 1.0)
            radii[j] = min(max(radius, LEAST_RADIUS_MM), MOST_RADIUS_MM)
    return cost

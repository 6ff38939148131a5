"""Fits fingers to displacements: linearised model, normal equations, Gauss-Newton."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.gesture.elastic.kernels.field import (
    N_ROWS,
    RATIO,
    TURN_X,
    TURN_Y,
    VIEW_MM,
    XX,
    XY,
    YY,
    build_compliance,
    respond_along,
)
from neurotouch_hid.gesture.elastic.kernels.motion import DRAG_X, DRAG_Y, TURN, measure_size
from neurotouch_hid.process.kernel_cache import kernel

Floats = NDArray[np.float64]

GRADIENT_MM = 0.8  # step of finite differences; it blurs the patch's edge, as the pitch is 4 mm
DRAG_MM = 20.0  # prior width of a drag, hardly a limit
TURN_RAD = 0.4  # prior width of a finger's turn about its centre
PRESS_MM = 1.5  # prior width of a press
HEIGHT_MM = 20.0  # of gel that flows aside under a finger; a true one fits no better [notebook]
OFFSET_MM = 0.2  # prior width of a shift of the whole gel, by a knock at the table
SWAY_RAD = 0.01  # prior width of a turn of the whole gel under the camera
SHEAR_SHARE = 0.25  # prior width of the shear of the whole gel, in largest motions ...
SHEARED_MM = 1.0  # ... beyond this one: below it, the error of the closed form is less than noise
LEAST_SHEAR_MM = 0.01  # hardly any
BULGE = 0.08  # how far gel flows aside at the edge of a finger, a share of its press
ASIDE_REACH_MM = 18.0  # gel of finite height flows aside most at this distance from a finger
DOWNHILL_MM = 10.0  # a finger on the slope of the dome pushes gel down it, to the rim ...
DOWNHILL_REACH_MM = 7.0  # ... less from this distance on
ASIDE_SHARE = 0.1  # prior width of that flow, a share of the flow of the last fit ...
FLOWING_NOISE = 3.3  # ... beyond this one, in errors of a marker: a usual press has less
N_WHOLE = 5  # unknowns of the whole gel: shift (x, y), turn, shear (x, y); a flow comes last
RADIUS_MM = 0.8  # prior width of the radius of a contact patch
LEAST_RADIUS_MM, MOST_RADIUS_MM = 4.5, 9.0
STEP_MM = 2.0  # longest step of a centre in one iteration
RIM_WIDTH_MM = 4.0  # no finger's centre is nearer to the rim
NEAR_MM = 9.0  # farther from a patch's edge, a shift of the patch changes little


@kernel(inline="always")
def solve(matrix: Floats, vector: Floats) -> bool:
    """Solves the symmetric positive system in place (Cholesky); False if it is singular.

    Args:
        matrix: (n, n) float64; its lower half becomes the Cholesky factor.
        vector: (n, k) float64; becomes the solution.
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


@kernel(inline="always")
def invert(matrix: Floats) -> None:
    """Inverts a general matrix (n, n) with dominant diagonal in place (Gauss-Jordan, pivoting)."""
    n = len(matrix)
    work = np.zeros((n, 2 * n))
    for i in range(n):
        work[i, n + i] = 1.0
        for j in range(n):
            work[i, j] = matrix[i, j]
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
    for i in range(n):
        for j in range(n):
            matrix[i, j] = work[i, n + j]


@kernel(inline="always")
def _shear(x: float, y: float, rim_mm: float) -> float:
    """Returns how far (x, y) goes where the middle of the gel goes 1, its rim held.

    A gel that is tall, or soft below, follows a finger as a whole. The closed form, of a half
    space, knows no height.
    """
    return max(1.0 - (x * x + y * y) / (rim_mm * rim_mm), 0.0)


@kernel(inline="always")
def _measure_flow(fit: Any) -> float:
    """Returns how far pressed gel flows aside, near the fingers and far away, mm."""
    flow_mm: float = fit.aside_mm
    for j in range(fit.count):
        flow_mm += BULGE * fit.press[j]
    return flow_mm


@kernel(error_model="numpy", inline="always")
def build_columns(
    points: Floats,
    window: Floats,
    centres: Floats,
    radii: Floats,
    motions: Floats,
    rim_mm: float,
    inverse: Floats,
    columns: Floats,
    bent: Floats,
) -> None:
    """Writes the columns of the linearised model: how each marker moves with each unknown.

    Markers under a finger move with it. Elsewhere every finger pulls with the load that gives it
    its motion against the pull of the others.

    Args:
        points: (2, n) float64 mm, markers at rest.
        window: (n,) float64, ``rim_window`` at the markers.
        centres: (k, 2) float64 mm.
        radii: (k,) float64 mm.
        motions: (k, 3) float64: drag x, drag y in mm, sine of the turn.
        rim_mm: where the gel is clamped.
        inverse: (3 k, 3 k) float64, of ``build_compliance``.
        columns: (4 k + 5 or more, 2, n) float64, the first 4 k + 5 are written: motions, presses,
            offset (x, y, turn) and shear (x, y) of the whole gel. Markers come last, so that a
            processor takes several at once.
        bent: (2, n) float64 mm, written: the difference of a finite turn from the linear one.
    """
    k, n = len(centres), len(window)
    x, y = points[0], points[1]
    owner = np.empty(n, np.int64)
    alone, answer = np.empty((3 * k, 2, n)), np.empty((N_ROWS, n))
    for i in range(n):
        owner[i] = -1
        bent[0, i] = bent[1, i] = 0.0
        columns[4 * k, 0, i], columns[4 * k, 1, i] = 1.0, 0.0
        columns[4 * k + 1, 0, i], columns[4 * k + 1, 1, i] = 0.0, 1.0
        columns[4 * k + 2, 0, i], columns[4 * k + 2, 1, i] = -y[i], x[i]
        free = _shear(x[i], y[i], rim_mm)
        columns[4 * k + 3, 0, i], columns[4 * k + 3, 1, i] = free, 0.0
        columns[4 * k + 4, 0, i], columns[4 * k + 4, 1, i] = 0.0, free
    for j in range(k):
        cx, cy, a = centres[j, 0], centres[j, 1], radii[j]
        respond_along(x, y, window, cx, cy, a, rim_mm, answer)
        for i in range(n):
            alone[3 * j, 0, i], alone[3 * j, 1, i] = answer[XX, i], answer[XY, i]
            alone[3 * j + 1, 0, i], alone[3 * j + 1, 1, i] = answer[XY, i], answer[YY, i]
            alone[3 * j + 2, 0, i], alone[3 * j + 2, 1, i] = answer[TURN_X, i], answer[TURN_Y, i]
        tx, ty, ratio = answer[TURN_X], answer[TURN_Y], answer[RATIO]
        bend = math.sqrt(max(1.0 - motions[j, TURN] ** 2, 0.0)) - 1.0
        press = columns[3 * k + j]
        for i in range(n):
            dx, dy = x[i] - cx, y[i] - cy
            r2 = dx * dx + dy * dy
            if r2 <= a * a:
                owner[i] = j
                bent[0, i], bent[1, i] = bend * ty[i], -bend * tx[i]
            elif owner[i] < 0:
                bent[0, i] += bend * ty[i]
                bent[1, i] -= bend * tx[i]
        for i in range(n):
            dx, dy = x[i] - cx, y[i] - cy
            r2 = dx * dx + dy * dy
            far = 0.5 * ratio[i] * math.sqrt(ratio[i])
            depth = 1.0 - 0.5 * r2 / (a * a) if r2 < a * a else far
            flow = a * a / (2.0 * HEIGHT_MM * (a * a + r2))
            press[0, i] = depth / VIEW_MM * x[i] + flow * dx
            press[1, i] = depth / VIEW_MM * y[i] + flow * dy
    for b in range(3 * k):
        for axis in range(2):
            column = columns[b, axis]
            for i in range(n):
                column[i] = 0.0
            for a in range(3 * k):
                share, part = inverse[a, b], alone[a, axis]
                for i in range(n):
                    column[i] += part[i] * share
            own = alone[b, axis]
            for i in range(n):
                if owner[i] >= 0:
                    column[i] = own[i] if owner[i] == b // 3 else 0.0


@kernel(error_model="numpy", inline="always")
def build_flow(
    points: Floats, window: Floats, centres: Floats, radii: Floats, column: Floats
) -> None:
    """Writes how each marker moves where gel that is pressed flows aside by 1 mm.

    On a half space it does so at the edge of a finger only. Gel that has a height flows far from
    the fingers too, and on the slope of a dome more goes down than up. Fingers hold what is under
    them. All share one flow: those that press unequally gain nothing by one each [notebook].

    Args:
        points: (2, n) float64 mm, markers at rest.
        window: (n,) float64, ``rim_window`` at the markers.
        centres: (k, 2) float64 mm.
        radii: (k,) float64 mm.
        column: (2, n) float64, written.
    """
    n = len(window)
    for i in range(n):
        column[0, i] = column[1, i] = 0.0
    for j in range(len(centres)):
        cx, cy = centres[j, 0], centres[j, 1]
        for i in range(n):
            dx, dy = points[0, i] - cx, points[1, i] - cy
            r2 = dx * dx + dy * dy
            out = (dx * cx + dy * cy) / math.sqrt(r2)
            aside = 2.0 * ASIDE_REACH_MM * window[i] / (ASIDE_REACH_MM * ASIDE_REACH_MM + r2)
            aside *= 1.0 + DOWNHILL_MM * out / (DOWNHILL_REACH_MM * DOWNHILL_REACH_MM + r2)
            column[0, i] += aside * dx
            column[1, i] += aside * dy
    for j in range(len(centres)):
        for i in range(n):
            dx, dy = points[0, i] - centres[j, 0], points[1, i] - centres[j, 1]
            if dx * dx + dy * dy <= radii[j] * radii[j]:
                column[0, i] = column[1, i] = 0.0


@kernel(inline="always")
def build_slopes(
    points: Floats,
    window: Floats,
    centres: Floats,
    radii: Floats,
    motions: Floats,
    rim_mm: float,
    inverse: Floats,
    columns: Floats,
) -> None:
    """Writes how each marker moves as the fingers' places and sizes change, by finite differences.

    Args:
        points: (2, n) float64 mm, markers at rest.
        window: (n,) float64, ``rim_window`` at the markers.
        centres: (k, 2) float64 mm.
        radii: (k,) float64 mm.
        motions: (k, 3) float64: drag x, drag y in mm, sine of the turn.
        rim_mm: where the gel is clamped.
        inverse: (3 k, 3 k) float64, of ``build_compliance``.
        columns: (3 k, 2, n) float64, written: x, y and radius of each finger.
    """
    k, n = len(centres), len(window)
    near, place = np.empty(n, np.int64), np.empty((3, n))
    more, less = np.empty((N_ROWS, n)), np.empty((N_ROWS, n))
    h = 0.5 / GRADIENT_MM
    for b in range(3 * k):
        for i in range(n):
            columns[b, 0, i] = columns[b, 1, i] = 0.0
    for j in range(k):
        cx, cy, a = centres[j, 0], centres[j, 1], radii[j]
        m = 0
        for i in range(n):
            x, y = points[0, i], points[1, i]
            if (x - cx) ** 2 + (y - cy) ** 2 <= (a + NEAR_MM) ** 2:
                near[m], place[0, m], place[1, m], place[2, m] = i, x, y, window[i]
                m += 1
        qx = qy = qt = 0.0
        for b in range(3 * k):
            motion = motions[b // 3, b % 3]
            qx += inverse[3 * j, b] * motion
            qy += inverse[3 * j + 1, b] * motion
            qt += inverse[3 * j + 2, b] * motion
        xs, ys, free = place[0, :m], place[1, :m], place[2, :m]
        for p in range(3):
            column = columns[3 * j + p]
            for answer, step in ((more, GRADIENT_MM), (less, -GRADIENT_MM)):
                sx, sy, sa = step * (p == 0), step * (p == 1), step * (p == 2)
                respond_along(xs, ys, free, cx + sx, cy + sy, a + sa, rim_mm, answer)
            for i in range(m):
                xx, xy = more[XX, i] - less[XX, i], more[XY, i] - less[XY, i]
                yy = more[YY, i] - less[YY, i]
                tx, ty = more[TURN_X, i] - less[TURN_X, i], more[TURN_Y, i] - less[TURN_Y, i]
                column[0, near[i]] = h * (xx * qx + xy * qy + tx * qt)
                column[1, near[i]] = h * (xy * qx + yy * qy + ty * qt)


@kernel(inline="always")
def keep_inside(gel: Any, centre: Floats) -> None:
    """Moves a finger's centre, (2,) float64 mm, towards the gel's middle until it is on the gel.

    Args:
        gel: record of ``FingerTracker.gel``; ``middle``, ``sides`` and ``inner_mm`` are read.
        centre: updated.
    """
    x, y = centre[0] - gel.middle[0], centre[1] - gel.middle[1]
    if math.hypot(x, y) <= gel.inner_mm:
        return
    share = 1.0
    for side in range(len(gel.sides)):
        out = gel.sides[side, 0] * x + gel.sides[side, 1] * y
        if out > gel.sides[side, 2]:
            share = min(share, gel.sides[side, 2] / out)
    if share < 1.0:
        centre[0], centre[1] = gel.middle[0] + share * x, gel.middle[1] + share * y


@kernel(fastmath={"reassoc", "contract"})
def accumulate(
    columns: Floats, target: Floats, weight: Floats, normal: Floats, right: Floats
) -> None:
    """Writes the normal equations of the weighted least squares, lower half.

    The order of the sums is free, so that a processor adds several products at once.

    Args:
        columns: (m or more, 2, n) float64.
        target: (2, n) float64 mm, displacements.
        weight: (n,) float64, trust in each marker.
        normal: (m, m) float64, its lower half is written.
        right: (m, 1) float64, written.
    """
    m, n = len(normal), len(weight)
    x, y = np.empty(n), np.empty(n)
    for a in range(m):
        value = 0.0
        for i in range(n):
            x[i], y[i] = weight[i] * columns[a, 0, i], weight[i] * columns[a, 1, i]
            value += x[i] * target[0, i] + y[i] * target[1, i]
        right[a, 0] = value
        for b in range(a + 1):
            value = 0.0
            for i in range(n):
                value += x[i] * columns[b, 0, i] + y[i] * columns[b, 1, i]
            normal[a, b] = value


@kernel(error_model="numpy")
def refine(gel: Any, fit: Any, fingers: Any, rules: Any, trust: Floats, n_steps: int) -> None:
    """Fits fingers to displacements: Gauss-Newton, then one linear solve for the motions alone.

    Args:
        gel: record of ``FingerTracker.gel``.
        fit: record of a fit, updated; its presses and flow before say how far gel may flow aside.
            Its cost is infinite if the fingers cannot be separated; nothing else in it then has a
            meaning.
        fingers: record of the state; ``moved``, ``weight`` and ``noise_mm`` are read.
        rules: record of ``CONFIG``; ``radius_mm`` and ``model_error`` are read.
        trust: (k or more,) float64 1/mm², how surely earlier slices know the centres.
        n_steps: of Gauss-Newton; 0 keeps centres and radii.
    """
    moved, weight = fingers.moved[:], fingers.weight[:]
    noise_mm, model_error = fingers.noise_mm, rules.model_error
    n, k, window, rim_mm = len(weight), fit.count, gel.window[:], gel.rim_mm
    centres, radii, motions = fit.centres[:k], fit.radii[:k], fit.motions[:k]
    known = np.empty((k, 2))
    for j in range(k):
        known[j, 0], known[j, 1] = centres[j, 0], centres[j, 1]
    columns, bent = np.empty((7 * k + N_WHOLE + 1, 2, n)), np.empty((2, n))
    target = np.empty((2, n))
    for step in range(n_steps + 1):
        is_last = step == n_steps
        aside_mm = ASIDE_SHARE * (_measure_flow(fit) - FLOWING_NOISE * noise_mm)
        whole = N_WHOLE + 1 if aside_mm > 0.0 else N_WHOLE
        m = 4 * k + whole if is_last else 7 * k + whole
        inverse = build_compliance(centres, radii, rim_mm)
        invert(inverse)
        build_columns(gel.points, window, centres, radii, motions, rim_mm, inverse, columns, bent)
        if whole > N_WHOLE:
            build_flow(gel.points, window, centres, radii, columns[4 * k + N_WHOLE])
        if not is_last:
            slopes = columns[4 * k + whole :]
            build_slopes(gel.points, window, centres, radii, motions, rim_mm, inverse, slopes)
        for i in range(n):
            target[0, i], target[1, i] = moved[i, 0] - bent[0, i], moved[i, 1] - bent[1, i]
        normal, right = np.empty((m, m)), np.empty((m, 1))
        accumulate(columns, target, weight[:], normal, right)
        largest2 = 0.0
        for j in range(k):
            largest2 = max(largest2, motions[j, DRAG_X] ** 2 + motions[j, DRAG_Y] ** 2)
        variance = noise_mm * noise_mm + model_error * model_error * largest2
        for j in range(k):
            normal[3 * j, 3 * j] += variance / DRAG_MM**2
            normal[3 * j + 1, 3 * j + 1] += variance / DRAG_MM**2
            normal[3 * j + 2, 3 * j + 2] += variance / TURN_RAD**2
            normal[3 * k + j, 3 * k + j] += variance / PRESS_MM**2
            if not is_last:
                at = 4 * k + whole + 3 * j
                for p in range(2):
                    normal[at + p, at + p] += variance * (trust[j] + 1.0 / STEP_MM**2)
                    right[at + p, 0] += variance * trust[j] * (known[j, p] - centres[j, p])
                normal[at + 2, at + 2] += variance / RADIUS_MM**2
                right[at + 2, 0] += variance / RADIUS_MM**2 * (rules.radius_mm - radii[j])
        for p in range(2):
            normal[4 * k + p, 4 * k + p] += variance / OFFSET_MM**2
        normal[4 * k + 2, 4 * k + 2] += variance / SWAY_RAD**2
        shear_mm = SHEAR_SHARE * max(math.sqrt(largest2) - SHEARED_MM, 0.0) + LEAST_SHEAR_MM
        for p in range(3, N_WHOLE):
            normal[4 * k + p, 4 * k + p] += variance / (shear_mm * shear_mm)
        if whole > N_WHOLE:
            normal[4 * k + N_WHOLE, 4 * k + N_WHOLE] += variance / (aside_mm * aside_mm)
        if not solve(normal, right):
            fit.cost = np.inf
            for i in range(n):
                fit.residual[i, 0] = fit.residual[i, 1] = 0.0
            return
        for j in range(k):
            for p in range(3):
                motions[j, p] = right[3 * j + p, 0]
            motions[j, TURN] = min(max(motions[j, TURN], -0.95), 0.95)
            fit.press[j] = right[3 * k + j, 0]
        fit.offset_x_mm, fit.offset_y_mm = right[4 * k, 0], right[4 * k + 1, 0]
        fit.offset_rad = right[4 * k + 2, 0]
        fit.aside_mm = right[4 * k + N_WHOLE, 0] if whole > N_WHOLE else 0.0
        shear_x_mm, shear_y_mm = right[4 * k + 3, 0], right[4 * k + 4, 0]
        if is_last:
            break
        for j in range(k):
            at = 4 * k + whole + 3 * j
            for p in range(2):
                centres[j, p] += min(max(right[at + p, 0], -STEP_MM), STEP_MM)
            far = math.hypot(centres[j, 0], centres[j, 1])
            if far > rim_mm - RIM_WIDTH_MM:
                centres[j, 0] *= (rim_mm - RIM_WIDTH_MM) / far
                centres[j, 1] *= (rim_mm - RIM_WIDTH_MM) / far
            keep_inside(gel, centres[j])
            radius = radii[j] + min(max(right[at + 2, 0], -1.0), 1.0)
            radii[j] = min(max(radius, LEAST_RADIUS_MM), MOST_RADIUS_MM)
    for a in range(m):
        for axis in range(2):
            for i in range(n):
                target[axis, i] -= columns[a, axis, i] * right[a, 0]
    fit.cost = 0.0
    for i in range(n):
        x, y = target[0, i], target[1, i]
        fit.residual[i, 0], fit.residual[i, 1] = x, y
        fit.cost += weight[i] * x * x
        fit.cost += weight[i] * y * y
    fit.largest_mm = 0.0
    for j in range(k):
        free = _shear(centres[j, 0], centres[j, 1], rim_mm)
        fit.whole[j, DRAG_X] = motions[j, DRAG_X] + free * shear_x_mm
        fit.whole[j, DRAG_Y] = motions[j, DRAG_Y] + free * shear_y_mm
        fit.whole[j, TURN] = motions[j, TURN]
        fit.largest_mm = max(fit.largest_mm, measure_size(fit.whole[j], radii[j]))

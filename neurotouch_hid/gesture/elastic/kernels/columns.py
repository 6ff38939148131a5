"""Builds the columns of the linearised model: how each marker moves with each unknown."""

import math

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
    respond_along,
)
from neurotouch_hid.gesture.elastic.kernels.motion import TURN
from neurotouch_hid.process.kernel_cache import kernel

Floats = NDArray[np.float64]

N_WHOLE = 5  # unknowns of the whole gel: shift (x, y), turn, shear (x, y); a flow comes last
GRADIENT_MM = 0.8  # step of finite differences; it blurs the patch's edge, as the pitch is 4 mm
NEAR_MM = 9.0  # farther from a patch's edge, a shift of the patch changes little
HEIGHT_MM = 20.0  # of gel that flows aside under a finger; a true one fits no better [notebook]
ASIDE_REACH_MM = 18.0  # gel of finite height flows aside most at this distance from a finger
DOWNHILL_MM = 10.0  # a finger on the slope of the dome pushes gel down it, to the rim ...
DOWNHILL_REACH_MM = 7.0  # ... less from this distance on


@kernel(inline="always")
def shear(x: float, y: float, rim_mm: float) -> float:
    """Returns how far (x, y) goes where the middle of the gel goes 1, its rim held.

    A gel that is tall, or soft below, follows a finger as a whole. The closed form, of a half
    space, knows no height.
    """
    return max(1.0 - (x * x + y * y) / (rim_mm * rim_mm), 0.0)


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
        points: (2, n or more) float64 mm, markers at rest.
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
    x, y = points[0, :n], points[1, :n]
    owner = np.empty(n, np.int64)
    alone, answer = np.empty((3 * k, 2, n)), np.empty((N_ROWS, n))
    for i in range(n):
        owner[i] = -1
        bent[0, i] = bent[1, i] = 0.0
        columns[4 * k, 0, i], columns[4 * k, 1, i] = 1.0, 0.0
        columns[4 * k + 1, 0, i], columns[4 * k + 1, 1, i] = 0.0, 1.0
        columns[4 * k + 2, 0, i], columns[4 * k + 2, 1, i] = -y[i], x[i]
        free = shear(x[i], y[i], rim_mm)
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
    flat, own = columns.reshape(len(columns), 2 * n), alone.reshape(3 * k, 2 * n)
    for b in range(3 * k):
        column = flat[b]
        for i in range(2 * n):
            column[i] = 0.0
        for a in range(3 * k):
            share, part = inverse[a, b], own[a]
            for i in range(2 * n):
                column[i] += part[i] * share
        for axis in range(2):
            for i in range(n):
                if owner[i] >= 0:
                    columns[b, axis, i] = alone[b, axis, i] if owner[i] == b // 3 else 0.0


@kernel(error_model="numpy", inline="always")
def build_flow(
    points: Floats, window: Floats, centres: Floats, radii: Floats, column: Floats
) -> None:
    """Writes how each marker moves where gel that is pressed flows aside by 1 mm.

    On a half space it does so at the edge of a finger only. Gel that has a height flows far from
    the fingers too, and on the slope of a dome more goes down than up. Fingers hold what is under
    them. All share one flow: those that press unequally gain nothing by one each [notebook].

    Args:
        points: (2, n or more) float64 mm, markers at rest.
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
        points: (2, n or more) float64 mm, markers at rest.
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

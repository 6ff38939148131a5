"""Compiled loops of the gel: contact patches in, displacement of material points out."""

import math

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.process.kernel_cache import kernel

Floats = NDArray[np.float64]

POISSON_RATIO = 0.47  # silicone, nearly incompressible; the value of the finite-element check
CLAMP_RADIUS_MM = 31.0  # where the rim clamps the gel; fitted to finite elements
CLAMP_EXPONENT = 0.37  # fitted to finite elements
BULGE = (
    0.09  # sideways motion at the edge of a press, share of its depth; finite elements: 0.03-0.09
)
MIN_STRETCH = 0.4  # neighbours never come closer, share of their distance at rest
SQUEEZE_SWEEPS = 6  # per step; a push travels one marker a sweep, and a long drag has 12 steps
STEP_MM = 1.5  # longest step of a drag, so that the field can follow the patch
STEP_RAD = 0.08  # longest step of a turn

DRAG_X, DRAG_Y, TURN = range(3)
"""The columns of a motion and of a load: drag in mm, turn in rad."""


@kernel
def clamp_window(x: float, y: float) -> float:
    """Returns how freely the gel moves at (x, y) mm: 1 in the centre, 0 at the clamped rim."""
    w = 1.0 - (x * x + y * y) / (CLAMP_RADIUS_MM * CLAMP_RADIUS_MM)
    return w**CLAMP_EXPONENT if w > 0.0 else 0.0


@kernel
def patch_field(
    x: float, y: float, a: float, dx: float, dy: float, turn: float
) -> tuple[float, float]:
    """Returns the displacement at (x, y) mm from a rigid circular patch on a half space.

    The patch of radius ``a`` mm sticks, is dragged by (dx, dy) mm (Mindlin) and turned by ``turn``
    rad about its centre (Reissner-Sagoci); linear in all three.
    """
    r2 = x * x + y * y
    if r2 <= a * a:
        return dx - turn * y, dy + turn * x
    ratio = a / math.sqrt(r2)
    arc = math.asin(ratio)
    b = ratio * math.sqrt(1.0 - ratio * ratio)
    k = 2.0 / (math.pi * (2.0 - POISSON_RATIO))
    along = k * (2.0 - POISSON_RATIO) * arc
    shear = k * POISSON_RATIO * b / r2
    cos2, sin2 = (x * x - y * y) * shear, 2.0 * x * y * shear
    spin = 2.0 / math.pi * (arc - b) * turn
    return (
        along * dx + cos2 * dx + sin2 * dy - spin * y,
        along * dy + sin2 * dx - cos2 * dy + spin * x,
    )


@kernel
def press_depth(r2: float, a: float) -> float:
    """Returns the depth at squared distance ``r2`` of a Hertz press of depth 1 and radius a."""
    q2 = r2 / (a * a)
    if q2 <= 1.0:
        return 1.0 - 0.5 * q2
    q = math.sqrt(q2)
    return ((2.0 - q2) * math.asin(1.0 / q) + math.sqrt(q2 - 1.0)) / math.pi


@kernel
def _solve(matrix: Floats, vector: Floats, n: int) -> None:
    """Solves the n x n system in place (Gauss with pivoting); the answer replaces ``vector``."""
    for i in range(n):
        best = i
        for j in range(i + 1, n):
            if abs(matrix[j, i]) > abs(matrix[best, i]):
                best = j
        for k in range(n):
            matrix[i, k], matrix[best, k] = matrix[best, k], matrix[i, k]
        vector[i], vector[best] = vector[best], vector[i]
        for j in range(i + 1, n):
            factor = matrix[j, i] / matrix[i, i]
            for k in range(i, n):
                matrix[j, k] -= factor * matrix[i, k]
            vector[j] -= factor * vector[i]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            vector[i] -= matrix[i, k] * vector[k]
        vector[i] /= matrix[i, i]


@kernel
def solve_loads(centres: Floats, radii: Floats, motions: Floats, loads: Floats) -> None:
    """Writes the loads that give every patch its prescribed motion against the others' pull.

    Args:
        centres: (k, 2) float64 mm.
        radii: (k,) float64 mm.
        motions: (k, 3) float64: drag x, drag y in mm, turn in rad, wanted as the mean over a patch.
        loads: (k, 3) float64, written: the motion that each load would cause alone.
    """
    n = len(centres)
    matrix, vector = np.zeros((3 * n, 3 * n)), np.zeros(3 * n)
    for j in range(n):
        own = max(clamp_window(centres[j, 0], centres[j, 1]), 1e-3)
        for axis in range(3):
            vector[3 * j + axis] = motions[j, axis]
            dx = 1.0 if axis == DRAG_X else 0.0
            dy = 1.0 if axis == DRAG_Y else 0.0
            turn = 1.0 if axis == TURN else 0.0
            for i in range(n):
                arm = 0.6 * radii[i]
                for sample in range(5):
                    ox = arm if sample == 1 else (-arm if sample == 2 else 0.0)
                    oy = arm if sample == 3 else (-arm if sample == 4 else 0.0)
                    x, y = centres[i, 0] + ox, centres[i, 1] + oy
                    window = clamp_window(x, y) / own
                    ux, uy = patch_field(
                        x - centres[j, 0], y - centres[j, 1], radii[j], dx, dy, turn
                    )
                    matrix[3 * i, 3 * j + axis] += window * ux / 5.0
                    matrix[3 * i + 1, 3 * j + axis] += window * uy / 5.0
                    matrix[3 * i + 2, 3 * j + axis] += (
                        window * (ox * uy - oy * ux) / (4.0 * arm * arm)
                    )
    _solve(matrix, vector, 3 * n)
    for j in range(n):
        for axis in range(3):
            loads[j, axis] = vector[3 * j + axis]


@kernel
def resist_squeeze(
    rest: Floats, neighbours: NDArray[np.intp], mobility: Floats, moved: Floats
) -> None:
    """Pushes neighbouring markers apart that linear elasticity squeezes too close.

    Rubber stiffens under compression and hands the motion on; so a long drag piles the gel up over
    the whole way to the rim and not at the finger's edge alone.

    Args:
        rest: (n, 2) float64 mm, points at rest; the first m are markers.
        neighbours: (m, 8) intp, -1 where there is none.
        mobility: (m,) float64, 0 for markers that a finger or the rim fixes.
        moved: (n, 3) float64 mm, updated.
    """
    for _ in range(SQUEEZE_SWEEPS):
        n_pushed = 0
        for i in range(len(mobility)):
            for slot in range(neighbours.shape[1]):
                j = neighbours[i, slot]
                if j <= i:
                    continue  # each pair once
                x, y = rest[j, 0] - rest[i, 0], rest[j, 1] - rest[i, 1]
                closest2 = MIN_STRETCH * MIN_STRETCH * (x * x + y * y)
                x, y = moved[j, 0] - moved[i, 0], moved[j, 1] - moved[i, 1]
                length2, both = x * x + y * y, mobility[i] + mobility[j]
                if 1e-12 < length2 < closest2 and both > 0.0:
                    push = (math.sqrt(closest2 / length2) - 1.0) / both
                    moved[i, 0] -= push * mobility[i] * x
                    moved[i, 1] -= push * mobility[i] * y
                    moved[j, 0] += push * mobility[j] * x
                    moved[j, 1] += push * mobility[j] * y
                    n_pushed += 1
        if n_pushed == 0:
            break


@kernel
def move_points(
    points: Floats,
    centres: Floats,
    radii: Floats,
    motions: Floats,
    depths: Floats,
    neighbours: NDArray[np.intp],
    mobility: Floats,
    out: Floats,
) -> None:
    """Moves material points as the fingers move their patches.

    Large motions go in small steps, the patches travelling along, so the gel piles up before a
    finger and never folds over itself.

    Args:
        points: (n, 2) float64 mm, the points at rest.
        centres: (k, 2) float64 mm, centres of the patches at rest.
        radii: (k,) float64 mm.
        motions: (k, 3) float64: drag x, drag y in mm, turn in rad since rest.
        depths: (k,) float64 mm, how deep each finger presses.
        neighbours: (m, 8) intp, of the first m points, see ``resist_squeeze``.
        mobility: (m,) float64, of the first m points.
        out: (n, 3) float64 mm, written: x, y, and how far the point has sunk.
    """
    n_patches = len(centres)
    steps = 1
    for k in range(n_patches):
        length = math.hypot(motions[k, DRAG_X], motions[k, DRAG_Y])
        steps = max(steps, math.ceil(length / STEP_MM), math.ceil(abs(motions[k, TURN]) / STEP_RAD))
    centre = centres.copy()
    part, loads = np.empty((n_patches, 3)), np.empty((n_patches, 3))
    for k in range(n_patches):
        for axis in range(3):
            part[k, axis] = motions[k, axis] / steps
    for i in range(len(points)):
        out[i, 0], out[i, 1], out[i, 2] = points[i, 0], points[i, 1], 0.0
    for _ in range(steps):
        solve_loads(centre, radii, part, loads)
        for k in range(n_patches):
            own = max(clamp_window(centre[k, 0], centre[k, 1]), 1e-3)
            for axis in range(3):
                loads[k, axis] /= own
        for i in range(len(points)):
            x, y = out[i, 0], out[i, 1]
            window = clamp_window(x, y)
            ux = uy = 0.0
            for k in range(n_patches):
                vx, vy = patch_field(
                    x - centre[k, 0],
                    y - centre[k, 1],
                    radii[k],
                    loads[k, DRAG_X],
                    loads[k, DRAG_Y],
                    loads[k, TURN],
                )
                ux += vx
                uy += vy
            out[i, 0] += window * ux
            out[i, 1] += window * uy
        for k in range(n_patches):
            centre[k, 0] += part[k, DRAG_X]
            centre[k, 1] += part[k, DRAG_Y]
        resist_squeeze(points, neighbours, mobility, out)
    for k in range(n_patches):
        for i in range(len(points)):
            x, y = out[i, 0] - centre[k, 0], out[i, 1] - centre[k, 1]
            r2, a2 = x * x + y * y, radii[k] * radii[k]
            depth = depths[k] * clamp_window(out[i, 0], out[i, 1])
            out[i, 2] += depth * press_depth(r2, radii[k])
            bulge = depth * BULGE * 2.0 * radii[k] / (a2 + r2)
            out[i, 0] += bulge * x
            out[i, 1] += bulge * y

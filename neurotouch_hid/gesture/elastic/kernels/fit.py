"""Fits fingers to displacements by Gauss-Newton."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.gesture.elastic.kernels.arrays import NOW
from neurotouch_hid.gesture.elastic.kernels.columns import (
    N_WHOLE,
    build_columns,
    build_flow,
    build_slopes,
    shear,
)
from neurotouch_hid.gesture.elastic.kernels.field import build_compliance
from neurotouch_hid.gesture.elastic.kernels.least_squares import accumulate, invert, solve
from neurotouch_hid.gesture.elastic.kernels.motion import DRAG_X, DRAG_Y, TURN, measure_size
from neurotouch_hid.process.kernel_cache import kernel

Floats = NDArray[np.float64]

DRAG_MM = 20.0  # prior width of a drag, hardly a limit
TURN_RAD = 0.4  # prior width of a finger's turn about its centre
PRESS_MM = 1.5  # prior width of a press
OFFSET_MM = 0.2  # prior width of a shift of the whole gel, by a knock at the table
SWAY_RAD = 0.01  # prior width of a turn of the whole gel under the camera
SHEAR_SHARE = 0.25  # prior width of the shear of the whole gel, in largest motions ...
SHEARED_MM = 1.0  # ... beyond this one: below it, the error of the closed form is less than noise
LEAST_SHEAR_MM = 0.01  # hardly any
BULGE = 0.08  # how far gel flows aside at the edge of a finger, a share of its press
ASIDE_SHARE = 0.1  # prior width of that flow, a share of the flow of the last fit ...
FLOWING_NOISE = 3.3  # ... beyond this one, in errors of a marker: a usual press has less
RADIUS_MM = 0.8  # prior width of the radius of a contact patch
LEAST_RADIUS_MM, MOST_RADIUS_MM = 4.5, 9.0
STEP_MM = 2.0  # longest step of a centre in one iteration
RIM_WIDTH_MM = 4.0  # no finger's centre is nearer to the rim


@kernel(inline="always")
def keep_inside(gel: Any, centre: Floats) -> None:
    """Moves a finger's centre, (2,) float64 mm, towards the gel's middle until it is on the gel.

    Args:
        gel: record of ``GEL``; ``middle``, ``sides`` and ``inner_mm`` are read.
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


@kernel(inline="always")
def _measure_flow(fit: Any) -> float:
    """Returns how far pressed gel flows aside, near the fingers and far away, mm."""
    flow_mm: float = fit.aside_mm
    for j in range(fit.count):
        flow_mm += BULGE * fit.press[j]
    return flow_mm


@kernel(error_model="numpy")
def refine(arrays: Any, place: int, n_steps: int) -> None:
    """Fits fingers to displacements: Gauss-Newton, then one linear solve for the motions alone.

    Args:
        arrays: see ``FingerArrays``. The displacements, the trust in each, their noise and the gel
            are read, and of ``NOW`` how surely earlier slices know the centres.
        place: of the fit, which is updated with its residual; its presses and flow before say how
            far gel may flow aside. Its cost is infinite if the fingers cannot be separated; nothing
            else in it then has a meaning.
        n_steps: of Gauss-Newton; 0 keeps centres and radii.
    """
    fit, markers, gel, rules = arrays.fits[place], arrays.markers[0], arrays.gel[0], arrays.rules[0]
    n, k, trust = gel.n_markers, fit.count, arrays.fits[NOW].trust[:]
    moved, weight, residual = markers.moved[:n], markers.weight[:n], markers.residual[place, :n]
    noise_mm, model_error = arrays.state[0].noise_mm, rules.model_error
    points, window, rim_mm = markers.points, markers.window[:n], gel.rim_mm
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
        build_columns(points, window, centres, radii, motions, rim_mm, inverse, columns, bent)
        if whole > N_WHOLE:
            build_flow(points, window, centres, radii, columns[4 * k + N_WHOLE])
        if not is_last:
            slopes = columns[4 * k + whole :]
            build_slopes(points, window, centres, radii, motions, rim_mm, inverse, slopes)
        for i in range(n):
            target[0, i], target[1, i] = moved[i, 0] - bent[0, i], moved[i, 1] - bent[1, i]
        normal, right = np.empty((m, m)), np.empty((m, 1))
        accumulate(columns, target, weight, normal, right)
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
                residual[i, 0] = residual[i, 1] = 0.0
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
        residual[i, 0], residual[i, 1] = x, y
        fit.cost += weight[i] * x * x
        fit.cost += weight[i] * y * y
    fit.largest_mm = 0.0
    for j in range(k):
        free = shear(centres[j, 0], centres[j, 1], rim_mm)
        fit.whole[j, DRAG_X] = motions[j, DRAG_X] + free * shear_x_mm
        fit.whole[j, DRAG_Y] = motions[j, DRAG_Y] + free * shear_y_mm
        fit.whole[j, TURN] = motions[j, TURN]
        fit.largest_mm = max(fit.largest_mm, measure_size(fit.whole[j], radii[j]))

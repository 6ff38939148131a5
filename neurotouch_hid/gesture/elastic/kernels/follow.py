"""Follows the fingers: their common motion in a slice, and the contacts that are shown."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.gesture.elastic.kernels.arrays import NOW
from neurotouch_hid.gesture.elastic.kernels.fit import keep_inside
from neurotouch_hid.gesture.elastic.kernels.motion import (
    DRAG_X,
    DRAG_Y,
    choose_shown,
    locate,
    measure_motion,
    measure_peak,
    measure_size,
    subtract_landing,
)
from neurotouch_hid.gesture.elastic.kernels.search import CHECK_US, find_fingers, is_lost
from neurotouch_hid.process.kernel_cache import kernel

Floats = NDArray[np.float64]

STANDING_US = 400_000
"""Time constant of the mean place of the whole gel: a rig that was bumped stays where it is, and
only what moves about that mean is sway."""

TAKEN_US = 60_000  # time constant of how much of the whole gel the fingers take along
MOST_TAKEN = 0.3  # of their motion; more is the rig
SMALL_MM = 0.5  # fingers that have moved less take nothing along


@kernel
def follow(arrays: Any, moved_px: Floats, use: NDArray[np.bool_]) -> None:
    """Fits the fingers to the displacements of one slice.

    Args:
        arrays: see ``FingerArrays``. The gel, the rules and ``slice`` of the state are read, all
            else is updated; the fingers of the slice are in ``NOW``.
        moved_px: (n, 2) float64 px, displacement of each marker.
        use: (n,) bool, True for measured markers.
    """
    _to_mm(moved_px, arrays.gel[0].rig, arrays.markers[0].moved[: len(use)])
    total, field = find_fingers(arrays, use)
    fingers, fit = arrays.state[0], arrays.fits[NOW]
    motion, step_us = fingers.motion, fingers.slice.step_us
    n = fit.count
    motion.n_fingers, motion.largest_mm, motion.peak_mm, motion.scale = n, 0.0, 0.0, 1.0
    x, y = fingers.common_x_mm, fingers.common_y_mm
    if n > 0:
        x, y = fit.offset_x_mm, fit.offset_y_mm
    x, y = x - fingers.standing_x_mm, y - fingers.standing_y_mm
    share = -math.expm1(-step_us / STANDING_US)
    fingers.standing_x_mm += share * x
    fingers.standing_y_mm += share * y
    motion.sway_mm, motion.error_mm = math.hypot(x, y), 0.0
    motion.x_mm = motion.y_mm = motion.rotation_rad = 0.0
    motion.is_lost = n > 0 and is_lost(fit, fingers, arrays.rules[0], total, field)
    motion.parts_mm[:] = 0.0
    _take_along(fit, fingers, step_us)
    if n == 0:
        fingers.unchecked_us, fingers.n_checks, fingers.unsearched_us = 0, 0, CHECK_US
        return
    subtract_landing(fit.whole[:n], step_us, fit.landed[:n], fit.landed_us[:n], fingers.since[:n])
    n, centres, radii, motions, since = _leave_out_still(fit, fingers, arrays.rules[0])
    motion.n_fingers, motion.largest_mm = n, fit.largest_mm
    for j in range(fit.count):
        peak_mm = measure_peak(fit.centres[j], fit.radii[j], fit.whole[j], fit.press[j])
        motion.peak_mm = max(motion.peak_mm, peak_mm)
    motion.error_mm = math.sqrt(0.5 * fit.cost / use.sum())
    x, y, rotation, scale = measure_motion(centres, radii, motions, motion.parts_mm)
    motion.x_mm, motion.y_mm, motion.rotation_rad, motion.scale = x, y, rotation, scale
    measure_motion(centres, radii, since, motion.parts_mm)


@kernel
def _to_mm(moved_px: Floats, rig: Any, moved: Floats) -> None:
    """Writes the displacements (n, 2) in mm of the gel."""
    c, s = rig.along, rig.across
    square = c * c + s * s
    for i in range(len(moved_px)):
        x, y = moved_px[i, 0], moved_px[i, 1]
        moved[i, 0], moved[i, 1] = (c * x + s * y) / square, (c * y - s * x) / square


@kernel
def _take_along(fit: Any, fingers: Any, step_us: int) -> None:
    """Updates how much of the motion of the whole gel since the fingers came is theirs.

    A rig that is knocked moves anyhow. What a finger takes along goes its own way, and dots under
    it go as far as both together.
    """
    share = -math.expm1(-step_us / TAKEN_US)
    if fit.count == 0:
        fingers.before_x_mm += share * (fingers.common_x_mm - fingers.before_x_mm)
        fingers.before_y_mm += share * (fingers.common_y_mm - fingers.before_y_mm)
        fingers.taken_along = 0.0
        return
    x, y = fit.offset_x_mm - fingers.before_x_mm, fit.offset_y_mm - fingers.before_y_mm
    along, square = 0.0, SMALL_MM**2
    for j in range(fit.count):
        dx, dy = fit.whole[j, DRAG_X], fit.whole[j, DRAG_Y]
        along += (x - fit.offset_rad * fit.centres[j, 1]) * dx
        along += (y + fit.offset_rad * fit.centres[j, 0]) * dy
        square += dx * dx + dy * dy
    taken = min(max(along / square, -MOST_TAKEN), MOST_TAKEN)
    fingers.taken_along += share * (taken - fingers.taken_along)


@kernel
def _leave_out_still(
    fit: Any, fingers: Any, rules: Any
) -> tuple[int, Floats, Floats, Floats, Floats]:
    """Returns the number, centres, radii, motions and motions since landing of moving fingers."""
    centres, radii = np.empty((fit.count, 2)), np.empty(fit.count)
    motions, since = np.empty((fit.count, 3)), np.empty((fit.count, 3))
    n = 0
    for j in range(fit.count):
        if measure_size(fit.whole[j], fit.radii[j]) < rules.still_share * fit.largest_mm:
            continue
        centres[n], radii[n] = fit.centres[j], fit.radii[j]
        motions[n], since[n] = fit.whole[j], fingers.since[j]
        n += 1
    return n, centres[:n], radii[:n], motions[:n], since[:n]


@kernel
def locate_shown(arrays: Any, least: int) -> tuple[Floats, Floats, float]:
    """Returns the contacts of the fingers in ``NOW``, of which there is at least one.

    Args:
        arrays: see ``FingerArrays``; ``shown`` of the fit is updated.
        least: the least number of contacts, if there are as many fingers.

    Returns:
        Their places, (k, 2) float64 in mm of the gel and (k, 2) float64 in px; how far they move
        the gel under them, their mean, mm.
    """
    fit, gel = arrays.fits[NOW], arrays.gel[0]
    n = fit.count
    at, size_mm, chosen = np.empty((n, 2)), np.empty(n), np.empty(n, np.bool_)
    peak_mm = np.empty(n)
    for j in range(n):
        at[j, 0], at[j, 1], size_mm[j] = locate(
            fit.centres[j], fit.radii[j], fit.whole[j], fit.press[j]
        )
        peak_mm[j] = measure_peak(fit.centres[j], fit.radii[j], fit.whole[j], fit.press[j])
    still_mm = arrays.rules[0].still_share * fit.largest_mm
    count = choose_shown(peak_mm, still_mm, fit.shown[:n], least, chosen)
    mm, px, place = np.empty((count, 2)), np.empty((count, 2)), np.empty(2)
    total_mm = 0.0
    rig = gel.rig
    k = 0
    for j in range(n):
        if not chosen[j]:
            continue
        # A finger that turns at the rim seems to be beside the gel, which it drags with it.
        rest_x, rest_y = at[j, 0] - fit.whole[j, DRAG_X], at[j, 1] - fit.whole[j, DRAG_Y]
        place[0], place[1] = rest_x, rest_y
        keep_inside(gel, place)
        x, y = at[j, 0] + (place[0] - rest_x), at[j, 1] + (place[1] - rest_y)
        mm[k, 0], mm[k, 1] = x, y
        x, y = x + fit.offset_x_mm, y + fit.offset_y_mm  # the whole gel, with its rig
        px[k, 0] = rig.along * x - rig.across * y + rig.x_px
        px[k, 1] = rig.across * x + rig.along * y + rig.y_px
        total_mm += size_mm[j]
        k += 1
    return mm, px, (1.0 + arrays.state[0].taken_along) * total_mm / count

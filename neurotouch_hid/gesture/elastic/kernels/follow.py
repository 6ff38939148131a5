"""Compiled rules that keep, add and remove fingers, and search for new ones.

Fingers that explain a field are records in a few places of one array, see ``FingerTracker.fits``.
``NOW`` contains the fingers of the last slice.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.gesture.elastic.kernels.field import bound_gain, find_site
from neurotouch_hid.gesture.elastic.kernels.fit import keep_inside, refine
from neurotouch_hid.gesture.elastic.kernels.markers import (
    find_common,
    find_lone,
    measure_sway,
    weigh_markers,
)
from neurotouch_hid.gesture.elastic.kernels.motion import (
    DRAG_X,
    DRAG_Y,
    TURN,
    choose_shown,
    locate,
    measure_motion,
    measure_peak,
    measure_size,
    subtract_landing,
)
from neurotouch_hid.process.kernel_cache import kernel

Floats = NDArray[np.float64]

NOW, WARM, TRIED, COLD, BEST, N_FITS = range(6)
"""Places of fits: of the last slice; followed; with one finger more or less; of a search from
nothing; the best of that search."""

CHECK_US = 10_000
"""Interval between two checks of the number of fingers, whatever the length of the slices: fingers
come and go no faster, and each check costs as much as several slices without one."""

STANDING_US = 400_000
"""Time constant of the mean place of the whole gel: a rig that was bumped stays where it is, and
only what moves about that mean is sway."""

TAKEN_US = 60_000  # time constant of how much of the whole gel the fingers take along
MOST_TAKEN = 0.3  # of their motion; more is the rig
SMALL_MM = 0.5  # fingers that have moved less take nothing along

LEAST_REGAINED = 3.0
"""Fingers that are found by all markers must explain this many more of them than those that are
followed. A finger covers eight; single markers follow wrong dots."""

STEPS_NONE, STEPS_ON, STEPS_LESS, STEPS_MORE = np.arange(4)
"""Numbers of Gauss-Newton steps: for a finger that was just added, whose motion is unknown; for
followed fingers; for one finger fewer; for one more. They are numpy's integers, for which numba
compiles one kernel instead of four."""


@kernel
def follow(
    state: NDArray[np.void],
    fits: NDArray[np.void],
    gel: NDArray[np.void],
    config: NDArray[np.void],
    moved_px: Floats,
    use: NDArray[np.bool_],
) -> None:
    """Fits the fingers to the displacements of one slice.

    Args:
        state: (1,), see ``FingerTracker.state``; ``slice`` is read, all else is updated.
        fits: (N_FITS,), updated; the fingers of the slice are in ``NOW``.
        gel: (1,), see ``FingerTracker.gel``.
        config: (1,) ``CONFIG``.
        moved_px: (n, 2) float64 px, displacement of each marker.
        use: (n,) bool, True for measured markers.
    """
    fingers, rules = state[0], config[0]
    motion, step_us = fingers.motion, fingers.slice.step_us
    forming, falling = fingers.slice.forming, fingers.slice.falling
    _to_mm(moved_px, gel[0], fingers.moved)
    fingers.unchecked_us += step_us
    fingers.unsearched_us += step_us
    is_due = fingers.unchecked_us >= CHECK_US
    fingers.unchecked_us %= CHECK_US
    fingers.noise_mm = max(fingers.slice.noise_mm, rules.least_noise_mm)
    total, field, hidden = _weigh(fits[NOW], fits[NOW], fingers, rules, use)
    fits[WARM] = fits[NOW]
    is_warm = fits[WARM].count > 0
    if is_warm:
        n_steps = STEPS_ON if is_due or forming else STEPS_NONE
        _fit(fits[WARM], fits, fingers, gel[0], rules, n_steps)
        may_doubt = fingers.unsearched_us >= CHECK_US or not math.isfinite(fits[WARM].cost)
        is_warm = not (may_doubt and _is_lost(fits[WARM], fingers, rules, total, field))
    if is_warm and is_due:
        if not falling:  # the gel follows late, and what remains looks like one more finger
            _extend(fits, fingers, gel[0], rules)
        if fingers.n_checks % 2 == 0:  # every second check is soon enough
            _reduce(fits, fingers, gel[0], rules)
    fingers.n_checks += is_due
    found = WARM
    is_second = is_due and fingers.n_checks % 2 == 0  # alternates with _reduce
    is_hiding = is_due and not is_second and not falling
    is_hiding = is_hiding and _hides(fits[NOW], fingers, rules, field, hidden)
    if not is_warm or (is_second and forming) or is_hiding:
        fingers.unsearched_us = 0
        fingers.n_searches += 1
        if is_hiding:
            weigh_markers(use, fingers.moved, fingers.moved, math.inf, fingers.weight)
        is_cold = _search(fits, fingers, gel[0], rules)
        if is_cold and is_warm:
            if is_hiding:
                regained = _weigh(fits[BEST], fits[NOW], fingers, rules, use)[0] - total
                is_cold = regained > LEAST_REGAINED
            else:
                least = 0.9 * _score(fits[WARM], fingers, rules)
                is_cold = _score(fits[BEST], fingers, rules) < least
        if is_cold:
            found = BEST
        elif not is_warm:
            fits[WARM].count = 0
    _accept(found, fits, fingers, rules, step_us / CHECK_US)
    fit = fits[NOW]
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
    motion.is_lost = n > 0 and _is_lost(fit, fingers, rules, total, field)
    motion.parts_mm[:] = 0.0
    _take_along(fit, fingers, step_us)
    if n == 0:
        fingers.unchecked_us, fingers.n_checks, fingers.unsearched_us = 0, 0, CHECK_US
        return
    subtract_landing(fit.whole[:n], step_us, fit.landed[:n], fit.landed_us[:n], fingers.since[:n])
    n, centres, radii, motions, since = _leave_out_still(fit, fingers, rules)
    motion.n_fingers, motion.largest_mm = n, fit.largest_mm
    for j in range(fit.count):
        peak_mm = measure_peak(fit.centres[j], fit.radii[j], fit.whole[j], fit.press[j])
        motion.peak_mm = max(motion.peak_mm, peak_mm)
    motion.error_mm = math.sqrt(0.5 * fit.cost / use.sum())
    x, y, rotation, scale = measure_motion(centres, radii, motions, motion.parts_mm)
    motion.x_mm, motion.y_mm, motion.rotation_rad, motion.scale = x, y, rotation, scale
    measure_motion(centres, radii, since, motion.parts_mm)


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
def locate_shown(
    state: NDArray[np.void],
    fits: NDArray[np.void],
    gel: NDArray[np.void],
    config: NDArray[np.void],
    least: int,
) -> tuple[Floats, Floats, float]:
    """Returns the contacts of the fingers in ``NOW``, of which there is at least one.

    Args:
        state: (1,), see ``FingerTracker.state``; ``taken_along`` is read.
        fits: (N_FITS,); ``shown`` is updated.
        gel: (1,), see ``FingerTracker.gel``.
        config: (1,) ``CONFIG``.
        least: the least number of contacts, if there are as many fingers.

    Returns:
        Their places, (k, 2) float64 in mm of the gel and (k, 2) float64 in px; how far they move
        the gel under them, their mean, mm.
    """
    fit = fits[NOW]
    n = fit.count
    at, size_mm, chosen = np.empty((n, 2)), np.empty(n), np.empty(n, np.bool_)
    for j in range(n):
        at[j, 0], at[j, 1], size_mm[j] = locate(
            fit.centres[j], fit.radii[j], fit.whole[j], fit.press[j]
        )
    still_mm = config[0].still_share * fit.largest_mm
    count = choose_shown(size_mm, still_mm, fit.shown[:n], least, chosen)
    mm, px, place = np.empty((count, 2)), np.empty((count, 2)), np.empty(2)
    total_mm = 0.0
    rig = gel[0].rig
    k = 0
    for j in range(n):
        if not chosen[j]:
            continue
        # A finger that turns at the rim seems to be beside the gel, which it drags with it.
        rest_x, rest_y = at[j, 0] - fit.whole[j, DRAG_X], at[j, 1] - fit.whole[j, DRAG_Y]
        place[0], place[1] = rest_x, rest_y
        keep_inside(gel[0], place)
        x, y = at[j, 0] + (place[0] - rest_x), at[j, 1] + (place[1] - rest_y)
        mm[k, 0], mm[k, 1] = x, y
        x, y = x + fit.offset_x_mm, y + fit.offset_y_mm  # the whole gel, with its rig
        px[k, 0] = rig.along * x - rig.across * y + rig.x_px
        px[k, 1] = rig.across * x + rig.along * y + rig.y_px
        total_mm += size_mm[j]
        k += 1
    return mm, px, (1.0 + state[0].taken_along) * total_mm / count


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
def _to_mm(moved_px: Floats, gel: Any, moved: Floats) -> None:
    """Writes the displacements (n, 2) in mm of the gel."""
    c, s = gel.rig.along, gel.rig.across
    square = c * c + s * s
    for i in range(len(moved_px)):
        x, y = moved_px[i, 0], moved_px[i, 1]
        moved[i, 0], moved[i, 1] = (c * x + s * y) / square, (c * y - s * x) / square


@kernel
def _weigh(
    fit: Any, last: Any, fingers: Any, rules: Any, use: NDArray[np.bool_]
) -> tuple[float, float, float]:
    """Updates the trust in each marker by what a fit leaves of it; see ``weigh_markers``.

    How much of it an error may be depends on the fit of the last slice.
    """
    residual, limit2 = fingers.moved, math.inf
    if fit.count > 0:
        error2 = fingers.noise_mm**2 + (rules.model_error * last.largest_mm) ** 2
        residual, limit2 = fit.residual, rules.outlier**2 * error2
    total, field, hidden = weigh_markers(use, fingers.moved, residual, limit2, fingers.weight)
    return total, field, hidden


@kernel(inline="always")
def _fit(
    fit: Any, fits: NDArray[np.void], fingers: Any, gel: Any, rules: Any, n_steps: int
) -> None:
    """Fits the fingers of one place to the displacements."""
    refine(gel, fit, fingers, rules, fits[NOW].trust[:], n_steps)


@kernel
def _is_lost(fit: Any, fingers: Any, rules: Any, total: float, field: float) -> bool:
    """Returns True if the followed fingers overlap or explain too little of the field."""
    error = 2.0 * total * fingers.noise_mm**2
    unexplained = rules.most_unexplained * (field - error)
    most = max(unexplained, _required(fit, fingers, rules))
    return not (_are_apart(fit, rules) and fit.cost - error < most)


@kernel
def _hides(fit: Any, fingers: Any, rules: Any, field: float, hidden: float) -> bool:
    """Returns True if the markers that have lost their trust move as much as under a finger.

    They seem to follow wrong dots. But fingers that were found while a hand only pressed can be at
    wrong places: then what the hand drags has no trust, and no fit and no search sees it.
    """
    least = rules.most_hidden * (field + hidden)
    has_hidden: bool = fit.count > 0 and hidden > max(least, _required(fit, fingers, rules))
    return has_hidden


@kernel
def _required(fit: Any, fingers: Any, rules: Any) -> float:
    """Returns the sum of squares that a finger must explain, mm²."""
    required: float = rules.noise_gain * fingers.noise_mm**2 + rules.field_gain * fit.largest_mm**2
    return required


@kernel
def _score(fit: Any, fingers: Any, rules: Any) -> float:
    """Returns the residual of a fit plus the required sums of its fingers, mm²: less is better."""
    sum_mm2: float = fit.cost + fit.count * _required(fit, fingers, rules)
    return sum_mm2


@kernel
def _are_apart(fit: Any, rules: Any) -> bool:
    least_mm = 0.85 * rules.spacing_mm
    for i in range(fit.count):
        for j in range(i):
            dx = fit.centres[i, 0] - fit.centres[j, 0]
            dy = fit.centres[i, 1] - fit.centres[j, 1]
            if math.hypot(dx, dy) <= least_mm:
                return False
    return True


@kernel
def _find(fit: Any, fingers: Any, gel: Any, rules: Any, least: float) -> tuple[int, float]:
    """Returns the site where one more finger explains most, and how much, mm².

    If that is less than ``least``, it may be any site.
    """
    fingers.n_asked += 1
    known = fit.centres[: fit.count]
    site, gain = find_site(gel, fit.residual, fingers.weight, known, rules.fresh_mm, least)
    return site, gain


@kernel(inline="always")
def _add(fit: Any, fits: NDArray[np.void], fingers: Any, gel: Any, rules: Any, site: int) -> None:
    """Adds a finger at a site."""
    j = fit.count
    fit.centres[j, 0], fit.centres[j, 1] = gel.sites[site, 0], gel.sites[site, 1]
    fit.radii[j] = rules.radius_mm
    fit.motions[j, DRAG_X] = fit.motions[j, DRAG_Y] = fit.motions[j, TURN] = 0.0
    fit.press[j] = 0.0
    fit.count += 1
    _fit(fit, fits, fingers, gel, rules, STEPS_NONE)
    _fit(fit, fits, fingers, gel, rules, STEPS_MORE)


@kernel(inline="always")
def _extend(fits: NDArray[np.void], fingers: Any, gel: Any, rules: Any) -> None:
    """Adds a finger to those that are followed, if it explains enough of several markers."""
    fit = fits[WARM]
    required = _required(fit, fingers, rules)
    if fit.count >= rules.most or fit.cost < rules.sure * 0.4 * required:
        return  # no finger explains more than is left
    site, gain = _find(fit, fingers, gel, rules, 0.4 * required)
    if gain < 0.4 * required:
        return
    fits[TRIED] = fit
    _add(fits[TRIED], fits, fingers, gel, rules, site)
    if find_lone(fit.residual, fits[TRIED].residual, fingers.weight) >= 0:
        return
    if fit.cost - fits[TRIED].cost > required and _are_apart(fits[TRIED], rules):
        fits[WARM] = fits[TRIED]


@kernel(inline="always")
def _reduce(fits: NDArray[np.void], fingers: Any, gel: Any, rules: Any) -> None:
    """Removes one followed finger, if it explains too little; tries a different one each time."""
    fit = fits[WARM]
    if fit.count < 2:
        return
    fits[TRIED] = fit
    less = fits[TRIED]
    less.count -= 1
    for j in range(fingers.n_checks // 2 % fit.count, less.count):
        less.radii[j], less.press[j] = fit.radii[j + 1], fit.press[j + 1]
        for p in range(2):
            less.centres[j, p] = fit.centres[j + 1, p]
        for p in range(3):
            less.motions[j, p] = fit.motions[j + 1, p]
    _fit(less, fits, fingers, gel, rules, STEPS_LESS)
    if less.cost - fit.cost < rules.keep * _required(fit, fingers, rules):
        fits[WARM] = less


@kernel(inline="always")
def _search(fits: NDArray[np.void], fingers: Any, gel: Any, rules: Any) -> bool:
    """Searches for fingers from nothing, the strongest first; returns False if there are none.

    The best fit is in ``BEST`` afterwards. A marker that makes a finger alone loses its trust.
    """
    fit = fits[COLD]
    fit.count = 0
    moved = fingers.moved
    x, y = find_common(moved, fingers.weight)
    part = measure_sway(moved, fingers.weight, x, y) / max(math.hypot(x, y), 1e-9)
    fingers.common_x_mm, fingers.common_y_mm = part * x, part * y
    before, least = np.empty((len(moved), 2)), 0.0
    while fit.count < rules.most:
        if fit.count == 0:
            fit.aside_mm = 0.0
            for i in range(len(moved)):
                fit.residual[i, 0], fit.residual[i, 1] = moved[i, 0] - x, moved[i, 1] - y
            least = rules.noise_gain * fingers.noise_mm**2
            if bound_gain(fit.residual, fingers.weight) < rules.sure * least:
                return False
        site, gain = _find(fit, fingers, gel, rules, least)
        if gain < least:
            break
        before[:] = fit.residual
        _add(fit, fits, fingers, gel, rules, site)
        lone = find_lone(before, fit.residual, fingers.weight)
        if lone >= 0:
            fingers.weight[lone] = 0.0
            fit.count = 0
            continue
        if fit.count == 1:
            if fit.largest_mm < rules.least_mm:
                return False
            fits[BEST] = fit
        elif _are_apart(fit, rules) and _score(fit, fingers, rules) < _score(
            fits[BEST], fingers, rules
        ):
            fits[BEST] = fit
        least = 0.3 * _required(fit, fingers, rules)
        if fit.cost < rules.sure * least:
            break
    return bool(fit.count > 0 and fits[BEST].largest_mm >= rules.least_mm)


@kernel
def _accept(place: int, fits: NDArray[np.void], fingers: Any, rules: Any, n_checks: float) -> None:
    """Makes a fit that of this slice; fingers keep the names of those that were near."""
    old, new = fits[NOW], fits[place]
    taken = 0  # one bit for each old finger
    for j in range(3):
        new.ids[j], new.trust[j], new.shown[j], new.landed_us[j] = -1, 0.0, 0, 0
    for j in range(new.count):
        near, far = 0, math.inf
        for i in range(old.count):
            away = math.hypot(
                old.centres[i, 0] - new.centres[j, 0], old.centres[i, 1] - new.centres[j, 1]
            )
            if not taken >> i & 1 and away < far:
                near, far = i, away
        if far > rules.spacing_mm:
            new.ids[j] = fingers.next_id
            fingers.next_id += 1
        else:
            taken |= 1 << near
            new.ids[j], new.shown[j] = old.ids[near], old.shown[near]
            new.landed_us[j] = old.landed_us[near]
            for p in range(3):
                new.landed[j, p] = old.landed[near, p]
            new.trust[j] = min(0.98**n_checks * old.trust[near] + 0.25 * n_checks, 12.0)
    fits[NOW] = new

"""Compiled rules that keep, add and remove fingers, and search for new ones.

Fingers that explain a field are in the places of ``FingerArrays.fits``. A rule that needs all
arrays is compiled into its caller: to hand them over costs more than a small kernel does.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.gesture.elastic.kernels.arrays import BEST, COLD, NOW, TRIED, WARM
from neurotouch_hid.gesture.elastic.kernels.field import bound_gain, find_site
from neurotouch_hid.gesture.elastic.kernels.fit import refine
from neurotouch_hid.gesture.elastic.kernels.markers import (
    find_common,
    find_lone,
    measure_sway,
    weigh_markers,
)
from neurotouch_hid.gesture.elastic.kernels.motion import DRAG_X, DRAG_Y, TURN
from neurotouch_hid.process.kernel_cache import kernel

CHECK_US = 10_000
"""Interval between two checks of the number of fingers, whatever the length of the slices: fingers
come and go no faster, and each check costs as much as several slices without one."""

LEAST_REGAINED = 3.0
"""Fingers that are found by all markers must explain this many more of them than those that are
followed. A finger covers eight; single markers follow wrong dots."""

STEPS_NONE, STEPS_ON, STEPS_LESS, STEPS_MORE = np.arange(4)
"""Numbers of Gauss-Newton steps: for a finger that was just added, whose motion is unknown; for
followed fingers; for one finger fewer; for one more."""


@kernel
def find_fingers(arrays: Any, use: NDArray[np.bool_]) -> tuple[float, float]:
    """Finds the fingers that explain the displacements of one slice; they are in ``NOW`` then.

    Args:
        arrays: see ``FingerArrays``; the displacements are read, and ``slice`` of the state.
        use: (n,) bool, True for measured markers.

    Returns:
        The sum of the markers' weights, and the weighted sum of their squared displacements, mm²,
        both by the fingers of the slice before.
    """
    fingers, fits, rules = arrays.state[0], arrays.fits, arrays.rules[0]
    markers = arrays.markers[0]
    step_us, forming = fingers.slice.step_us, fingers.slice.forming
    falling = fingers.slice.falling
    fingers.unchecked_us += step_us
    fingers.unsearched_us += step_us
    is_due = fingers.unchecked_us >= CHECK_US
    fingers.unchecked_us %= CHECK_US
    fingers.noise_mm = max(fingers.slice.noise_mm, rules.least_noise_mm)
    total, field, hidden = _weigh(arrays, NOW, use)
    fits[WARM] = fits[NOW]
    is_warm = fits[WARM].count > 0
    if is_warm:
        refine(arrays, WARM, STEPS_ON if is_due or forming else STEPS_NONE)
        may_doubt = fingers.unsearched_us >= CHECK_US or not math.isfinite(fits[WARM].cost)
        is_warm = not (may_doubt and is_lost(fits[WARM], fingers, rules, total, field))
    if is_warm and is_due:
        if not falling:  # the gel follows late, and what remains looks like one more finger
            _extend(arrays)
        if fingers.n_checks % 2 == 0:  # every second check is soon enough
            _reduce(arrays)
    fingers.n_checks += is_due
    found = WARM
    is_second = is_due and fingers.n_checks % 2 == 0  # alternates with _reduce
    is_hiding = is_due and not is_second and not falling
    is_hiding = is_hiding and _hides(fits[NOW], fingers, rules, field, hidden)
    if not is_warm or (is_second and forming) or is_hiding:
        fingers.unsearched_us = 0
        fingers.n_searches += 1
        if is_hiding:
            moved = markers.moved[: len(use)]
            weigh_markers(use, moved, moved, math.inf, markers.weight[: len(use)])
        is_cold = _search(arrays)
        if is_cold and is_warm:
            if is_hiding:
                is_cold = _weigh(arrays, BEST, use)[0] - total > LEAST_REGAINED
            else:
                least = 0.9 * _score(fits[WARM], fingers, rules)
                is_cold = _score(fits[BEST], fingers, rules) < least
        if is_cold:
            found = BEST
        elif not is_warm:
            fits[WARM].count = 0
    _accept(arrays, found, step_us / CHECK_US)
    return total, field


@kernel(inline="always")
def _weigh(arrays: Any, place: int, use: NDArray[np.bool_]) -> tuple[float, float, float]:
    """Updates the trust in each marker by what a fit leaves of it; see ``weigh_markers``.

    How much of it an error may be depends on the fit of the last slice.
    """
    markers, fits, rules = arrays.markers[0], arrays.fits, arrays.rules[0]
    n = arrays.gel[0].n_markers
    moved, weight = markers.moved[:n], markers.weight[:n]
    residual, limit2 = moved, math.inf
    if fits[place].count > 0:
        error2 = arrays.state[0].noise_mm ** 2
        error2 += (rules.model_error * fits[NOW].largest_mm) ** 2
        residual, limit2 = markers.residual[place, :n], rules.outlier**2 * error2
    total, field, hidden = weigh_markers(use, moved, residual, limit2, weight)
    return total, field, hidden


@kernel
def is_lost(fit: Any, fingers: Any, rules: Any, total: float, field: float) -> bool:
    """Returns True if the fingers of a fit overlap or explain too little of the field.

    Args:
        fit: record of the fit.
        fingers: record of the state.
        rules: record of ``CONFIG``.
        total: the sum of the markers' weights.
        field: the weighted sum of their squared displacements, mm².
    """
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


@kernel(inline="always")
def _find(arrays: Any, place: int, least: float) -> tuple[int, float]:
    """Returns the site where one more finger explains most, and how much, mm².

    If that is less than ``least``, it may be any site.
    """
    fit, fresh_mm = arrays.fits[place], arrays.rules[0].fresh_mm
    markers, n = arrays.markers[0], arrays.gel[0].n_markers
    arrays.state[0].n_asked += 1
    known = fit.centres[: fit.count]
    residual, weight = markers.residual[place, :n], markers.weight[:n]
    site, gain = find_site(arrays, residual, weight, known, fresh_mm, least)
    return site, gain


@kernel(inline="always")
def _add(arrays: Any, place: int, site: int) -> None:
    """Adds a finger at a site."""
    fit = arrays.fits[place]
    j = fit.count
    fit.centres[j, 0], fit.centres[j, 1] = arrays.sites[site, 0], arrays.sites[site, 1]
    fit.radii[j] = arrays.rules[0].radius_mm
    fit.motions[j, DRAG_X] = fit.motions[j, DRAG_Y] = fit.motions[j, TURN] = 0.0
    fit.press[j] = 0.0
    fit.count += 1
    refine(arrays, place, STEPS_NONE)
    refine(arrays, place, STEPS_MORE)


@kernel(inline="always")
def _take(arrays: Any, to: int, place: int) -> None:
    """Copies a fit with its residual to another place."""
    arrays.fits[to] = arrays.fits[place]
    residual = arrays.markers[0].residual
    for i in range(arrays.gel[0].n_markers):
        residual[to, i, 0], residual[to, i, 1] = residual[place, i, 0], residual[place, i, 1]


@kernel(inline="always")
def _extend(arrays: Any) -> None:
    """Adds a finger to those that are followed, if it explains enough of several markers."""
    fits, markers, rules = arrays.fits, arrays.markers[0], arrays.rules[0]
    required = _required(fits[WARM], arrays.state[0], rules)
    if fits[WARM].count >= rules.most or fits[WARM].cost < required:
        return  # no finger explains more than is left
    # While the others keep what they do, a finger explains less than once all are fitted again:
    # they have taken a part of its field.
    field_mm2 = rules.field_gain * fits[WARM].largest_mm ** 2
    least = 0.4 * (required - field_mm2) + rules.hint * field_mm2
    site, gain = _find(arrays, WARM, least)
    if gain < least:
        return
    fits[TRIED] = fits[WARM]
    _add(arrays, TRIED, site)
    n = arrays.gel[0].n_markers
    before, after = markers.residual[WARM, :n], markers.residual[TRIED, :n]
    if find_lone(before, after, markers.weight[:n]) >= 0:
        return
    if fits[WARM].cost - fits[TRIED].cost > required and _are_apart(fits[TRIED], rules):
        _take(arrays, WARM, TRIED)


@kernel(inline="always")
def _reduce(arrays: Any) -> None:
    """Removes one followed finger, if it explains too little; tries a different one each time."""
    fit, less = arrays.fits[WARM], arrays.fits[TRIED]
    if fit.count < 2:
        return
    arrays.fits[TRIED] = fit
    less.count -= 1
    for j in range(arrays.state[0].n_checks // 2 % fit.count, less.count):
        less.radii[j], less.press[j] = fit.radii[j + 1], fit.press[j + 1]
        for p in range(2):
            less.centres[j, p] = fit.centres[j + 1, p]
        for p in range(3):
            less.motions[j, p] = fit.motions[j + 1, p]
    refine(arrays, TRIED, STEPS_LESS)
    rules = arrays.rules[0]
    if less.cost - fit.cost < rules.keep * _required(fit, arrays.state[0], rules):
        _take(arrays, WARM, TRIED)


@kernel(inline="always")
def _search(arrays: Any) -> bool:
    """Searches for fingers from nothing, the strongest first; returns False if there are none.

    The best fit is in ``BEST`` afterwards. A marker that makes a finger alone loses its trust.
    """
    fit, best, rules = arrays.fits[COLD], arrays.fits[BEST], arrays.rules[0]
    fingers, markers, n = arrays.state[0], arrays.markers[0], arrays.gel[0].n_markers
    moved, weight, residual = markers.moved[:n], markers.weight[:n], markers.residual[COLD, :n]
    fit.count = 0
    x, y = find_common(moved, weight)
    part = measure_sway(moved, weight, x, y) / max(math.hypot(x, y), 1e-9)
    fingers.common_x_mm, fingers.common_y_mm = part * x, part * y
    before, least = np.empty((len(moved), 2)), 0.0
    while fit.count < rules.most:
        if fit.count == 0:
            fit.aside_mm = 0.0
            for i in range(len(moved)):
                residual[i, 0], residual[i, 1] = moved[i, 0] - x, moved[i, 1] - y
            least = rules.noise_gain * fingers.noise_mm**2
            if bound_gain(residual, weight) < rules.sure * least:
                return False
        site, gain = _find(arrays, COLD, least)
        if gain < least:
            break
        before[:] = residual
        _add(arrays, COLD, site)
        lone = find_lone(before, residual, weight)
        if lone >= 0:
            weight[lone] = 0.0
            fit.count = 0
            continue
        if fit.count == 1:
            if fit.largest_mm < rules.least_mm:
                return False
            _take(arrays, BEST, COLD)
        elif _are_apart(fit, rules) and _score(fit, fingers, rules) < _score(best, fingers, rules):
            _take(arrays, BEST, COLD)
        least = 0.3 * _required(fit, fingers, rules)
        if fit.cost < rules.sure * least:
            break
    return bool(fit.count > 0 and best.largest_mm >= rules.least_mm)


@kernel(inline="always")
def _accept(arrays: Any, place: int, n_checks: float) -> None:
    """Makes a fit that of this slice; fingers keep the names of those that were near."""
    old, new = arrays.fits[NOW], arrays.fits[place]
    fingers, spacing_mm = arrays.state[0], arrays.rules[0].spacing_mm
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
        if far > spacing_mm:
            new.ids[j] = fingers.next_id
            fingers.next_id += 1
        else:
            taken |= 1 << near
            new.ids[j], new.shown[j] = old.ids[near], old.shown[near]
            new.landed_us[j] = old.landed_us[near]
            for p in range(3):
                new.landed[j, p] = old.landed[near, p]
            new.trust[j] = min(0.98**n_checks * old.trust[near] + 0.25 * n_checks, 12.0)
    _take(arrays, NOW, place)

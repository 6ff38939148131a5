"""Compiled rules that keep, add and remove fingers, and search for new ones.

Fingers that explain a field are records ``fit``, kept in a few places of one array; ``NOW`` holds
those that are believed. A function that is given a place changes what lies there.
"""

import math
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from neurotouch_hid.gesture.elastic.kernels.field import bound_gain, find_site
from neurotouch_hid.gesture.elastic.kernels.fit import refine
from neurotouch_hid.gesture.elastic.kernels.markers import find_common, measure_sway, weigh_markers
from neurotouch_hid.gesture.elastic.kernels.motion import (
    choose_shown,
    locate,
    measure_motion,
    measure_size,
    subtract_landing,
)

Floats = NDArray[np.float64]

NOW, WARM, TRIED, COLD, BEST, N_FITS = range(6)
"""Places of fits: believed; followed; with one finger more or less; found from nothing; the best of
these."""

TURN_US = 10_000
"""What was found is doubted after so much time, whatever the length of the slices: fingers come and
go no faster, and each doubt costs as much as several slices without."""

STEPS_NONE, STEPS_ON, STEPS_LESS, STEPS_MORE = np.arange(4)
"""Gauss-Newton steps: none for a finger that was just added, to know its motion; of fingers that
are followed; without one of them; with one more. Numpy's numbers, for which numba makes one kernel
instead of four."""


@njit(cache=True, nogil=True)
def follow(
    hand: NDArray[np.void],
    fits: NDArray[np.void],
    gel: NDArray[np.void],
    config: NDArray[np.void],
    moved_px: Floats,
    use: NDArray[np.bool_],
    noise_mm: float,
    step_us: int,
    forming: bool,
    falling: bool,
) -> tuple[int, float, float, float, float, float, float, float]:
    """Fits the fingers to the displacements of one slice.

    Args:
        hand: (1,) ``HAND``, updated.
        fits: (N_FITS,) ``FIT``, updated; those of the slice in ``NOW``.
        gel: (1,) ``GEL``.
        config: (1,) ``CONFIG``.
        moved_px: (177, 2) px, displacements.
        use: (177,), measured markers.
        noise_mm: error of a marker, one axis.
        step_us: time since the slice before.
        forming: the gesture has just begun: look at everything afresh.
        falling: the fingers leave the gel; then no finger is added.

    Returns:
        The number of fingers that take part; their largest motion, how far everything moved
        together and the rms of what is not explained, mm; and what ``measure_motion`` returns.
    """
    me, rules = hand[0], config[0]
    _to_mm(moved_px, gel[0], me.moved)
    me.since_us += step_us
    me.unsought_us += step_us
    is_due = me.since_us >= TURN_US
    me.since_us %= TURN_US
    me.noise_mm = max(noise_mm, rules.least_noise_mm)
    total, field = _weigh(fits[NOW], me, rules, use)
    fits[WARM] = fits[NOW]
    is_warm = fits[WARM].count > 0
    if is_warm:
        _fit(fits[WARM], fits, me, gel[0], rules, STEPS_ON if is_due or forming else STEPS_NONE)
        may_doubt = me.unsought_us >= TURN_US or not math.isfinite(fits[WARM].cost)
        is_warm = not (may_doubt and _is_lost(fits[WARM], me, rules, total, field))
    if is_warm and is_due:
        if not falling:  # what fingers leave behind, as the gel follows late, looks like one more
            _extend(fits, me, gel[0], rules)
        if me.turn % 2 == 0:
            _reduce(fits, me, gel[0], rules)
    me.turn += is_due
    found = WARM
    if not is_warm or (is_due and forming and me.turn % 2 == 0):  # in turn with the above
        me.unsought_us = 0
        me.n_searches += 1
        is_cold = _search(fits, me, gel[0], rules)
        if is_cold and is_warm:
            least = 0.9 * _judge(fits[WARM], me, rules)
            is_cold = _judge(fits[BEST], me, rules) < least
        if is_cold:
            found = BEST
        elif not is_warm:
            fits[WARM].count = 0
    _adopt(found, fits, me, rules, step_us / TURN_US)
    fit = fits[NOW]
    n = fit.count
    if n == 0:
        me.parts[:] = 0.0
        me.since_us, me.turn, me.unsought_us = 0, 0, TURN_US
        return 0, 0.0, me.sway_mm, 0.0, 0.0, 0.0, 0.0, 1.0
    subtract_landing(fit.motions[:n], step_us, fit.landed[:n], fit.landed_us[:n], me.since[:n])
    n, centres, radii, motions, since = _leave_out_still(fit, me, rules)
    x, y, rotation, scale = measure_motion(centres, radii, motions, me.parts)
    measure_motion(centres, radii, since, me.parts)
    sway, error = math.hypot(fit.offset[0], fit.offset[1]), math.sqrt(0.5 * fit.cost / use.sum())
    return n, fit.largest_mm, sway, error, x, y, rotation, scale


@njit(cache=True, nogil=True)
def show(
    fits: NDArray[np.void], gel: NDArray[np.void], config: NDArray[np.void], least: int
) -> tuple[Floats, Floats, float]:
    """The contacts that are shown of the fingers in ``NOW``, at least one finger.

    Args:
        fits: (N_FITS,) ``FIT``; which fingers are shown is updated.
        gel: (1,) ``GEL``.
        config: (1,) ``CONFIG``.
        least: so many are shown in any case, if there are as many.

    Returns:
        Where they are, (k, 2) mm of the gel and (k, 2) px; how far they have dragged the gel in
        the mean, mm.
    """
    fit = fits[NOW]
    n = fit.count
    chosen = np.empty(n, np.bool_)
    still_mm = config[0].still_share * fit.largest_mm
    count = choose_shown(fit.radii[:n], fit.motions[:n], still_mm, fit.shown[:n], least, chosen)
    mm, px = np.empty((count, 2)), np.empty((count, 2))
    total_mm = 0.0
    rig = gel[0].rig
    k = 0
    for j in range(n):
        if not chosen[j]:
            continue
        x, y, dx, dy = locate(fit.centres[j], fit.radii[j], fit.motions[j], fit.press[j])
        mm[k, 0], mm[k, 1] = x, y
        px[k, 0] = rig[2] * mm[k, 0] - rig[3] * mm[k, 1] + rig[0]
        px[k, 1] = rig[3] * mm[k, 0] + rig[2] * mm[k, 1] + rig[1]
        total_mm += math.hypot(dx, dy)
        k += 1
    return mm, px, total_mm / count


@njit(cache=True, nogil=True)
def _leave_out_still(fit: Any, me: Any, rules: Any) -> tuple[int, Floats, Floats, Floats, Floats]:
    """The fingers that take part: how many, centres, radii, motions, motions since they landed."""
    centres, radii = np.empty((fit.count, 2)), np.empty(fit.count)
    motions, since = np.empty((fit.count, 3)), np.empty((fit.count, 3))
    n = 0
    for j in range(fit.count):
        if measure_size(fit.motions[j], fit.radii[j]) < rules.still_share * fit.largest_mm:
            continue
        centres[n], radii[n] = fit.centres[j], fit.radii[j]
        motions[n], since[n] = fit.motions[j], me.since[j]
        n += 1
    return n, centres[:n], radii[:n], motions[:n], since[:n]


@njit(cache=True, nogil=True)
def _to_mm(moved_px: Floats, gel: Any, moved: Floats) -> None:
    """Displacements (n, 2) in mm of the gel."""
    c, s = gel.rig[2], gel.rig[3]
    square = c * c + s * s
    for i in range(len(moved_px)):
        x, y = moved_px[i, 0], moved_px[i, 1]
        moved[i, 0], moved[i, 1] = (c * x + s * y) / square, (c * y - s * x) / square


@njit(cache=True, nogil=True)
def _weigh(fit: Any, me: Any, rules: Any, use: NDArray[np.bool_]) -> tuple[float, float]:
    """Trust in each marker; the sum of it, and the trusted sum of squares of the field."""
    residual, limit2 = me.moved, math.inf
    if fit.count > 0:
        error2 = me.noise_mm**2 + (rules.model_error * fit.largest_mm) ** 2
        residual, limit2 = fit.residual, rules.outlier**2 * error2
    total, field = weigh_markers(use, me.moved, residual, limit2, me.weight)
    return total, field


@njit(cache=True, nogil=True, inline="always")
def _fit(fit: Any, fits: NDArray[np.void], me: Any, gel: Any, rules: Any, n_steps: int) -> None:
    """Fits these fingers to the displacements."""
    moved, weight, trust = me.moved[:], me.weight[:], fits[NOW].trust[:]
    radius, noise, error = rules.radius_mm, me.noise_mm, rules.model_error
    refine(gel, fit, moved, weight, radius, trust, noise, error, n_steps)


@njit(cache=True, nogil=True)
def _is_lost(fit: Any, me: Any, rules: Any, total: float, field: float) -> bool:
    """True if the fingers followed so far have run into each other or explain too little."""
    error = 2.0 * total * me.noise_mm**2
    unexplained = rules.most_unexplained * (field - error)
    most = max(unexplained, _price(fit, me, rules))
    return not (_are_apart(fit, rules) and fit.cost - error < most)


@njit(cache=True, nogil=True)
def _price(fit: Any, me: Any, rules: Any) -> float:
    """What a finger must explain to be believed, mm²."""
    price: float = rules.noise_gain * me.noise_mm**2 + rules.field_gain * fit.largest_mm**2
    return price


@njit(cache=True, nogil=True)
def _judge(fit: Any, me: Any, rules: Any) -> float:
    """What a fit leaves and what its fingers must explain, mm²: less is better."""
    sum_mm2: float = fit.cost + fit.count * _price(fit, me, rules)
    return sum_mm2


@njit(cache=True, nogil=True)
def _are_apart(fit: Any, rules: Any) -> bool:
    least_mm = 0.85 * rules.spacing_mm
    for i in range(fit.count):
        for j in range(i):
            dx = fit.centres[i, 0] - fit.centres[j, 0]
            dy = fit.centres[i, 1] - fit.centres[j, 1]
            if math.hypot(dx, dy) <= least_mm:
                return False
    return True


@njit(cache=True, nogil=True)
def _find(fit: Any, me: Any, gel: Any, rules: Any, least: float) -> tuple[int, float]:
    """The site where a finger more explains most of what is left, and how much, mm².

    If it is less than ``least``, this may be any site.
    """
    me.n_asked += 1
    known = fit.centres[: fit.count]
    site, gain = find_site(
        gel.atoms,
        gel.inverse,
        fit.residual,
        me.weight,
        gel.sites,
        known,
        rules.fresh_mm,
        gel.n_coarse,
        least,
    )
    return site, gain


@njit(cache=True, nogil=True, inline="always")
def _add(fit: Any, fits: NDArray[np.void], me: Any, gel: Any, rules: Any, site: int) -> None:
    """Adds a finger at a site."""
    j = fit.count
    fit.centres[j, 0], fit.centres[j, 1] = gel.sites[site, 0], gel.sites[site, 1]
    fit.radii[j] = rules.radius_mm
    fit.motions[j, 0] = fit.motions[j, 1] = fit.motions[j, 2] = 0.0
    fit.count += 1
    _fit(fit, fits, me, gel, rules, STEPS_NONE)
    _fit(fit, fits, me, gel, rules, STEPS_MORE)


@njit(cache=True, nogil=True, inline="always")
def _extend(fits: NDArray[np.void], me: Any, gel: Any, rules: Any) -> None:
    """Adds a finger to those that are followed, if the field asks for it."""
    fit = fits[WARM]
    price = _price(fit, me, rules)
    if fit.count >= rules.most or fit.cost < rules.sure * 0.4 * price:
        return  # a finger explains no more than is left
    site, gain = _find(fit, me, gel, rules, 0.4 * price)
    if gain < 0.4 * price:
        return
    fits[TRIED] = fit
    _add(fits[TRIED], fits, me, gel, rules, site)
    if fit.cost - fits[TRIED].cost > price and _are_apart(fits[TRIED], rules):
        fits[WARM] = fits[TRIED]


@njit(cache=True, nogil=True, inline="always")
def _reduce(fits: NDArray[np.void], me: Any, gel: Any, rules: Any) -> None:
    """Leaves out the followed finger whose turn it is, if the field can do without it.

    It is asked every second turn, which tells soon enough and costs half.
    """
    fit = fits[WARM]
    if fit.count < 2:
        return
    fits[TRIED] = fit
    less = fits[TRIED]
    less.count -= 1
    for j in range(me.turn // 2 % fit.count, less.count):
        less.radii[j] = fit.radii[j + 1]
        for p in range(2):
            less.centres[j, p] = fit.centres[j + 1, p]
        for p in range(3):
            less.motions[j, p] = fit.motions[j + 1, p]
    _fit(less, fits, me, gel, rules, STEPS_LESS)
    if less.cost - fit.cost < rules.keep * _price(fit, me, rules):
        fits[WARM] = less


@njit(cache=True, nogil=True, inline="always")
def _search(fits: NDArray[np.void], me: Any, gel: Any, rules: Any) -> bool:
    """Looks for fingers from nothing, the strongest first; False if there are none.

    Those of the best fit are left in ``BEST``.
    """
    fit = fits[COLD]
    fit.count = 0
    moved = me.moved
    x, y = find_common(moved, me.weight)
    me.sway_mm = measure_sway(moved, me.weight, x, y)
    for i in range(len(moved)):
        fit.residual[i, 0], fit.residual[i, 1] = moved[i, 0] - x, moved[i, 1] - y
    least = rules.noise_gain * me.noise_mm**2
    if bound_gain(fit.residual, me.weight) < rules.sure * least:
        return False
    while fit.count < rules.most:
        site, gain = _find(fit, me, gel, rules, least)
        if gain < least:
            break
        _add(fit, fits, me, gel, rules, site)
        if fit.count == 1:
            if fit.largest_mm < rules.least_mm:
                return False
            fits[BEST] = fit
        elif _are_apart(fit, rules) and _judge(fit, me, rules) < _judge(fits[BEST], me, rules):
            fits[BEST] = fit
        least = 0.3 * _price(fit, me, rules)
        if fit.cost < rules.sure * least:
            break
    return bool(fit.count > 0)


@njit(cache=True, nogil=True)
def _adopt(place: int, fits: NDArray[np.void], me: Any, rules: Any, turns: float) -> None:
    """Believes a fit after so many turns; fingers keep the names of those that were near."""
    old, new = fits[NOW], fits[place]
    taken = 0
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
            new.ids[j] = me.next_id
            me.next_id += 1
        else:
            taken |= 1 << near
            new.ids[j], new.shown[j] = old.ids[near], old.shown[near]
            new.landed_us[j] = old.landed_us[near]
            for p in range(3):
                new.landed[j, p] = old.landed[near, p]
            new.trust[j] = min(0.98**turns * old.trust[near] + 0.25 * turns, 12.0)
    fits[NOW] = new

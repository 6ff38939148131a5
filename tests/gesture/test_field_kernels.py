"""The field of sticking fingers against its plain twin and against elasticity."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from neurotouch_hid.geometry import PAPER_GEL
from neurotouch_hid.gesture.elastic.fingers import FingerTracker
from neurotouch_hid.gesture.elastic.kernels.arrays import make_arrays
from neurotouch_hid.gesture.elastic.kernels.field import (
    N_ROWS,
    bound_gain,
    build_compliance,
    fill_responses,
    find_site,
    measure_arc,
    measure_gains,
    respond,
    respond_along,
    rim_window,
)
from tests.reference import gesture_elastic as reference

PLACE = st.floats(-26, 26)
RIM_MM = PAPER_GEL.rim_mm
RULES = FingerTracker().arrays.rules


def respond_everywhere(points, sites, regular=0.0):
    atoms = np.empty((2 * len(points), 3 * len(sites)))
    fill_responses(points, sites, 6.5, RIM_MM, atoms)
    rows = atoms.reshape(-1, len(sites), 3)
    gram = np.einsum("nsa,nsb->sab", rows, rows) + regular * np.eye(3)
    arrays = make_arrays(len(points), sites.copy(), RULES)
    arrays.atoms[:], arrays.inverse[:] = atoms, np.linalg.inv(gram)
    arrays.gel["n_coarse"] = len(sites)
    return arrays


@given(PLACE, PLACE, PLACE, PLACE, st.floats(4.5, 9))
def test_respond_equals_its_twin(x, y, cx, cy, a):
    xx, xy, yy, tx, ty = respond(x, y, rim_window(x * x + y * y, RIM_MM), cx, cy, a, RIM_MM)
    expected = reference.respond(x, y, cx, cy, a)
    np.testing.assert_allclose([[xx, xy, tx], [xy, yy, ty]], expected, atol=1e-9)


def test_the_arc_is_an_arc_sine():
    ratios = np.linspace(0.0, 1.0, 1001)
    arcs = [measure_arc(ratio) for ratio in ratios.tolist()]
    np.testing.assert_allclose(arcs, np.arcsin(ratios), atol=1e-10)


@given(st.lists(st.tuples(PLACE, PLACE), min_size=1, max_size=20), PLACE, PLACE, st.floats(4.5, 9))
def test_many_points_respond_as_each_alone(points, cx, cy, a):
    points = np.array([*points, (cx, cy), (cx + a, cy)])
    window = np.array([rim_window(float(r2), RIM_MM) for r2 in (points**2).sum(axis=1)])
    answer = np.empty((N_ROWS, len(points)))
    respond_along(points[:, 0].copy(), points[:, 1].copy(), window, cx, cy, a, RIM_MM, answer)
    each = [respond(x, y, w, cx, cy, a, RIM_MM) for (x, y), w in zip(points, window, strict=True)]
    np.testing.assert_array_equal(answer[:5].T, each)


@pytest.mark.parametrize("k", [1, 2, 3])
def test_couple_equals_its_twin(k):
    rng = np.random.default_rng(k)
    centres, radii = rng.uniform(-18, 18, (k, 2)), rng.uniform(5, 8, k)
    np.testing.assert_allclose(
        build_compliance(centres, radii, RIM_MM),
        reference.build_compliance(centres, radii),
        atol=1e-9,
    )


def test_a_single_finger_has_its_own_motion():
    np.testing.assert_allclose(
        build_compliance(np.zeros((1, 2)), np.full(1, 6.5), RIM_MM), np.eye(3), atol=1e-12
    )


def test_the_push_is_twice_as_large_along_as_across():
    """An incompressible half space far from the finger [Cerruti]; the rim is the same for both."""
    along = respond(20.0, 0.0, rim_window(400.0, RIM_MM), 0.0, 0.0, 2.0, RIM_MM)[0]
    across = respond(0.0, 20.0, rim_window(400.0, RIM_MM), 0.0, 0.0, 2.0, RIM_MM)[0]
    assert along / across == pytest.approx(2.0, abs=0.1)


@settings(max_examples=10)
@given(st.integers(0, 2**32 - 1))
def test_gains_equal_their_twin(seed):
    rng = np.random.default_rng(seed)
    points, sites = PAPER_GEL.points_mm[::5], PAPER_GEL.points_mm[60:110:9]
    residual, weight = rng.normal(0, 1, points.shape), rng.random(len(points))
    arrays = respond_everywhere(points, sites)
    gains = np.empty(len(sites))
    measure_gains(arrays.atoms, arrays.inverse, residual, weight, 0, gains[:2])
    measure_gains(arrays.atoms, arrays.inverse, residual, weight, 2, gains)
    expected = reference.gains(points, sites, 6.5, residual, weight)
    np.testing.assert_allclose(gains, expected, rtol=1e-5, atol=1e-6 * max(expected))


@settings(max_examples=10)
@given(st.integers(0, 2**32 - 1), st.sampled_from([0.01, 1.0, 20.0]))
def test_no_gain_exceeds_the_bound(seed, size):
    rng = np.random.default_rng(seed)
    points, sites = PAPER_GEL.points_mm, PAPER_GEL.points_mm[::3].copy()
    site = rng.integers(len(sites))
    arrays = respond_everywhere(points, sites)
    finger = (arrays.atoms[:, 3 * site : 3 * site + 3] @ rng.normal(0, size, 3)).reshape(-1, 2)
    residual, weight = finger + rng.normal(0, 0.05, points.shape), rng.random(len(points))
    bound = bound_gain(residual, weight)
    assert bound == pytest.approx((weight**2 @ residual**2).sum())
    assert bound <= weight @ (residual**2).sum(axis=1)
    gain = find_site(arrays, residual, weight, np.zeros((0, 2)), 5.0, 0.0)[1]
    assert 0.0 < gain <= 1.0005 * bound


def test_the_gain_of_a_finger_is_largest_where_it_is():
    arrays = respond_everywhere(PAPER_GEL.points_mm, PAPER_GEL.points_mm, 1e-6)
    for site in (88, 40, 120):
        field = (arrays.atoms[:, 3 * site : 3 * site + 3] @ (1.0, -2.0, 0.1)).reshape(-1, 2)
        best, gain = find_site(arrays, field, np.ones(len(field)), np.zeros((0, 2)), 5.0, 0.0)
        assert best == site
        assert gain == pytest.approx((field**2).sum(), rel=1e-3)


@settings(max_examples=10)
@given(st.integers(0, 2**32 - 1), st.integers(1, 3))
def test_no_site_is_found_near_a_known_finger(seed, k):
    rng = np.random.default_rng(seed)
    points, sites = PAPER_GEL.points_mm[::5], PAPER_GEL.points_mm[::2].copy()
    residual, weight = rng.normal(0, 1, points.shape), rng.random(len(points))
    centres = rng.uniform(-20, 20, (k, 2))
    arrays = respond_everywhere(points, sites)
    site, gain = find_site(arrays, residual, weight, centres, 9.0, 0.0)
    gains = reference.gains(points, sites, 6.5, residual, weight)
    free = np.hypot(*(sites[:, None] - centres).transpose(2, 0, 1)).min(axis=1) >= 9.0
    assert free[site]
    assert gain == pytest.approx(max(gains[free]), rel=1e-5)
    assert gains[site] == pytest.approx(gain, rel=1e-5)


def test_there_is_no_site_where_fingers_are_everywhere():
    arrays = respond_everywhere(PAPER_GEL.points_mm, PAPER_GEL.points_mm[:4])
    field, weight = np.ones(PAPER_GEL.points_mm.shape), np.ones(len(PAPER_GEL.points_mm))
    assert find_site(arrays, field, weight, arrays.sites, 5.0, 0.0)[1] == 0.0

"""The least squares of the fit against numpy."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from neurotouch_hid.geometry import PAPER_GEL, Rig
from neurotouch_hid.gesture.elastic.fingers import FingerTracker
from neurotouch_hid.gesture.elastic.kernels.arrays import WARM
from neurotouch_hid.gesture.elastic.kernels.columns import (
    N_WHOLE,
    build_columns,
    build_flow,
    build_slopes,
)
from neurotouch_hid.gesture.elastic.kernels.field import build_compliance, rim_window
from neurotouch_hid.gesture.elastic.kernels.fit import refine
from neurotouch_hid.gesture.elastic.kernels.least_squares import accumulate, invert, solve
from tests.reference import gesture_elastic as reference

RIM_MM = PAPER_GEL.rim_mm
WINDOW = np.array([rim_window(float(r2), RIM_MM) for r2 in (PAPER_GEL.points_mm**2).sum(axis=1)])
POINTS = np.ascontiguousarray(PAPER_GEL.points_mm.T)
TRACKER = FingerTracker()
TRACKER.place(PAPER_GEL.points_mm.astype(np.float32), Rig((0.0, 0.0), 1.0))  # a pixel a millimetre
ARRAYS = TRACKER.arrays
MARKERS = ARRAYS.markers[0]


@given(st.integers(0, 2**32 - 1), st.integers(1, 24), st.integers(1, 3))
def test_solve_equals_numpy(seed, n, k):
    rng = np.random.default_rng(seed)
    root, right = rng.normal(0, 1, (n, n + 3)), rng.normal(0, 1, (n, k))
    matrix = root @ root.T + 0.1 * np.eye(n)
    answer, factor = right.copy(), matrix.copy()
    assert solve(factor, answer)
    np.testing.assert_allclose(answer, np.linalg.solve(matrix, right), rtol=1e-7, atol=1e-9)


def test_solve_refuses_a_singular_system():
    assert not solve(np.array([[1.0, 1.0], [1.0, 1.0]]), np.ones((2, 1)))


@given(st.integers(0, 2**32 - 1), st.integers(1, 9))
def test_invert_equals_numpy(seed, n):
    rng = np.random.default_rng(seed)
    matrix = rng.normal(0, 1, (n, n)) + 4 * np.eye(n)
    inverse = matrix.copy()
    invert(inverse)
    np.testing.assert_allclose(inverse @ matrix, np.eye(n), atol=1e-8)


def make_fingers(k, seed):
    rng = np.random.default_rng(seed)
    angle = 2 * np.pi * np.arange(k) / k + rng.uniform(0, 6)
    centres = 12.0 * np.stack([np.cos(angle), np.sin(angle)], axis=1) + rng.normal(0, 1, 2)
    motions = np.column_stack([rng.normal(0, 4, (k, 2)), rng.normal(0, 0.2, k)])
    return centres, rng.uniform(5.5, 7.5, k), motions


def describe(centres, radii, motions):
    """Returns a new fit of these fingers."""
    ARRAYS.fits[WARM], k = np.zeros((), ARRAYS.fits.dtype), len(centres)
    fit = ARRAYS.fits[WARM]
    fit["count"] = k
    fit["centres"][:k], fit["radii"][:k], fit["motions"][:k] = centres, radii, motions
    return fit


def fit_to(moved, weight, *, noise_mm=0.05, model_error=0.02, n_steps):
    """Refines the fit without knowledge from earlier slices; returns what it does not explain."""
    MARKERS["moved"][:177], MARKERS["weight"][:177] = moved, weight
    ARRAYS.state["noise_mm"], ARRAYS.rules["model_error"] = noise_mm, model_error
    refine(ARRAYS, WARM, n_steps)
    return MARKERS["residual"][WARM, :177]


def invert_coupling(centres, radii):
    inverse = build_compliance(centres, radii, RIM_MM)
    invert(inverse)
    return inverse


@pytest.mark.parametrize("k", [1, 2, 3])
def test_columns_equal_their_twin(k):
    centres, radii, motions = make_fingers(k, k)
    columns, bent = np.empty((4 * k + N_WHOLE, 2, 177)), np.empty((2, 177))
    inverse = invert_coupling(centres, radii)
    build_columns(POINTS, WINDOW, centres, radii, motions, RIM_MM, inverse, columns, bent)
    columns = columns.transpose(2, 1, 0)
    expected = reference.columns(PAPER_GEL.points_mm, centres, radii)
    np.testing.assert_allclose(columns[:, :, : 3 * k], expected, atol=1e-9)
    np.testing.assert_allclose(
        columns[:, :, 3 * k : 4 * k],
        reference.presses(PAPER_GEL.points_mm, centres, radii),
        atol=1e-12,
    )
    np.testing.assert_allclose(
        bent.T, reference.bend(PAPER_GEL.points_mm, centres, radii, motions[:, 2]), atol=1e-9
    )
    np.testing.assert_array_equal(columns[5, :, 4 * k : 4 * k + 2], np.eye(2))
    r2 = (PAPER_GEL.points_mm**2).sum(axis=1)
    np.testing.assert_allclose(columns[:, 1, -1], np.maximum(1.0 - r2 / 31.0**2, 0.0))
    np.testing.assert_array_equal(columns[:, 0, -1], 0.0)


@pytest.mark.parametrize("k", [1, 2, 3])
def test_the_flow_equals_its_twin(k):
    centres, radii, _ = make_fingers(k, k)
    column = np.empty((2, 177))
    build_flow(POINTS, WINDOW, centres, radii, column)
    expected = reference.flow(PAPER_GEL.points_mm, centres, radii)
    np.testing.assert_allclose(column.T, expected, atol=1e-12)


@pytest.mark.parametrize("k", [1, 2, 3])
def test_slopes_equal_their_twin(k):
    centres, radii, motions = make_fingers(k, 20 + k)
    columns = np.empty((3 * k, 2, 177))
    inverse = invert_coupling(centres, radii)
    build_slopes(POINTS, WINDOW, centres, radii, motions, RIM_MM, inverse, columns)
    expected = reference.slopes(PAPER_GEL.points_mm, centres, radii, motions)
    np.testing.assert_allclose(columns.transpose(2, 1, 0), expected, atol=1e-9)


@settings(max_examples=20)
@given(st.integers(0, 2**32 - 1))
def test_normal_equations_equal_numpy(seed):
    rng = np.random.default_rng(seed)
    columns, weight = rng.normal(0, 1, (5, 2, 12)), rng.integers(0, 3, 12) / 2
    target = rng.normal(0, 1, (2, 12))
    normal, right = np.empty((5, 5)), np.empty((5, 1))
    accumulate(columns, target, weight, normal, right)
    expected = np.einsum("pan,n,qan->pq", columns, weight, columns)
    np.testing.assert_allclose(np.tril(normal), np.tril(expected), atol=1e-12)
    np.testing.assert_allclose(
        right[:, 0], np.einsum("pan,n,an->p", columns, weight, target), atol=1e-12
    )


@pytest.mark.parametrize("k", [1, 2, 3])
def test_refine_finds_the_fingers_of_the_twin(k):
    centres, radii, motions = make_fingers(k, 10 + k)
    moved = np.einsum(
        "nap,p->na", reference.columns(PAPER_GEL.points_mm, centres, radii), motions.ravel()
    ) + reference.bend(PAPER_GEL.points_mm, centres, radii, motions[:, 2])
    fit = describe(centres + 1.5, np.full(k, 6.5), np.zeros((k, 3)))
    before = (fit_to(moved, np.ones(177), n_steps=0) ** 2).sum()
    residual = fit_to(moved, np.ones(177), n_steps=12)
    assert fit["cost"] == pytest.approx((residual**2).sum())
    assert fit["cost"] < 0.1 * before
    np.testing.assert_allclose(fit["centres"][:k], centres, atol=0.6)
    np.testing.assert_allclose(fit["motions"][:k, :2], motions[:, :2], atol=0.3)
    np.testing.assert_allclose([fit["offset_x_mm"], fit["offset_y_mm"]], 0.0, atol=0.1)
    np.testing.assert_allclose(fit["whole"][:k], fit["motions"][:k], atol=0.05)  # no shear
    x, y, turn = fit["whole"][:k].T
    size_mm = np.sqrt(x**2 + y**2 + 0.5 * (turn * fit["radii"][:k]) ** 2)
    assert fit["largest_mm"] == pytest.approx(size_mm.max())


def test_without_information_the_cost_is_infinite():
    fit = describe(*make_fingers(2, 5))
    MARKERS["residual"][WARM] = 1.0
    residual = fit_to(np.ones((177, 2)), np.zeros(177), noise_mm=0.0, model_error=0.0, n_steps=1)
    assert fit["cost"] == np.inf
    assert not residual.any()


def test_markers_without_weight_do_not_count():
    centres, radii, motions = make_fingers(2, 3)
    moved = np.einsum(
        "nap,p->na", reference.columns(PAPER_GEL.points_mm, centres, radii), motions.ravel()
    )
    answers = []
    for spoil in (0.0, 30.0):
        weight = np.ones(177)
        weight[::7] = 0.0
        spoiled = moved.copy()
        spoiled[::7] += spoil
        fit = describe(centres, radii, np.zeros((2, 3)))
        fit_to(spoiled, weight, n_steps=2)
        answers.append(fit["motions"].copy())
    np.testing.assert_array_equal(*answers)

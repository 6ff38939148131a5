"""The least squares of the fit against numpy."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from neurotouch_hid.geometry import LATTICE_MM
from neurotouch_hid.gesture.elastic.field.kernels import couple, rim_window
from neurotouch_hid.gesture.elastic.fit.kernels import (
    accumulate,
    build_columns,
    invert,
    refine,
    solve,
)
from tests.reference import gesture_elastic as reference

WINDOW = np.array([rim_window(float(r2)) for r2 in (LATTICE_MM**2).sum(axis=1)])


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
    np.testing.assert_allclose(invert(matrix) @ matrix, np.eye(n), atol=1e-8)


def hand(k, seed):
    rng = np.random.default_rng(seed)
    angle = 2 * np.pi * np.arange(k) / k + rng.uniform(0, 6)
    centres = 12.0 * np.stack([np.cos(angle), np.sin(angle)], axis=1) + rng.normal(0, 1, 2)
    motions = np.column_stack([rng.normal(0, 4, (k, 2)), rng.normal(0, 0.2, k)])
    return centres, rng.uniform(5.5, 7.5, k), motions


@pytest.mark.parametrize("k", [1, 2, 3])
def test_columns_equal_their_twin(k):
    centres, radii, motions = hand(k, k)
    columns, bent = np.empty((177, 2, 4 * k + 3)), np.empty((177, 2))
    inverse = invert(couple(centres, radii))
    build_columns(LATTICE_MM, WINDOW, centres, radii, motions, inverse, False, columns, bent)
    expected = reference.columns(LATTICE_MM, centres, radii)
    np.testing.assert_allclose(columns[:, :, : 3 * k], expected, atol=1e-9)
    np.testing.assert_allclose(
        bent, reference.bend(LATTICE_MM, centres, radii, motions[:, 2]), atol=1e-9
    )
    np.testing.assert_array_equal(columns[5, :, 4 * k : 4 * k + 2], np.eye(2))


@settings(max_examples=20)
@given(st.integers(0, 2**32 - 1))
def test_normal_equations_equal_numpy(seed):
    rng = np.random.default_rng(seed)
    columns, weight = rng.normal(0, 1, (12, 2, 5)), rng.integers(0, 3, 12) / 2
    target, bent = rng.normal(0, 1, (12, 2)), rng.normal(0, 1, (12, 2))
    normal, right = np.empty((5, 5)), np.empty((5, 1))
    accumulate(columns, target, bent, weight, normal, right)
    expected = np.einsum("nap,n,naq->pq", columns, weight, columns)
    np.testing.assert_allclose(np.tril(normal), np.tril(expected), atol=1e-12)
    np.testing.assert_allclose(
        right[:, 0], np.einsum("nap,n,na->p", columns, weight, target - bent), atol=1e-12
    )


@pytest.mark.parametrize("k", [1, 2, 3])
def test_refine_finds_the_fingers_of_the_twin(k):
    centres, radii, motions = hand(k, 10 + k)
    moved = np.einsum(
        "nap,p->na", reference.columns(LATTICE_MM, centres, radii), motions.ravel()
    ) + reference.bend(LATTICE_MM, centres, radii, motions[:, 2])
    found, sizes = centres + 1.5, np.full(k, 6.5)
    answer, press, offset = np.zeros((k, 3)), np.zeros(k), np.zeros(3)
    residual, weight = np.empty((177, 2)), np.ones(177)
    fixed = (LATTICE_MM, WINDOW, moved, weight, found, sizes, 6.5, np.zeros(k))
    refine(*fixed, answer, press, offset, residual, 0.05, 0.02, 0)
    before = (residual**2).sum()
    cost = refine(*fixed, answer, press, offset, residual, 0.05, 0.02, 12)
    assert cost == pytest.approx((residual**2).sum())
    assert cost < 0.1 * before
    np.testing.assert_allclose(found, centres, atol=0.6)
    np.testing.assert_allclose(answer[:, :2], motions[:, :2], atol=0.3)
    np.testing.assert_allclose(offset[:2], 0.0, atol=0.1)


def test_markers_without_weight_do_not_count():
    centres, radii, motions = hand(2, 3)
    moved = np.einsum("nap,p->na", reference.columns(LATTICE_MM, centres, radii), motions.ravel())
    answers = []
    for spoil in (0.0, 30.0):
        weight = np.ones(177)
        weight[::7] = 0.0
        spoiled = moved.copy()
        spoiled[::7] += spoil
        answer = np.zeros((2, 3))
        refine(
            LATTICE_MM, WINDOW, spoiled, weight, centres.copy(), radii.copy(), 6.5, np.zeros(2),
            answer, np.zeros(2), np.zeros(3), np.empty((177, 2)), 0.05, 0.02, 2,
        )  # fmt: skip
        answers.append(answer)
    np.testing.assert_array_equal(*answers)

"""Statistics of all markers against numpy."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from neurotouch_hid.gesture.elastic.kernels.markers import (
    find_common,
    find_lone,
    measure_spread,
    measure_sway,
    weigh_markers,
)


@given(st.integers(0, 2**32 - 1), st.floats(0.01, 5.0))
def test_markers_far_off_the_fit_are_trusted_less(seed, limit_mm2):
    rng = np.random.default_rng(seed)
    moved, residual = rng.normal(0, 3, (40, 2)), rng.normal(0, 1, (40, 2))
    use, weight = rng.random(40) < 0.8, np.empty(40)
    total, field, hidden = weigh_markers(use, moved, residual, limit_mm2, weight)
    expected = use / (1.0 + ((residual**2).sum(axis=1) / limit_mm2) ** 2)
    np.testing.assert_allclose(weight, expected, rtol=1e-12)
    assert total == pytest.approx(expected.sum())
    assert field == pytest.approx((expected * (moved**2).sum(axis=1)).sum())
    assert hidden == pytest.approx(((use - expected) * (residual**2).sum(axis=1)).sum())


def test_without_a_fit_all_measured_markers_are_trusted():
    use, moved, weight = np.array([True, False]), np.ones((2, 2)), np.empty(2)
    assert weigh_markers(use, moved, moved, np.inf, weight) == (1.0, 2.0, 0.0)
    assert weight.tolist() == [1.0, 0.0]


@given(st.integers(0, 2**32 - 1), st.integers(1, 30))
def test_the_common_motion_is_the_median_of_trusted_markers(seed, n):
    rng = np.random.default_rng(seed)
    moved, weight = rng.normal(0, 1, (n, 2)), rng.random(n) * (rng.random(n) < 0.7)
    weight[0] = 1.0
    assert find_common(moved, weight) == tuple(np.median(moved[weight > 0], axis=0))


@pytest.mark.parametrize(("others", "lone"), [(0.0, 3), (0.4, 3), (0.6, -1), (1.0, -1)])
def test_a_marker_is_alone_that_is_more_than_half_of_what_a_finger_explains(others, lone):
    before, weight = np.zeros((9, 2)), np.ones(9)
    before[3] = [1.0, 0.0]
    before[5:] = [0.0, others]
    after = np.zeros((9, 2))
    after[0] = [2.0, 0.0]  # what a finger makes worse says nothing of it
    assert find_lone(before, after, weight) == lone
    weight[3] = 0.0
    assert find_lone(before, after, weight) == -1


@given(st.integers(0, 2**32 - 1), st.integers(1, 30))
def test_the_sway_is_what_three_quarters_of_the_trusted_markers_share(seed, n):
    rng = np.random.default_rng(seed)
    moved, weight = rng.normal(0.5, 1, (n, 2)), rng.random(n) * (rng.random(n) < 0.7)
    weight[0] = 1.0
    along = np.sort(moved[weight > 0] @ [0.6, 0.8])
    expected = max(along[len(along) // 4], 0.0)
    assert measure_sway(moved, weight, 3.0, 4.0) == pytest.approx(expected)
    assert measure_sway(moved, weight, 0.0, 0.0) == 0.0


@given(st.integers(0, 2**32 - 1), st.integers(1, 30))
def test_the_spread_is_that_of_trusted_markers(seed, n):
    rng = np.random.default_rng(seed)
    moved, weight = rng.normal(0, 1, (n, 2)), rng.random(n) * (rng.random(n) < 0.7)
    weight[0] = 1.0
    trusted = moved[weight > 0]
    away = np.abs(trusted - np.median(trusted, axis=0))
    assert measure_spread(moved, weight) == pytest.approx(1.4826 * np.median(away))


def test_the_spread_of_noise_is_its_standard_deviation():
    moved = np.random.default_rng(0).normal(5.0, 0.3, (10_000, 2))
    assert measure_spread(moved, np.ones(10_000)) == pytest.approx(0.3, rel=0.03)

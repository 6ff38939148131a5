"""The kernels against their plain twins."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from neurotouch_hid.gesture.kernels import (
    find_homography_outliers,
    find_near,
    find_peaks,
    smooth_displacement,
)
from tests.reference import gesture as reference


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(0, 60), st.integers(1, 6), st.booleans())
def test_find_peaks_equals_its_twin(seed, n, min_neighbours, with_ties):
    rng = np.random.default_rng(seed)
    position = rng.uniform(0, 100, (n, 2))
    magnitude = rng.uniform(0, 10, n)
    if with_ties:
        position, magnitude = np.round(position, -1), np.round(magnitude)
    candidate = rng.random(n) < 0.6
    peaks = find_peaks(position, magnitude, candidate, 30.0, min_neighbours)
    expected = reference.find_peaks(position, magnitude, candidate, 30.0, min_neighbours)
    assert peaks.tolist() == expected


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(0, 60), st.integers(0, 4), st.booleans())
def test_find_near_equals_its_twin(seed, n, k, on_grid):
    rng = np.random.default_rng(seed)
    position, points = rng.uniform(0, 100, (n, 2)), rng.uniform(0, 100, (k, 2))
    if on_grid:
        position, points = np.round(position, -1), np.round(points, -1)
    near = find_near(position, points, 30.0)
    assert near.tolist() == reference.find_near(position, points, 30.0)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(0, 60))
def test_smooth_displacement_equals_its_twin(seed, n):
    rng = np.random.default_rng(seed)
    rest, displacement = np.round(rng.uniform(0, 100, (n, 2)), -1), rng.normal(0, 9, (n, 2))
    mean = smooth_displacement(rest, displacement, 30.0)
    expected = reference.smooth_displacement(rest, displacement, 30.0)
    np.testing.assert_allclose(mean, np.reshape(expected, (n, 2)), atol=1e-12)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(0, 60), st.floats(0.0, 0.6))
def test_find_homography_outliers_equals_its_twin(seed, n, spoiled):
    rng = np.random.default_rng(seed)
    source = rng.uniform(-1, 1, (n, 2))
    bend = rng.normal(0, 0.05, (3, 3)) + np.eye(3)
    target = np.c_[source, np.ones(n)] @ bend.T
    target = target[:, :2] / target[:, 2:] + rng.normal(0, 0.005, (n, 2))
    target += (rng.random((n, 1)) < spoiled) * rng.normal(0, 0.2, (n, 2))
    outlier = find_homography_outliers(source, target, 0.02, 0.995, 2000)
    expected = reference.find_homography_outliers(source, target, 0.02, 0.995, 2000)
    assert outlier.tolist() == expected


def test_find_homography_outliers_finds_the_points_that_were_moved():
    source = np.stack(np.meshgrid(np.linspace(-1, 1, 9), np.linspace(-1, 1, 9)), -1).reshape(-1, 2)
    moved = np.hypot(*(source - (0.5, 0.25)).T) < 0.4
    target = source * 1.1 + 0.1 * moved[:, None]
    outlier = find_homography_outliers(source, target, 0.03, 0.995, 2000)
    assert moved.sum() > 5
    assert outlier.tolist() == moved.tolist()


def test_points_on_a_line_have_no_homography():
    line = np.stack([np.linspace(-1, 1, 12), np.linspace(-1, 1, 12)], axis=1)
    assert find_homography_outliers(line, line, 0.1, 0.995, 50).all()

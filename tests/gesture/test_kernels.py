"""The kernels against their plain twins."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from neurotouch_hid.gesture.kernels.displacement import displace
from neurotouch_hid.gesture.paper.kernels.neighbourhoods import (
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


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(0, 60))
def test_displace_equals_its_twin(seed, n):
    rng = np.random.default_rng(seed)
    rest, position = rng.uniform(0, 346, (2, n, 2)).astype(np.float32)
    position[rng.random((n, 2)) < 0.1] = np.nan
    valid = rng.random(n) < 0.8
    moved, use = np.empty((n, 2)), np.empty(n, np.bool_)
    expected = reference.displace(rest.tolist(), position.tolist(), valid)
    assert displace(rest, position, valid, moved, use) == sum(use)
    assert use.tolist() == [step is not None for step in expected]
    assert moved.tolist() == [step or [0.0, 0.0] for step in expected]

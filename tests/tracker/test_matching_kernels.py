"""Pairs of points against their plain twins."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from neurotouch_hid.tracker.kernels import matching as kernels
from tests.reference import tracker as reference


@given(st.integers(0, 2**32 - 1), st.integers(0, 40), st.integers(0, 40))
@settings(max_examples=50, deadline=None)
def test_motions_are_those_of_the_pairs(seed, n, m):
    rng = np.random.default_rng(seed)
    before, now = rng.uniform(0, 30, (n, 2)), rng.uniform(0, 30, (m, 2))
    match = np.empty(n, np.int32)
    expected = reference.match_points(before.tolist(), now.tolist(), 4.0)
    sizes = sorted(np.hypot(*(now[j] - before[i])) for i, j in enumerate(expected) if j >= 0)
    for left_out in (0, 2):
        n_pairs, largest = kernels.measure_largest(before, now, 4.0, left_out, match)
        assert match.tolist() == expected
        assert n_pairs == len(sizes)
        wanted = sizes[max(len(sizes) - 1 - left_out, 0)] if sizes else 4.0
        assert largest == pytest.approx(wanted, rel=1e-12)


@given(st.integers(0, 2**32 - 1), st.integers(0, 40), st.integers(0, 40))
@settings(max_examples=50, deadline=None)
def test_shared_motion_is_that_of_its_definition(seed, n, m):
    rng = np.random.default_rng(seed)
    before, now = rng.uniform(0, 30, (n, 2)), rng.uniform(0, 30, (m, 2))
    match = np.empty(n, np.int32)
    n_pairs, all_px, bent_px = kernels.measure_shared(before, now, 4.0, 9.0, 0.0, np.inf, match)
    expected = reference.match_points(before.tolist(), now.tolist(), 4.0)
    assert match.tolist() == expected
    pairs = [(i, j) for i, j in enumerate(expected) if j >= 0]
    assert n_pairs == len(pairs)
    if not pairs:
        assert all_px == bent_px == 4.0
        return
    place, moved = np.array([(before[i], now[j] - before[i]) for i, j in pairs]).transpose(1, 0, 2)
    rest = moved - moved.mean(axis=0)
    products = [
        rest[i] @ rest[j] for i in range(len(place)) for j in range(i)
        if np.hypot(*(place[i] - place[j])) < 9.0
    ]  # fmt: skip
    assert all_px == pytest.approx(np.hypot(*moved.mean(axis=0)), rel=1e-9)
    assert bent_px**2 == pytest.approx(max(np.mean(products or [0.0]), 0.0), abs=1e-9)


def test_what_neighbours_share_is_not_measured_where_all_move_far_or_few_are_seen():
    before = np.random.default_rng(3).uniform(0, 300, (50, 2))
    match = np.empty(50, np.int32)
    far = kernels.measure_shared(before, before + 0.5, 4.0, 9.0, 40.0, 0.3, match)
    few = kernels.measure_shared(before, before[:30], 4.0, 9.0, 40.0, 0.3, match)
    assert far[1] == pytest.approx(np.hypot(0.5, 0.5))
    assert few[0] <= 30
    assert far[2] == few[2] == np.inf


@given(st.integers(0, 2**32 - 1), st.integers(0, 40), st.integers(0, 40))
@settings(max_examples=50, deadline=None)
def test_pairs_are_mutual_and_clear(seed, n, m):
    rng = np.random.default_rng(seed)
    targets, points = rng.uniform(0, 30, (n, 2)), rng.uniform(0, 30, (m, 2))
    out = np.empty(n, np.int32)
    n_pairs = kernels.match_points(targets, points, 4.0, out)
    assert out.tolist() == reference.match_points(targets.tolist(), points.tolist(), 4.0)
    assert n_pairs == (out >= 0).sum()

"""Labels between their moments."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.evaluation.accuracy.label_track import LabelTrack, pair_points
from neurotouch_hid.messages import GestureKind, Truth


def label(t_us, kind, points, intensity):
    return Truth(t_us, kind, np.array(points, float).reshape(-1, 2), intensity)


TRACK = LabelTrack(
    [
        label(1000, GestureKind.NONE, [], 0.0),
        label(2000, GestureKind.PINCH, [[10, 0], [50, 0]], 2.0),
        label(3000, GestureKind.PINCH, [[40, 0], [20, 10]], 4.0),
        label(4000, GestureKind.PUSH, [[42, 0]], 3.0),
        label(5000, GestureKind.NONE, [], 0.0),
    ]
)


def test_nothing_is_known_outside_the_labels():
    assert TRACK.at(999) is None
    assert TRACK.at(5001) is None
    assert TRACK.at(1000).kind is TRACK.at(5000).kind is GestureKind.NONE


def test_type_is_the_most_recent_and_intensity_is_interpolated():
    assert TRACK.at(1999).kind is GestureKind.NONE
    assert TRACK.at(1500).intensity_mm == pytest.approx(1.0)
    assert TRACK.at(2000).kind is GestureKind.PINCH
    assert TRACK.at(3999).kind is GestureKind.PINCH
    assert TRACK.at(4250).intensity_mm == pytest.approx(3 * 0.75)


def test_points_are_interpolated_with_their_nearest_partner():
    np.testing.assert_allclose(TRACK.at(2500).contacts_px, [[15, 5], [45, 0]])
    np.testing.assert_allclose(TRACK.at(2000).contacts_px, [[10, 0], [50, 0]])


def test_number_of_points_is_the_most_recent():
    assert TRACK.at(1500).contacts_px.shape == (0, 2)
    np.testing.assert_allclose(TRACK.at(3500).contacts_px, [[41, 0], [20, 10]])
    np.testing.assert_allclose(TRACK.at(4500).contacts_px, [[42, 0]])


def test_interpolation_leaves_the_labels_alone():
    before = TRACK.at(2000).contacts_px.copy()
    TRACK.at(2900)
    np.testing.assert_array_equal(TRACK.at(2000).contacts_px, before)


@pytest.mark.parametrize(
    ("t_us", "expected"), [(499, None), (500, 1000), (1499, 1000), (1501, 2000), (5400, 5000)]
)
def test_nearest(t_us, expected):
    found = TRACK.nearest(t_us)
    assert (found.t_us if found else None) == expected
    assert TRACK.nearest(5501) is None


def test_no_labels_is_an_error():
    with pytest.raises(RecordingError, match="no labels"):
        LabelTrack([])


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(0, 3), st.integers(0, 3))
def test_pairs_have_the_least_sum(seed, n, m):
    rng = np.random.default_rng(seed)
    first, second = rng.uniform(0, 100, (n, 2)), rng.uniform(0, 100, (m, 2))
    rows, columns = pair_points(first, second)
    assert len(set(rows)) == len(set(columns)) == len(rows) == len(columns) == min(n, m)
    total = np.linalg.norm(first[rows] - second[columns], axis=1).sum()
    for other_rows in itertools.permutations(range(n), min(n, m)):
        for other in itertools.combinations(range(m), min(n, m)):
            rival = np.linalg.norm(first[list(other_rows)] - second[list(other)], axis=1).sum()
            assert total <= rival + 1e-9

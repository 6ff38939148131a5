"""How far two people agree."""

import math

import pytest

from neurotouch_hid.labelling.agreement import find_differences, measure_agreement
from neurotouch_hid.labelling.track import Run
from tests.labelling.made import make_track


def track(kinds, shift=0.0):
    return make_track(kinds, [[(10.0 + shift, 10.0)] if kind > 0 else [] for kind in kinds])


def test_kappa_of_a_table():
    """A table with both marginals 6 and 4 of 10: same 0.8, by chance 0.52."""
    mine = track([1, 1, 1, 1, 1, 1, 0, 0, 0, 0])
    other = track([1, 1, 1, 1, 1, 0, 1, 0, 0, 0])
    found = measure_agreement(mine, other, 2.5)
    assert found.same_type == pytest.approx(0.8)
    assert found.kappa == pytest.approx((0.8 - 0.52) / 0.48)
    assert found.n_moments == 10


def test_only_what_both_have_labelled_counts():
    found = measure_agreement(track([1, -1, 0]), track([1, 2, -1]), 2.5)
    assert (found.n_moments, found.same_type, found.kappa) == (1, 1.0, None)
    assert measure_agreement(track([1, -1]), track([-1, 1]), 2.5) is None


def test_distances_are_millimetres():
    found = measure_agreement(track([1, 2, 0]), track([1, 2, 0], shift=5.0), 2.5)
    assert found.contact_mm == pytest.approx(2.0)
    assert found.intensity_mm == 0.0
    assert found.kappa == 1.0


def test_without_a_common_gesture_there_is_no_distance():
    found = measure_agreement(track([0, 1]), track([0, 0]), 2.5)
    assert (found.contact_mm, found.intensity_mm) == (None, None)
    assert not math.isnan(found.same_count)


def test_differences_are_parts_of_my_runs():
    mine = track([0, 0, 1, 1, 1, 2, -1])
    other = track([0, 1, 1, 0, 1, 1, 1])
    assert find_differences(mine, other) == [Run(1, 1, 0), Run(3, 3, 1), Run(5, 5, 2)]


def test_another_number_of_contacts_is_a_difference():
    mine = make_track([1, 1], [[(1, 1)], [(1, 1)]])
    other = make_track([1, 1], [[(1, 1), (9, 9)], [(1, 1)]])
    assert find_differences(mine, other) == [Run(0, 0, 1)]

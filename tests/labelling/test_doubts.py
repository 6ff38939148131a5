"""Where a person is sent to look."""

import numpy as np
import pytest

from neurotouch_hid.labelling.doubts import find_doubts
from tests.labelling.made import make_moments

REST, POINT = [], [(1.0, 1.0)]


def find(kinds, contacts=None, change=None, **how):
    contacts = contacts or [POINT if kind else REST for kind in kinds]
    moments = make_moments(kinds, contacts, **how)
    if change is not None:
        change(moments)
    return [(doubt.moment, doubt.reason) for doubt in find_doubts(moments)]


def test_a_clear_gesture_needs_no_look():
    assert find([0] * 4 + [1] * 8 + [0] * 4) == []


@pytest.mark.parametrize(
    ("kinds", "how", "words"),
    [
        ([0, 0, 1, 1, 0, 0], {}, "Short: 80 ms"),
        ([0] * 3 + [1] * 8 + [2] * 8, {}, "without a rest"),
        ([0] * 3 + [1] * 8 + [0], {"confidence": 0.4}, "not sure"),
        ([0] * 8, {"peak_mm": 1.2}, "no gesture is recognised"),
    ],
)
def test_reasons(kinds, how, words):
    ((_, reason),) = find(kinds, **how)
    assert words in reason


def test_a_faint_one_is_seen_where_it_is_strongest():
    def weaken(moments):
        moments.proposals.intensity_mm[:] = 1.0
        moments.peak_mm[7] = 0.9

    assert find([0] * 3 + [1] * 8 + [0], change=weaken) == [(7, "Faint.")]


def test_a_change_of_the_number_of_contacts():
    contacts = [REST] * 3 + [POINT] * 4 + [POINT * 2] * 4
    ((_, reason),) = find([0] * 3 + [2] * 8, contacts)
    assert "number of contacts" in reason


def test_dots_that_are_not_seen():
    def hide(moments):
        moments.is_seen[3:11, :2] = False

    ((_, reason),) = find([0] * 3 + [1] * 8 + [0], change=hide)
    assert "Many dots" in reason


def test_a_moment_has_one_reason():
    moments = find([0, 1, 2, 0], confidence=0.1)
    assert len(moments) == len(np.unique([k for k, _ in moments])) == 2

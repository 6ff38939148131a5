"""The common motion and the contacts against plain twins."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from neurotouch_hid.gesture.elastic.kernels.motion import (
    choose_shown,
    locate,
    measure_motion,
    measure_peak,
    measure_size,
)
from neurotouch_hid.messages import GestureKind
from tests.reference import gesture_elastic as reference

SEED = st.integers(0, 2**32 - 1)


def draw(seed, k):
    rng = np.random.default_rng(seed)
    motions = np.column_stack([rng.normal(0, 3, (k, 2)), rng.uniform(-0.9, 0.9, k)])
    return rng.uniform(-20, 20, (k, 2)), rng.uniform(4.5, 9, k), motions


@given(SEED, st.integers(1, 3))
def test_the_motion_equals_its_twin(seed, k):
    centres, radii, motions = draw(seed, k)
    parts = np.full(6, np.nan)
    told = measure_motion(centres, radii, motions, parts)
    expected, expected_parts = reference.measure_motion(centres, radii, motions)
    np.testing.assert_allclose(told, expected, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(parts, expected_parts, rtol=1e-9, atol=1e-9)


def test_a_single_finger_that_drags_and_turns_by_as_much_pushes():
    centre, radius, parts = np.zeros((1, 2)), np.array([7.0]), np.empty(6)
    for turn, kind in ((0.13, GestureKind.PUSH), (0.5, GestureKind.TWIST_CW)):
        measure_motion(centre, radius, np.array([[-0.1, 0.6, turn]]), parts)
        assert parts.argmax() == kind


@given(SEED, st.floats(-2, 2))
def test_a_contact_is_where_its_twin_is(seed, press):
    (centre,), (radius,), (motion,) = draw(seed, 1)
    expected = reference.locate(centre, radius, motion, press)
    np.testing.assert_allclose(locate(centre, radius, motion, press), expected, atol=0.05)


def test_the_size_is_the_rms_over_the_patch():
    assert measure_size(np.array([3.0, 4.0, 0.0]), 6.0) == 5.0
    assert measure_size(np.array([0.0, 0.0, 0.5]), 6.0) == pytest.approx(3.0 / np.sqrt(2.0))


@given(SEED, st.floats(-2, 2))
def test_the_peak_is_how_far_the_farthest_dot_on_the_lever_seems_to_go(seed, press):
    (centre,), (radius,), (motion,) = draw(seed, 1)
    way = 2j * np.pi * np.arange(720) / 720
    lever = 0.7 * radius * np.exp(way)
    dots = complex(*motion[:2]) + press / 100.0 * complex(*centre) + 1j * motion[2] * lever
    peak_mm = measure_peak(centre, radius, motion, press)
    assert peak_mm == pytest.approx(np.abs(dots).max(), rel=1e-4)


def test_two_fingers_that_land_and_tremble_alike_are_no_push_yet():
    centres, radii, parts = np.array([[-9.0, 0.0], [9.0, 0.0]]), np.full(2, 6.5), np.empty(6)
    for common_mm, kind in ((0.1, GestureKind.PINCH), (0.6, GestureKind.PUSH)):
        closing_mm = 0.05
        motions = np.array([[closing_mm, common_mm, 0.0], [-closing_mm, common_mm, 0.0]])
        measure_motion(centres, radii, motions, parts)
        assert parts.argmax() == kind


def test_a_finger_is_shown_from_one_size_on_and_hidden_below_another():
    shown, chosen, seen = np.zeros(2, np.int64), np.empty(2, np.bool_), []
    for peak_mm in (0.32, 0.35, 0.32, 0.29, 0.32):
        peaks_mm = np.array([peak_mm, 5.0])
        assert choose_shown(peaks_mm, 0.0, shown, 1, chosen) == chosen.sum()
        assert chosen.tolist() == shown.tolist()
        assert shown[1] == 1
        seen.append(int(shown[0]))
    assert seen == [0, 1, 1, 0, 0]


def test_a_still_finger_is_shown_only_if_a_second_contact_is_required():
    shown, chosen, peaks_mm = np.zeros(2, np.int64), np.empty(2, np.bool_), np.array([0.9, 5.0])
    assert choose_shown(peaks_mm, 1.0, shown, 1, chosen) == 1
    assert shown.tolist() == [0, 1]
    assert choose_shown(peaks_mm, 1.0, shown, 2, chosen) == 2


@pytest.mark.parametrize(
    ("least", "expected"),
    [(1, [False, True, False]), (2, [False, True, True]), (3, [True] * 3), (4, [True] * 3)],
)
def test_the_largest_are_shown_if_few_are_large(least, expected):
    shown, chosen = np.zeros(3, np.int64), np.empty(3, np.bool_)
    peaks_mm = np.array([0.1, 0.2, 0.15])
    assert choose_shown(peaks_mm, 0.0, shown, least, chosen) == sum(expected)
    assert chosen.tolist() == expected
    assert not shown.any()

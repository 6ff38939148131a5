"""What is known of a gesture's begin when it is over."""

import numpy as np

from neurotouch_hid.labelling.hindsight import apply_hindsight
from tests.labelling.made import make_track

POINT = [(7.0, 7.0)]


def apply(kinds, peaks_mm=None):
    track = make_track(kinds, [POINT if kind else [] for kind in kinds])
    n = len(kinds)
    peaks = np.float32(peaks_mm if peaks_mm is not None else [0.0] * n)
    apply_hindsight(track, 40_000 * np.arange(n), peaks, 2.5)
    return track


def test_another_type_at_the_begin_was_the_begin():
    assert apply([0, 5, 1, 2, 2, 2, 2, 2, 2, 0]).kind.tolist() == [0, 2, 2, 2, 2, 2, 2, 2, 2, 0]


def test_a_moment_of_rest_between_is_none():
    assert apply([0, 3, 0, 2, 2, 2, 2, 2, 2, 0]).kind.tolist() == [0, 2, 2, 2, 2, 2, 2, 2, 2, 0]


def test_two_long_gestures_stay_two():
    kinds = [0] + [3] * 6 + [2] * 6 + [0]
    assert apply(kinds).kind.tolist() == kinds


def test_a_tap_before_a_rest_stays():
    kinds = [0, 1, 1, 0, 0, 0, 2, 2, 2, 2, 2, 2, 0]
    assert apply(kinds).kind.tolist() == kinds


def test_a_gesture_lasts_as_long_as_it_is_visible():
    """One pixel is 0.4 mm here. The intensity goes with the displacement."""
    peaks = [0.1, 0.5, 1.0, 2.0, 2.0, 1.0, 0.3, 0.9]
    track = apply([0, 0, 0, 1, 1, 0, 0, 0], peaks)
    assert track.kind.tolist() == [0, 1, 1, 1, 1, 1, 0, 0]
    np.testing.assert_allclose(track.intensity_mm, [0, 0.5, 1, 2, 2, 1, 0, 0])
    assert track.points(1).tolist() == [[7.0, 7.0]]


def test_a_gesture_does_not_reach_into_the_next():
    kinds = [0] + [1] * 6 + [0] * 3 + [2] * 6
    found = apply(kinds, [1.0] * 16).kind.tolist()
    assert found == [1] * 10 + [2] * 6

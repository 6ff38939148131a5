"""How far fingers have moved since they landed."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from neurotouch_hid.geometry import PAPER_GEL, Rig
from neurotouch_hid.gesture.elastic.kernels.arrays import NOW
from neurotouch_hid.gesture.elastic.kernels.motion import (
    LANDING_MM,
    LANDING_SHARE,
    LANDING_US,
    subtract_landing,
)
from tests.gesture.elastic import field
from tests.gesture.stages import Fingers
from tests.reference import gesture_elastic as reference

STEP_US = 10_000


class Landings:
    def __init__(self, k):
        self.landed, self.landed_us = np.full((k, 3), np.nan), np.zeros(k, np.int64)

    def subtract(self, motions, step_us=STEP_US):
        since = np.empty((len(motions), 3))
        subtract_landing(np.array(motions), step_us, self.landed, self.landed_us, since)
        return since


def test_a_landing_counts_little_and_the_rest_in_full():
    fingers, landed = Landings(1), np.array([[0.3, 0.0, 0.0]])
    for _ in range(LANDING_US // STEP_US):
        since = fingers.subtract(landed)
    np.testing.assert_allclose(since, (1 - LANDING_SHARE) * landed)
    moved = fingers.subtract(landed + np.array([0.0, 2.0, 0.1]))
    np.testing.assert_allclose(moved - since, [[0.0, 2.0, 0.1]])


def test_a_quick_gesture_keeps_nearly_all_of_its_motion():
    fingers = Landings(1)
    for mm in (0.0, 2.0, 4.0, 6.0, 8.0, 10.0, 12.0):
        since = fingers.subtract([[mm, 0.0, 0.0]])
    assert since[0, 0] == pytest.approx(12.0 - LANDING_SHARE * LANDING_MM)


@given(st.integers(0, 2**32 - 1), st.sampled_from([1_000, 4_000, 10_000]), st.integers(1, 3))
def test_landings_equal_their_twin(seed, step_us, k):
    rng = np.random.default_rng(seed)
    fingers, twin = Landings(k), reference.Landing()
    for motions in rng.normal(0, 0.5, (12, k, 3)):
        expected = twin.subtract(range(k), motions, step_us)
        np.testing.assert_allclose(fingers.subtract(motions, step_us), expected, atol=1e-12)


def test_each_finger_lands_for_itself():
    tracker = Fingers()
    tracker.place(PAPER_GEL.points_mm.astype(np.float32), Rig((0.0, 0.0), 1.0))
    sees_all, twin = np.ones(len(PAPER_GEL.points_mm), np.bool_), reference.Landing()
    places = np.array([[-12.0, 0.0], [12.0, 0.0]])
    counts = []
    for t in range(30):
        drags = np.array([[0.1 * t, 0.0], [0.0, 0.2 * max(t - 12, 0)]])
        k = 1 + (12 < t < 25)
        motion = tracker.update(field(places[:k], drags[:k]), sees_all, 0.05, forming=True)
        if not motion.n_fingers:
            continue
        fit, n = tracker.arrays.fits[NOW], motion.n_fingers
        since = twin.subtract(fit["ids"][:n].tolist(), fit["whole"][:n], 10_000)
        np.testing.assert_allclose(tracker.arrays.state["since"][0, :n], since, atol=1e-12)
        parts = reference.measure_motion(fit["centres"][:n], fit["radii"][:n], since)[1]
        np.testing.assert_allclose(motion.parts_mm, parts, atol=1e-9)
        counts.append(n)
    assert set(counts) == {1, 2}

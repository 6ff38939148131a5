"""A hand that rests on the gel: its pose is the neutral one."""

import numpy as np
import pytest

from neurotouch_hid.geometry import LATTICE_MM
from neurotouch_hid.gesture.neutral import Neutral
from neurotouch_hid.messages import GestureKind
from tests.gesture.elastic import field
from tests.gesture.test_neurotouch import Player

PALM = np.array([[-10.0, 12.0]]), np.array([[2.5, -2.0]])
TIP = np.array([8.0, -6.0])


def hand(push_mm=0.0, palm=1.0):
    """A palm that leans on the gel, and a finger that may push to the right."""
    centres = np.vstack([PALM[0], TIP])
    return field(centres, np.vstack([PALM[1] * palm, [push_mm, 0.0]]))


def hold(player, displacement, slices=40):
    for _ in range(slices):
        gesture = player.see(displacement)
    return gesture


def test_a_resting_hand_is_no_gesture_and_its_push_is_measured_from_there():
    player = Player(neutral="resting")
    assert hold(player, hand()).kind is GestureKind.NONE
    gesture = hold(player, hand(5.0))
    assert gesture.kind is GestureKind.PUSH
    assert len(gesture.contacts_mm) == 1
    assert gesture.intensity_mm == pytest.approx(5.0, abs=0.4)
    np.testing.assert_allclose(gesture.contacts_mm[0] - TIP, (5.0, 0.0), atol=1.5)
    assert hold(player, hand()).kind is GestureKind.NONE


def test_lifted_is_the_default():
    assert hold(Player(), hand()).kind is GestureKind.PUSH


@pytest.mark.parametrize("neutral", ["lifted", "resting"])
def test_rezero_takes_the_pose_of_the_moment(neutral):
    player = Player(neutral=neutral)
    hold(player, hand(palm=0.0))
    assert hold(player, hand()).kind is GestureKind.PUSH
    player.recognizer.rezero()
    assert hold(player, hand()).kind is GestureKind.NONE
    assert hold(player, hand(5.0)).kind is GestureKind.PUSH


def test_a_lifted_hands_pose_ends_with_the_next_anchor():
    player = Player()
    hold(player, hand())
    player.recognizer.rezero()
    assert hold(player, hand()).kind is GestureKind.NONE
    player.rest_px = player.rest_px.copy()
    assert hold(player, hand()).kind is GestureKind.PUSH


def test_tremor_of_a_resting_hand_is_no_gesture():
    player = Player(neutral="resting")
    for i in range(600):
        displacement = hand(0.5 * np.sin(2 * np.pi * 5.0 * i / 100))
        assert player.see(displacement).kind is GestureKind.NONE


def captured(moved):
    neutral = Neutral(is_resting=True)
    for _ in range(30):
        neutral.subtract(moved, 10_000)
    return neutral


def follow(neutral, moved, seconds, *, is_quiet=True):
    for _ in range(round(100 * seconds)):
        neutral.follow(neutral.subtract(moved, 10_000), 2.5, 10_000, is_quiet=is_quiet)
    return np.abs(neutral.subtract(moved, 10_000)).max()


def test_slow_drift_is_followed_with_a_time_constant_of_half_a_minute():
    start, drift = np.zeros_like(LATTICE_MM), np.array([0.5, 0.0])
    drifted = start + drift
    assert follow(captured(start), drifted, 30) == pytest.approx(0.5 / np.e, abs=0.05)
    assert follow(captured(start), drifted, 30, is_quiet=False) == 0.5


def test_motion_is_not_drift():
    neutral, moved = captured(np.zeros_like(LATTICE_MM)), np.zeros_like(LATTICE_MM)
    for i in range(1000):
        moved[:] = (5.0 * np.sin(2 * np.pi * i / 200), 0.0)  # 2 mm at half a hertz
        neutral.follow(neutral.subtract(moved, 10_000), 2.5, 10_000, is_quiet=True)
    assert np.abs(neutral.pose_px).max() < 0.2


@pytest.mark.parametrize(
    ("kind", "drags"),
    [
        (GestureKind.PUSH, [[4.0, 0.0], [4.0, 0.0]]),
        (GestureKind.PINCH, [[3.0, 0.0], [-3.0, 0.0]]),
        (GestureKind.ZOOM, [[-3.0, 0.0], [3.0, 0.0]]),
        (GestureKind.TWIST_CW, [[0.0, -4.0], [0.0, 4.0]]),
        (GestureKind.TWIST_CCW, [[0.0, 4.0], [0.0, -4.0]]),
    ],
)
def test_gestures_beside_a_resting_trembling_hand_also_after_a_new_anchor(kind, drags):
    centres = np.vstack([PALM[0], [[-11.0, -9.0], [11.0, -9.0]]])
    player, rng = Player(neutral="resting"), np.random.default_rng(3)

    def play(size, slices):
        kinds = []
        for _ in range(slices):
            tremble = rng.normal(0.0, 0.1, (1, 2))
            drag = np.vstack([PALM[1] + tremble, size * np.array(drags)])
            kinds.append(player.see(field(centres, drag)).kind)
        return kinds

    assert set(play(0.0, 60)) == {GestureKind.NONE}
    for _ in range(2):
        assert set(play(1.0, 30)[5:]) == {kind}
        assert set(play(0.0, 30)[5:]) == {GestureKind.NONE}
        player.rest_px = player.rest_px.copy()  # seen as untouched: a resting hand's pose stays

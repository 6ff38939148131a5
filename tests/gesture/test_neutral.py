"""A hand that rests on the gel: its pose is the neutral one."""

import numpy as np
import pytest

from neurotouch_hid.geometry import PAPER_GEL
from neurotouch_hid.gesture.neutral import LIFT_US, SMOOTH_US, STILL_MM_S, Neutral
from neurotouch_hid.messages import GestureKind
from tests.gesture.elastic import field
from tests.gesture.test_neurotouch import Player

PALM = np.array([[-10.0, 12.0]]), np.array([[2.5, -2.0]])
TIP = np.array([8.0, -6.0])
EVERYTHING = np.ones(len(PAPER_GEL.points_mm), bool)
SETTLED = 400
"""Slices after which a hand on the gel counts as resting."""


def hand(push_mm=0.0, palm=1.0):
    """A palm that leans on the gel, and a finger that may push to the right."""
    centres = np.vstack([PALM[0], TIP])
    return field(centres, np.vstack([PALM[1] * palm, [push_mm, 0.0]]))


def hold(player, displacement, slices=40):
    for _ in range(slices):
        gesture = player.see(displacement)
    return gesture


def kinds(player, displacement, slices):
    return {player.see(displacement).kind for _ in range(slices)}


def test_a_hand_that_is_laid_down_soon_rests_and_its_push_is_measured_from_there():
    player = Player(neutral="resting")
    assert kinds(player, hand(palm=0.0), 100) == {GestureKind.NONE}
    hold(player, hand(), SETTLED)
    assert kinds(player, hand(), 100) == {GestureKind.NONE}
    gesture = hold(player, hand(5.0))
    assert gesture.kind is GestureKind.PUSH
    assert len(gesture.contacts_mm) == 1
    assert gesture.intensity_mm == pytest.approx(5.0, abs=0.4)
    np.testing.assert_allclose(gesture.contacts_mm[0] - TIP, (5.0, 0.0), atol=1.5)
    assert hold(player, hand()).kind is GestureKind.NONE


def test_the_further_a_hand_drags_the_longer_it_takes_to_rest():
    def settle_s(palm):
        player, slices = Player(neutral="resting"), 1
        while player.see(hand(palm=palm)).kind is not GestureKind.NONE or slices < 50:
            slices += 1
        return slices / 100

    assert [settle_s(palm) for palm in (0.4, 1.0, 2.0)] == pytest.approx([1.3, 3.1, 6.0], abs=0.5)


def test_a_light_hand_can_play_at_once():
    player = Player(neutral="resting")
    hold(player, hand(palm=0.05))
    gesture = hold(player, hand(5.0, palm=0.05))
    assert gesture.kind is GestureKind.PUSH
    assert gesture.intensity_mm == pytest.approx(5.0, abs=0.4)


def test_a_held_gesture_goes_on_and_does_not_become_rest():
    player = Player(neutral="resting")
    hold(player, hand(), SETTLED)
    hold(player, hand(5.0))
    assert kinds(player, hand(5.0), 500) == {GestureKind.PUSH}
    assert hold(player, hand()).kind is GestureKind.NONE


def test_lifting_is_no_gesture_and_the_hand_is_found_wherever_it_is_laid_next():
    player = Player(neutral="resting")
    hold(player, hand(), SETTLED)
    assert kinds(player, hand(palm=0.0), 60) == {GestureKind.NONE}
    hold(player, hand(palm=-1.0), SETTLED)
    assert kinds(player, hand(palm=-1.0), 100) == {GestureKind.NONE}
    assert hold(player, hand(5.0, palm=-1.0)).kind is GestureKind.PUSH


def test_a_moment_of_untouched_gel_is_no_lifted_hand():
    player = Player(neutral="resting")
    hold(player, hand(), SETTLED)
    hold(player, hand(palm=0.0), 10)
    assert hold(player, hand(palm=-1.0)).kind is not GestureKind.NONE


def test_a_hand_with_a_strong_tremor_is_found_to_rest():
    player = Player(neutral="resting")
    for i in range(SETTLED):
        player.see(hand(2.0 * np.sin(2 * np.pi * 5.0 * i / 100)))
    assert hold(player, hand()).kind is GestureKind.NONE
    assert hold(player, hand(5.0)).kind is GestureKind.PUSH


def test_lifted_is_the_default():
    assert hold(Player(), hand()).kind is not GestureKind.NONE


def test_another_pose_may_be_chosen_while_it_runs():
    player = Player()
    assert hold(player, hand(), SETTLED).kind is not GestureKind.NONE
    player.recognizer.choose_neutral("resting")
    assert hold(player, hand(), SETTLED).kind is GestureKind.NONE
    assert hold(player, hand(5.0)).kind is GestureKind.PUSH
    player.recognizer.choose_neutral("lifted")
    assert hold(player, hand()).kind is not GestureKind.NONE


@pytest.mark.parametrize("neutral", ["lifted", "resting"])
def test_rezero_captures_the_present_pose(neutral):
    player = Player(neutral=neutral)
    hold(player, hand(palm=0.5), SETTLED)
    assert hold(player, hand()).kind is not GestureKind.NONE
    player.recognizer.rezero()
    assert hold(player, hand()).kind is GestureKind.NONE
    assert hold(player, hand(5.0)).kind is GestureKind.PUSH


def test_a_lifted_hands_pose_ends_with_the_next_anchor():
    player = Player()
    hold(player, hand())
    player.recognizer.rezero()
    assert hold(player, hand()).kind is GestureKind.NONE
    player.rest_px = player.rest_px.copy()
    assert hold(player, hand()).kind is not GestureKind.NONE


def test_tremor_of_a_resting_hand_is_no_gesture():
    player = Player(neutral="resting")
    hold(player, hand(), SETTLED)
    for i in range(600):
        displacement = hand(0.5 * np.sin(2 * np.pi * 5.0 * i / 100))
        assert player.see(displacement).kind is GestureKind.NONE


def test_a_push_towards_a_finger_that_rests_is_no_pinch():
    centres, rests = np.array([[2.0, 11.0], [0.0, -8.0]]), np.array([0.4, 0.2])
    player, rng = Player(neutral="resting"), np.random.default_rng(4)

    def play(size):
        drags = np.array([rests + rng.normal(0.0, 0.1, 2), [0.0, size]])
        return player.see(field(centres, drags))

    for _ in range(SETTLED):
        play(0.0)
    seen = [play(min(0.4 * i, 5.0)) for i in range(50)][5:]
    assert {gesture.kind for gesture in seen} == {GestureKind.PUSH}
    assert {len(gesture.contacts_mm) for gesture in seen[10:]} == {1}
    assert seen[-1].intensity_mm == pytest.approx(5.0, abs=0.5)


def subtract(neutral, moved):
    return neutral.subtract(moved, EVERYTHING, 2.5, 10_000)


def settle(moved):
    neutral = Neutral(is_resting=True)
    while neutral.pose_px is None:
        subtract(neutral, moved)
    return neutral


def follow(neutral, moved, seconds, *, is_quiet=True):
    for _ in range(round(100 * seconds)):
        left = subtract(neutral, moved)
        if is_quiet:
            neutral.follow(left, 10_000)
    return np.abs(subtract(neutral, moved)).max()


def test_slow_drift_is_followed_with_a_time_constant_of_half_a_minute():
    start, drift = np.full_like(PAPER_GEL.points_mm, 2.0), np.array([0.5, 0.0])
    assert follow(settle(start), start + drift, 30) == pytest.approx(0.5 / np.e, abs=0.05)
    assert follow(settle(start), start + drift, 30, is_quiet=False) == 0.5


def test_motion_is_not_drift():
    start = np.full_like(PAPER_GEL.points_mm, 9.0)
    neutral = settle(start)
    for i in range(1000):
        motion = (5.0 * np.sin(2 * np.pi * i / 200), 0.0)  # 2 mm at half a hertz
        neutral.follow(subtract(neutral, start + motion), 10_000)
    assert np.abs(neutral.pose_px - start).max() < 0.2


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

    assert play(0.0, SETTLED)[-1] is GestureKind.NONE
    for _ in range(2):
        assert set(play(1.0, 30)[5:]) == {kind}
        assert set(play(0.0, 30)[5:]) == {GestureKind.NONE}
        player.rest_px = player.rest_px.copy()  # seen as untouched: a resting hand's pose stays


PX_PER_MM = 10.0
STEP_US = 10_000


def see(neutral, mm, step_us=STEP_US, n_touched=50, n=50):
    """What is left of markers that have moved so far to the right, in mm; None while it waits."""
    moved_px = np.zeros((n, 2))
    moved_px[:n_touched, 0] = mm * PX_PER_MM
    left_px = neutral.subtract(moved_px, np.ones(n, bool), PX_PER_MM, step_us)
    return None if left_px is None else left_px[0, 0] / PX_PER_MM


def rest_a_hand(neutral):
    """Lays a hand on the gel, and holds it until it counts as resting."""
    while neutral.pose_px is None:
        see(neutral, 0.5)


def test_a_pose_is_the_mean_of_its_time_to_the_last_microsecond():
    neutral = Neutral(is_resting=False)
    neutral.capture()
    assert see(neutral, 1.0, step_us=299_999) is None
    assert see(neutral, 2.0) == pytest.approx(0.5)
    assert see(neutral, 2.0) == pytest.approx(0.5)


def test_a_hand_rests_after_a_second_and_counts_as_lifted_at_once():
    neutral = Neutral(is_resting=True)
    see(neutral, 0.0)
    for _ in range(99):
        see(neutral, 0.5)
    assert neutral.pose_px is None
    see(neutral, 0.5)
    assert neutral.pose_px is not None
    assert see(neutral, 0.0, step_us=1) is None


def test_a_hand_that_is_lifted_loses_its_pose_after_its_time():
    neutral = Neutral(is_resting=True)
    rest_a_hand(neutral)
    for _ in range(LIFT_US // STEP_US - 1):
        see(neutral, 0.0)
    assert neutral.pose_px is not None
    see(neutral, 0.0)
    assert neutral.pose_px is None


def test_a_hand_that_moves_rests_a_second_after_its_last_motion():
    neutral, once, twice, still = Neutral(is_resting=True), 0.0, 0.0, 0
    see(neutral, 0.0)
    for k in range(300):
        mm = 3.0 if k < 10 else 0.5
        see(neutral, mm)
        share = 1.0 - np.exp(-STEP_US / SMOOTH_US)  # what it does, for one marker
        once += share * (mm - once)
        speed_mm_s = (once - twice) / (1e-6 * SMOOTH_US)
        twice += share * (once - twice)
        still = still + 1 if abs(speed_mm_s) <= STILL_MM_S else 0
        assert (neutral.pose_px is not None) is (still >= 100), k
        if still >= 100:
            break
    assert 100 < k < 299


def test_the_pose_does_not_follow_a_hand_that_moves():
    neutral = Neutral(is_resting=True)
    rest_a_hand(neutral)
    before_px = neutral.pose_px.copy()
    for _ in range(20):
        see(neutral, 8.0)
    neutral.follow(np.full((50, 2), 9.0), STEP_US)
    np.testing.assert_array_equal(neutral.pose_px, before_px)


@pytest.mark.parametrize(("n_touched", "is_lifted"), [(0, True), (1, True), (2, False)])
def test_a_gel_of_which_few_markers_move_is_untouched(n_touched, is_lifted):
    neutral = Neutral(is_resting=True)
    rest_a_hand(neutral)
    assert (see(neutral, 0.5, n_touched=n_touched) is None) is is_lifted


def test_a_point_of_the_gel_moves_with_its_four_nearest_markers():
    neutral = Neutral(is_resting=True)
    rest_px = np.array([[x, y] for x in (10.0, 50.0, 60.0) for y in (10.0, 50.0, 60.0)])
    near = (rest_px > 30.0).all(axis=1)
    neutral.pose_px = np.where(near[:, None], (4.0, -2.0), 100.0)
    points_px = np.array([[54.0, 56.0], [56.0, 52.0]])
    moved_px = neutral.displace(points_px, rest_px)
    np.testing.assert_allclose(moved_px, points_px + np.array([4.0, -2.0]))
    assert neutral.displace(points_px[:0], rest_px).shape == (0, 2)

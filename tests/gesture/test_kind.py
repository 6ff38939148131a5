"""When a gesture begins and ends."""

import numpy as np
import pytest

from neurotouch_hid.messages import GestureKind
from tests.gesture.stages import NEVER_US, Decider


def push(
    decision,
    size_mm,
    *,
    sway_mm=0.0,
    error_mm=0.0,
    is_lost=False,
    noise_mm=0.05,
    rest_age_us=NEVER_US,
):
    """One slice of 10 ms in which one finger drags by ``size_mm``."""
    parts_mm = [0.0, size_mm, 0.0, 0.0, 0.0, 0.0]
    motion = 1, size_mm, size_mm, sway_mm, error_mm, is_lost, 0.0, 0.0, 0.0, 1.0, parts_mm
    decision.tell(*motion, noise_mm=noise_mm, rest_age_us=rest_age_us)


@pytest.mark.parametrize(
    ("noise_mm", "size_mm", "kind"),
    [
        (0.05, 0.33, GestureKind.PUSH),
        (0.1, 0.35, GestureKind.NONE),
        (0.1, 0.45, GestureKind.PUSH),
    ],
)
def test_a_finger_that_noise_may_have_drawn_begins_no_gesture(noise_mm, size_mm, kind):
    decision = Decider()
    for _ in range(10):
        push(decision, size_mm, noise_mm=noise_mm)
    assert decision.kind is kind


def test_no_gesture_begins_while_the_gel_sways():
    quiet, swaying, steady = Decider(), Decider(), Decider()
    for _ in range(3):
        push(quiet, 0.6)
        push(swaying, 0.6, sway_mm=0.4)
        push(steady, 0.6)
    assert quiet.kind is GestureKind.PUSH
    assert swaying.kind is GestureKind.NONE
    push(steady, 0.6, sway_mm=0.4)
    assert steady.kind is GestureKind.PUSH  # a gesture in progress goes on
    for _ in range(30):
        push(swaying, 0.6)
    assert swaying.kind is GestureKind.PUSH  # the sway is forgotten


def test_motion_that_fingers_do_not_explain_is_a_knock_while_the_gel_moves():
    def begin(size_mm, sway_mm, error_mm):
        decision = Decider()
        for _ in range(3):
            push(decision, size_mm, sway_mm=sway_mm, error_mm=error_mm)
        return decision.kind

    assert begin(0.9, 0.2, 0.2) is GestureKind.NONE
    assert begin(0.9, 0.2, 0.1) is GestureKind.PUSH
    assert begin(0.9, 0.0, 0.2) is GestureKind.PUSH  # gel of another kind: nothing knocked
    assert begin(2.5, 0.2, 0.4) is GestureKind.PUSH


def press_and_release(decision, left_mm, most_mm=5.0):
    """Pushes by 5 mm for 0.2 s, then leaves some of it within 50 ms."""
    for _ in range(20):
        push(decision, most_mm)
    for size_mm in np.linspace(most_mm, left_mm, 6)[1:]:
        push(decision, size_mm)


@pytest.mark.parametrize(
    ("left_mm", "error_mm", "n_lost", "kind"),
    [
        (0.6, 0.1, 1, GestureKind.PUSH),
        (0.6, 0.1, 2, GestureKind.NONE),
        (0.6, 0.06, 5, GestureKind.PUSH),  # hardly more than noise
        (2.2, 0.1, 5, GestureKind.PUSH),
    ],
)
def test_tracks_that_stay_behind_are_no_gesture(left_mm, error_mm, n_lost, kind):
    decision = Decider()
    press_and_release(decision, left_mm)
    for _ in range(n_lost):
        push(decision, left_mm, error_mm=error_mm, is_lost=True)
    assert decision.kind is kind


def test_a_gesture_that_goes_on_does_not_end_because_its_fingers_are_lost():
    decision = Decider()
    for size_mm in (0.5, 0.7, 0.9, 1.0, 1.0, 1.0):
        push(decision, size_mm, error_mm=0.2, is_lost=True)
    assert decision.kind is GestureKind.PUSH


@pytest.mark.parametrize(
    ("left_mm", "rest_age_us", "error_mm", "kind"),
    [
        (0.45, NEVER_US, 0.04, GestureKind.PUSH),
        (0.45, 20_000, 0.04, GestureKind.NONE),
        (0.45, 20_000, 0.01, GestureKind.PUSH),  # the markers tell better how much is left
        (0.6, 20_000, 0.01, GestureKind.NONE),  # this gel keeps a part of each gesture
        (0.45, 300_000, 0.04, GestureKind.PUSH),  # it shows the gel before the push
        (3.0, 20_000, 0.04, GestureKind.PUSH),  # the fingers are back
    ],
)
def test_fingers_that_leave_a_gel_seen_at_rest_end_the_gesture(
    left_mm, rest_age_us, error_mm, kind
):
    decision = Decider()
    press_and_release(decision, left_mm)
    push(decision, left_mm, rest_age_us=rest_age_us, error_mm=error_mm)
    assert decision.kind is kind


def test_what_no_longer_shrinks_ends_once_the_gel_is_seen_at_rest():
    decision = Decider()
    press_and_release(decision, 0.45)
    kinds = []
    for _ in range(10):
        push(decision, 0.45, rest_age_us=20_000, error_mm=0.01)
        kinds.append(decision.kind)
    assert kinds[:3] == [GestureKind.PUSH] * 3
    assert kinds[-1] is GestureKind.NONE


def test_a_soft_touch_that_begins_is_not_ended_by_a_frame_at_rest():
    decision = Decider()
    for size_mm in (0.3, 0.32, 0.34):
        push(decision, size_mm)
    push(decision, 0.36, rest_age_us=5_000)
    assert decision.kind is GestureKind.PUSH


def test_a_gesture_ends_the_later_the_smaller_it_was():
    def least(most_mm):
        decision, size_mm = Decider(), most_mm
        while decision.kind is not GestureKind.NONE or size_mm == most_mm:
            push(decision, size_mm)
            size_mm -= 0.01
        return size_mm

    assert least(0.4) < 0.2  # it trembles, or has just begun
    assert 0.29 < least(6.0) < 0.32  # the gel creeps back from it


@pytest.mark.parametrize(("left_mm", "is_believed"), [(4.5, True), (0.4, False)])
def test_people_see_less_of_a_gesture_that_ends_than_of_one_that_goes_on(left_mm, is_believed):
    decision = Decider()
    for size_mm in (2.0, 4.0, 6.0, 6.0, *np.linspace(6.0, left_mm, 10)):
        push(decision, size_mm)
    assert decision.is_falling
    for _ in range(12):
        push(decision, left_mm)
    assert not decision.is_falling
    assert decision.kind is GestureKind.PUSH
    assert (decision.confidence > 0.7) == is_believed


def test_a_type_that_hardly_leads_is_not_final_yet():
    """Two fingers push unequally: at 2 mm that looks as much like a twist."""

    def drag(push_mm, twist_mm):
        parts_mm = [0.0, push_mm, 0.0, 0.0, twist_mm, 0.0]
        return decision.tell(2, 2.5, 2.5, 0.0, 0.0, False, 0.0, 0.0, 0.1, 1.0, parts_mm)

    decision = Decider()
    assert {drag(0.9, 0.95) for _ in range(10)} == {GestureKind.TWIST_CW}
    assert decision.is_forming
    assert [drag(3.0, 1.4) for _ in range(20)][-1] is GestureKind.PUSH
    assert not decision.is_forming


@pytest.mark.parametrize(
    ("largest_mm", "pause_us", "begins"),
    [(8.0, 20_000, False), (8.0, 200_000, True), (1.0, 20_000, True)],
)
def test_the_swing_of_a_released_gel_is_no_gesture(largest_mm, pause_us, begins):
    decision = Decider()
    swing = [*[largest_mm] * 10, *[0.0] * (pause_us // 10_000), 0.6, 0.6]
    for size_mm in swing:
        push(decision, size_mm)
    assert (decision.kind is GestureKind.PUSH) == begins


def test_a_tap_keeps_its_type_while_the_fingers_leave():
    def twist(size_mm):
        parts_mm = [0.0, 0.0, 0.0, 0.0, 8.0, 0.0]
        return decision.tell(1, size_mm, size_mm, 0.0, 0.0, False, 0.0, 0.0, 0.1, 1.0, parts_mm)

    decision = Decider()
    for size_mm in (2.0, 5.0, 4.5):
        push(decision, size_mm)
    left = [twist(size_mm) for size_mm in (3.0, 1.5, 0.8, 0.5, 0.35)]  # what swings back
    assert set(left) == {GestureKind.PUSH}
    assert decision.is_forming  # the tap was too short
    assert [twist(size_mm) for size_mm in (1.0, 2.0, 3.0, 3.0)][-1] is GestureKind.TWIST_CW


@pytest.mark.parametrize(
    ("left_mm", "tremble_mm", "kind"),
    [(0.75, 0.0, GestureKind.NONE), (0.75, 0.15, GestureKind.PUSH), (2.0, 0.0, GestureKind.PUSH)],
)
def test_what_the_gel_keeps_of_a_large_gesture_is_none(left_mm, tremble_mm, kind):
    decision = Decider()
    sizes_mm = [*np.linspace(1.0, 15.0, 15), *np.linspace(15.0, left_mm, 15)]
    for size_mm in (*sizes_mm, *(left_mm + tremble_mm * np.sin(0.6 * np.arange(30)))):
        push(decision, size_mm)
    assert decision.kind is kind
    if kind is GestureKind.NONE:
        for size_mm in np.linspace(left_mm, left_mm + 1.0, 8):
            push(decision, size_mm)
        assert decision.kind is GestureKind.PUSH  # the next one counts from there


def test_a_gel_is_learnt_that_keeps_a_part_of_each_large_gesture():
    decision = Decider()

    def end(left_mm):
        """Returns after how many slices a gesture of 8 mm ends, of which a part is left."""
        press_and_release(decision, left_mm, 8.0)
        n = 0
        while decision.kind is not GestureKind.NONE:
            push(decision, left_mm)
            n += 1
        for _ in range(40):
            push(decision, left_mm)
        return n

    assert end(0.5) >= 14  # only a finger that does not tremble tells that it is over
    assert end(0.5) <= 2
    assert end(0.5) <= 2
    assert [end(0.0) for _ in range(6)] == [0] * 6
    assert end(0.5) >= 14  # the gel came back six times

"""When a gesture begins and ends."""

import numpy as np
import pytest

from neurotouch_hid.gesture.elastic.decision import KindDecider
from neurotouch_hid.messages import GestureKind
from neurotouch_hid.vocabulary import Phase


def test_no_gesture_begins_while_everything_sways():
    quiet, swaying, held = KindDecider(), KindDecider(), KindDecider()
    push = [0.0, 0.6, 0.0, 0.0, 0.0, 0.0]
    for _ in range(3):
        quiet.update(10_000, 0.6, push, 1, 0.05)
        swaying.update(10_000, 0.6, push, 1, 0.05, 0.4)
        held.update(10_000, 0.6, push, 1, 0.05)
    assert quiet.kind is GestureKind.PUSH
    assert swaying.kind is GestureKind.NONE
    held.update(10_000, 0.6, push, 1, 0.05, 0.4)
    assert held.kind is GestureKind.PUSH  # what has begun goes on
    for _ in range(30):
        swaying.update(10_000, 0.6, push, 1, 0.05)
    assert swaying.kind is GestureKind.PUSH  # it is forgotten


def test_what_fingers_do_not_explain_is_a_knock_while_everything_moves():
    push = [0.0, 0.9, 0.0, 0.0, 0.0, 0.0]

    def begin(size_mm, sway_mm, error_mm):
        decision = KindDecider()
        for _ in range(3):
            decision.update(10_000, size_mm, push, 1, 0.05, sway_mm, error_mm)
        return decision.kind

    assert begin(0.9, 0.2, 0.2) is GestureKind.NONE
    assert begin(0.9, 0.2, 0.1) is GestureKind.PUSH
    assert begin(0.9, 0.0, 0.2) is GestureKind.PUSH  # gel of another kind: nothing knocked
    assert begin(2.5, 0.2, 0.4) is GestureKind.PUSH


def test_a_gesture_ends_the_later_the_smaller_it_was():
    def least(most_mm):
        decision, push = KindDecider(), [0.0, most_mm, 0.0, 0.0, 0.0, 0.0]
        size_mm = most_mm
        while decision.kind is not GestureKind.NONE or size_mm == most_mm:
            decision.update(10_000, size_mm, push, 1, 0.05)
            size_mm -= 0.01
        return size_mm

    assert least(0.4) < 0.2  # it trembles, or has just begun
    assert 0.25 < least(6.0) < 0.28  # the gel creeps back from it


@pytest.mark.parametrize(("left_mm", "phase"), [(4.5, Phase.HOLD), (2.0, Phase.RELEASE)])
def test_who_has_let_go_a_little_and_keeps_still_holds_again(left_mm, phase):
    def play(size_mm):
        decision.update(10_000, size_mm, [0.0, size_mm, 0.0, 0.0, 0.0, 0.0], 1, 0.05)

    decision = KindDecider()
    for size_mm in (2.0, 4.0, 6.0, 6.0, *np.linspace(6.0, left_mm, 10)):
        play(size_mm)
    assert decision.is_falling
    assert decision.phase is Phase.RELEASE
    for _ in range(12):
        play(left_mm)
    assert not decision.is_falling
    assert decision.phase is phase


@pytest.mark.parametrize(
    ("largest_mm", "pause_us", "begins"),
    [(8.0, 20_000, False), (8.0, 200_000, True), (1.0, 20_000, True)],
)
def test_the_swing_of_a_gel_that_was_let_go_is_no_gesture(largest_mm, pause_us, begins):
    decision = KindDecider()
    swing = [*[largest_mm] * 10, *[0.0] * (pause_us // 10_000), 0.6, 0.6]
    for size_mm in swing:
        decision.update(10_000, size_mm, [0.0, size_mm, 0.0, 0.0, 0.0, 0.0], 1, 0.05)
    assert (decision.kind is GestureKind.PUSH) == begins

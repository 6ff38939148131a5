"""The tapping test: targets, the un-timed start, selection; a simulated subject takes all of it."""

import math
from itertools import pairwise

import pytest

from neurotouch_hid.evaluation.people.pointing import (
    DWELL_US,
    SPEED_PX_S,
    Pointing,
    lay_targets,
    name_way,
)
from neurotouch_hid.evaluation.people.subject import perform_pointing
from neurotouch_hid.evaluation.people.throughput import Trial, measure_pointing
from neurotouch_hid.messages import Axis, Button, GamepadState
from neurotouch_hid.profile import Mapping, UserSettings, load_profile


class Hand:
    """Moves the outputs of a pad for so long."""

    def __init__(self, test: Pointing) -> None:
        self.test = test
        self.t_us = 0

    def hold(self, ms: int, x: float = 0.0, y: float = 0.0, *buttons: Button) -> list[Trial]:
        trials = []
        for _ in range(ms // 10):
            self.t_us += 10_000
            axes = {Axis.LEFT_X: x, Axis.LEFT_Y: y}
            trials.append(self.test.update(GamepadState(self.t_us, frozenset(buttons), axes)))
        return [trial for trial in trials if trial is not None]

    def go(self, ms: int) -> list[Trial]:
        """Towards the target."""
        (x0, y0), (_, (x1, y1)) = self.test.start_px, self.test.target
        way = math.dist((x0, y0), (x1, y1))
        return self.hold(ms, (x1 - x0) / way, (y1 - y0) / way)


@pytest.mark.parametrize("n", [3, 9, 25])
def test_targets_are_reached_across_the_circle_each_once(n: int) -> None:
    middles = lay_targets(n, 400.0)
    assert middles[0] == middles[-1]
    assert len({(round(x, 6), round(y, 6)) for x, y in middles}) == n
    lengths = [math.dist(*pair) for pair in pairwise(middles)]
    assert lengths == pytest.approx([400.0 * math.cos(math.pi / (2 * n))] * n)


def test_ways_have_names() -> None:
    assert name_way((0, 0), (0, -5)) == "up"
    assert name_way((0, 0), (-5, 5)) == "down left"


def test_a_trial_is_begun_when_one_likes_and_timed_from_the_first_motion() -> None:
    test = Pointing()
    hand = Hand(test)
    hand.hold(500, 1.0)
    assert test.pointer_px == test.start_px, "nothing moves between trials"
    test.begin()
    hand.hold(300, 1.0)
    assert test.pointer_px == test.start_px, "nor while a push from before is held"
    hand.hold(60_000)
    travel_ms = 440
    assert hand.go(travel_ms) == []
    (trial,) = hand.hold(2_000)
    assert trial.movement_s == pytest.approx(travel_ms / 1000, abs=0.05), (
        "waiting and dwell do not count"
    )
    assert trial.is_hit
    assert trial.distance_px + trial.overshoot_px == pytest.approx(SPEED_PX_S * travel_ms / 1000)
    assert not test.is_running


def test_resting_selects_also_beside_the_target_but_not_at_the_start() -> None:
    test = Pointing()
    hand = Hand(test)
    test.begin()
    hand.hold(50)
    hand.go(20)
    assert hand.hold(5_000) == [], "it has hardly begun"
    hand.go(200)
    assert hand.hold(DWELL_US // 1000 - 100) == []
    (trial,) = hand.hold(300)
    assert not trial.is_hit
    assert trial.overshoot_px < -100


def test_a_slow_approach_is_no_rest() -> None:
    test = Pointing()
    hand = Hand(test)
    test.begin()
    hand.hold(50)
    hand.go(200)
    (x0, y0), (_, (x1, y1)) = test.start_px, test.target
    way = math.dist((x0, y0), (x1, y1))
    assert hand.hold(3_000, 0.03 * (x1 - x0) / way, 0.03 * (y1 - y0) / way) == []


def test_a_button_selects_where_asked_for() -> None:
    test = Pointing(dwell=False)
    hand = Hand(test)
    test.begin()
    hand.hold(50)
    hand.go(440)
    assert hand.hold(5_000) == []
    (trial,) = hand.hold(100, 0.0, 0.0, Button.A)
    assert trial.is_hit
    assert trial.movement_s == pytest.approx(5.45, abs=0.05)


@pytest.mark.parametrize("profile", ["default", "mouse"])
def test_a_simulated_subject_takes_the_whole_test_through_a_shipped_profile(profile: str) -> None:
    results = []
    for seed in (0, 0, 1):
        test = Pointing()
        perform_pointing(test, Mapping(load_profile(profile)), seed)
        assert test.is_over
        results.append(measure_pointing(test.trials))
    assert results[0] == results[1] != results[2]
    assert results[0]["trials"] == 18
    assert results[0]["error_rate"] < 0.2
    wide, narrow = results[0]["blocks"]
    assert wide["movement_s"] < narrow["movement_s"], "small targets take longer"
    assert wide["effective_distance_px"] == pytest.approx(394.0, abs=30.0)


def test_a_worse_setting_measures_worse() -> None:
    figures = []
    for values in ({}, {"range": {name: {"full": 18.0} for name in ("push_left", "push_right")}}):
        test = Pointing()
        perform_pointing(
            test, Mapping(load_profile("default"), UserSettings.model_validate(values))
        )
        figures.append(measure_pointing(test.trials)["movement_s"])
    assert figures[0] < figures[1]

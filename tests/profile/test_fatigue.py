"""A hand that tires: a suggestion, or less is asked of it, minute by minute, until a pause."""

import pytest

from neurotouch_hid.messages import Axis, GamepadState
from neurotouch_hid.profile import Mapping, UserSettings, rehearse
from tests.profile.stage import make_profile, run, shift

PROFILE = make_profile(
    "when: push, do: {stick: left, deadzone: 0}",
    "when: {gesture: push, on_mm: 2.5}, do: {button: a}",
)
TIRED = "push left 6mm 100ms hold 100ms; rest 700ms;" * 60  # one minute, 6 of 8 mm
SMALL = TIRED.replace("6mm", "3mm")


def start(fatigue: str, **more: object) -> Mapping:
    values = {"filter": "none", "range": {"push_left": {"full": 8.0}}, "fatigue": fatigue}
    return Mapping(PROFILE, UserSettings.model_validate(values | more))


def play(mapping: Mapping, minutes: int, start_us: int = 0, script: str = TIRED) -> int:
    for _ in range(minutes):
        for gesture in rehearse(script, slice_us=50_000):
            t_us = mapping.update(shift(gesture, start_us)).t_us
        start_us = t_us + 50_000
    return start_us


def pull(mapping: Mapping, t_us: int, script: str = "push left 6mm") -> list[GamepadState]:
    return run(mapping, script, t_us)


def reach(states: list[GamepadState]) -> float:
    return max(-state.axes.get(Axis.LEFT_X, 0.0) for state in states)


def test_auto_asks_one_percent_less_each_minute() -> None:
    mapping = start("auto")
    t_us, shares = 0, []
    for _ in range(6):
        t_us = play(mapping, 1, t_us)
        shares.append(mapping.shares().get("push_left", 1.0))
    steps = [before - after for before, after in zip([1.0, *shares], shares, strict=False)]
    assert shares[-1] == pytest.approx(0.95, abs=0.011)
    assert max(steps) == pytest.approx(0.01)
    fresh, tired = reach(pull(start("auto"), 0)), reach(pull(mapping, t_us))
    assert fresh < tired < 1.0


def test_it_ends_where_the_hand_is_and_never_below_sixty_percent() -> None:
    mapping = start("auto")
    t_us = play(mapping, 30)
    assert mapping.shares()["push_left"] == pytest.approx(0.75)
    assert reach(pull(mapping, t_us)) == pytest.approx(1.0)
    mapping = start("auto")
    play(mapping, 45, script=SMALL)
    assert mapping.shares()["push_left"] == pytest.approx(0.6)


@pytest.mark.parametrize("how", ["pause", "idle"])
def test_a_pause_undoes_it(how: str) -> None:
    mapping = start("auto")
    t_us = play(mapping, 4)
    assert mapping.shares()
    if how == "pause":
        mapping.pause()
        mapping.resume()
    else:
        t_us = run(mapping, "rest 301s", t_us)[-1].t_us + 10_000
    assert not mapping.shares()
    assert reach(pull(mapping, t_us)) == reach(pull(start("auto"), 0))
    assert mapping.usages()[0].full_mm is None, "the hand has rested"


def test_suggest_and_none_change_nothing() -> None:
    for fatigue, full_mm in (("suggest", 6.0), ("none", None)):
        mapping = start(fatigue)
        t_us = play(mapping, 3)
        assert not mapping.shares()
        assert mapping.usages()[0].full_mm == full_mm
        assert reach(pull(mapping, t_us)) == reach(pull(start("none"), 0))


def test_what_is_suggested_or_done_is_told_once() -> None:
    profile = make_profile("when: push, do: {stick: left}")
    for fatigue, told in (
        ("none", []),
        ("suggest", ["push left could be full at 6 mm (its median is 6 mm now)"]),
    ):
        user = UserSettings.model_validate(
            {"filter": "none", "range": {"push_left": {"full": 8.0}}, "fatigue": fatigue}
        )
        mapping = Mapping(profile, user)
        play(mapping, 4)
        assert [str(each) for each in mapping.decisions()] == [f"fatigue: {one}" for one in told]


def test_no_threshold_moves_below_two_and_a_half_times_the_noise() -> None:
    mapping = start("auto")
    t_us = play(mapping, 45, script=SMALL)
    below = pull(mapping, t_us, "push left 2.45mm 300ms")
    assert reach(below) == reach(pull(start("none"), 0, "push left 2.45mm 300ms"))
    assert not any(state.buttons for state in below)


def test_other_movements_stay_and_a_diagonal_is_between() -> None:
    mapping = start("auto")
    t_us = play(mapping, 30)
    for way, least, most in (("right", 0.0, 0.0), ("up_left", 0.001, 0.3)):
        script = f"push {way} 6mm"
        gains = []
        for one, at_us in ((mapping, t_us), (start("none"), 0)):
            states = pull(one, at_us, script)
            gains.append(max(abs(state.axes.get(Axis.LEFT_X, 0.0)) for state in states))
        assert least <= gains[0] - gains[1] <= most
        t_us += 1_000_000


def test_nothing_changes_while_a_movement_is_held() -> None:
    mapping = start("auto")
    t_us = play(mapping, 3)
    held = pull(mapping, t_us, "push left 6mm 100ms hold 150s")[20:-50]
    assert {reach([state]) for state in held} == {reach(held)}

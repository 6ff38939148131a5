"""What effects of games add up to over time; the serving is tested in a real kernel."""

import math

import pytest
from evdev import ecodes, ff

from neurotouch_hid.device.outputs.effects import STILL, Effects, Rumble, RumbleEffect
from neurotouch_hid.device.outputs.rumble_router import RumbleRouter

HALF = RumbleEffect(0.5, 0.25, seconds=1.0, delay_s=0.0)


def describe(kind: int, length_ms: int, delay_ms: int = 0, **body: object) -> ff.Effect:
    replay, effect = ff.Replay(length_ms, delay_ms), ff.EffectType(**body)
    return ff.Effect(kind, -1, 0, ff.Trigger(0, 0), replay, effect)


def play(effects: Effects, number: int = 0, n_times: int = 1, now: float = 0.0) -> None:
    effects.upload(number, HALF)
    effects.play(number, n_times, now)


def test_a_rumble_effect():
    effect = describe(ecodes.FF_RUMBLE, 500, 20, ff_rumble_effect=ff.Rumble(0xFFFF, 0x8000))
    assert RumbleEffect.read(effect) == RumbleEffect(1.0, pytest.approx(0.5, abs=1e-4), 0.5, 0.02)


@pytest.mark.parametrize("magnitude", [0x7FFF, -0x7FFF])
def test_a_periodic_effect_shakes_both_motors(magnitude):
    periodic = ff.Periodic(ecodes.FF_SINE, 10, magnitude)
    effect = RumbleEffect.read(describe(ecodes.FF_PERIODIC, 0, ff_periodic_effect=periodic))
    assert effect == RumbleEffect(1.0, 1.0, math.inf, 0.0)


def test_what_we_do_not_know_is_still():
    assert RumbleEffect.read(describe(ecodes.FF_SPRING, 100)).strong == 0.0


def test_an_effect_plays_and_ends_by_itself():
    effects = Effects()
    assert effects.sum_up(0.0) == (STILL, math.inf)
    play(effects)
    assert effects.sum_up(0.0) == (Rumble(0.5, 0.25, 1.0), 1.0)
    assert effects.sum_up(0.75) == (Rumble(0.5, 0.25, 0.25), 1.0)
    assert effects.sum_up(1.0) == (STILL, math.inf)


def test_an_effect_stops_when_told_to_or_erased():
    for stop in (lambda effects: effects.play(0, 0, 0.5), lambda effects: effects.erase(0)):
        effects = Effects()
        play(effects)
        stop(effects)
        assert effects.sum_up(0.5) == (STILL, math.inf)


def test_repeats_last_longer():
    effects = Effects()
    play(effects, n_times=3)
    assert effects.sum_up(2.5) == (Rumble(0.5, 0.25, 0.5), 3.0)


def test_effects_add_up_but_not_beyond_the_motor():
    effects = Effects()
    for number in range(3):
        play(effects, number)
    assert effects.sum_up(0.0)[0] == Rumble(1.0, 0.75, 1.0)


def test_the_gain_weakens_everything():
    effects = Effects()
    play(effects)
    effects.set_gain(0.5)
    assert effects.sum_up(0.0)[0] == Rumble(0.25, 0.125, 1.0)


def test_a_delayed_effect_begins_later():
    effects = Effects()
    effects.upload(0, RumbleEffect(0.5, 0.5, 1.0, delay_s=0.2))
    effects.play(0, 1, 0.0)
    assert effects.sum_up(0.0) == (STILL, 0.2)
    assert effects.sum_up(0.2) == (Rumble(0.5, 0.5, 1.0), 1.2)


def test_an_effect_without_end_is_told_again():
    effects = Effects()
    effects.upload(0, RumbleEffect(1.0, 1.0, math.inf, 0.0))
    effects.play(0, 1, 0.0)
    assert effects.sum_up(0.0) == (Rumble(1.0, 1.0, 30.0), 30.0)
    assert effects.sum_up(30.0) == (Rumble(1.0, 1.0, 30.0), 60.0)


def test_to_play_what_nobody_uploaded_is_nothing():
    effects = Effects()
    effects.play(7, 1, 0.0)
    assert effects.sum_up(0.0) == (STILL, math.inf)


def test_the_board_tells_everybody():
    heard: list[Rumble] = []
    board = RumbleRouter(heard.append, heard.append)
    board.hear(Rumble(0.5, 0.25, 1.0))
    assert heard == [Rumble(0.5, 0.25, 1.0)] * 2


def test_who_looks_now_and_then_misses_no_short_knock():
    now = 0.0
    board = RumbleRouter(now=lambda: now)
    assert board.describe() == {"strong": 0.0, "weak": 0.0}
    board.hear(Rumble(0.5, 0.25, 30.0))
    now = 10.0
    assert board.describe() == {"strong": 0.5, "weak": 0.25}
    board.hear(Rumble(1.0, 0.0, 0.05))
    now = 10.05
    board.hear(STILL)
    now = 10.5
    assert board.describe() == {"strong": 1.0, "weak": 0.25}
    now = 10.8
    assert board.describe() == {"strong": 0.0, "weak": 0.0}

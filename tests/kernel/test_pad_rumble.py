"""A pad that claims to rumble: games are answered at once, and we hear of it."""

import pytest

FF_RUMBLE, FF_PERIODIC, FF_SQUARE, FF_TRIANGLE, FF_SINE, FF_GAIN = (
    0x50,
    0x51,
    0x58,
    0x59,
    0x5A,
    0x60,
)


@pytest.fixture(scope="module")
def seen(guest):
    return guest("rumble")


def test_it_claims_what_a_real_one_does(seen):
    effects = [FF_RUMBLE, FF_PERIODIC, FF_SQUARE, FF_TRIANGLE, FF_SINE, FF_GAIN]
    assert sorted(seen["effects"]) == effects
    assert seen["n_effects"] == 16


@pytest.mark.parametrize("library", ["sdl2", "sdl3"])
def test_a_game_shakes_it_and_does_not_hang(seen, library):
    assert seen[library]["works"]
    assert seen[library]["took_s"] < 5.0  # unserved: 62


def test_we_hear_of_each_game_and_of_the_end(seen):
    heard = seen["heard_of_games"]
    assert [each[:2] for each in heard] == [[1.0, 1.0], [0.0, 0.0]] * 2
    # SDL uploads the longest effect there is and stops it itself; so long one is told anew.
    assert heard[0][2] == pytest.approx(30.0, abs=0.1)


@pytest.mark.parametrize("when", ["uploads_s", "uploads_while_busy_s"])
def test_uploads_are_answered_at_once_and_shake_nothing(seen, when):
    assert len(seen[when]) == 100
    assert max(seen[when]) < 5.0  # unserved: 30
    assert seen["heard_of_evdev"] == 0


def test_what_plays_is_heard_with_its_gain_and_ends_with_the_pad(seen):
    assert seen["playing"] == pytest.approx([0.5, 0.25], abs=0.001)
    assert seen["with_half_the_gain"] == pytest.approx([0.25, 0.125], abs=0.001)
    assert seen["at_the_end"] == [0.0, 0.0]

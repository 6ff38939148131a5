"""Somebody else's devices on our pad, in a real kernel: grabbed, merged, unplugged, back again."""

import pytest

A, B, NORTH, START = 0x130, 0x131, 0x133, 0x13B
X, Z, HAT_X, HAT_Y = 0, 2, 16, 17
SYN = [0, 0, 0]


@pytest.fixture(scope="module")
def seen(guest):
    return guest("copilot")


def test_without_a_game_pad_nobody_plays_along(seen):
    assert seen["none"]["message"] == "No gamepad is plugged in."


def test_our_own_pad_is_never_taken(seen):
    assert "There is no input device 'X-Box 360'" in seen["ours"]["message"]
    assert "our own pads do not count" in seen["ours"]["message"]


def test_what_another_program_has_taken_is_named(seen):
    assert "Another program has taken Helper pad" in seen["taken"]["message"]
    assert "InputPlumber" in seen["taken"]["hint"]


def test_without_right(seen):
    assert "You have no right to read /dev/input/event" in seen["without_right"]["message"]
    assert "usermod -aG input" in seen["without_right"]["hint"]


def test_the_helper_moves_our_pad(seen):
    moves = sorted(seen["helper"])
    assert moves == [[1, A, 1], [3, X, -32767], [3, Z, 255], [3, HAT_Y, -1]]


def test_nobody_else_hears_the_helper(seen):
    assert seen["heard_beside"] is False


def test_both_together(seen):
    assert seen["both"] == [[1, B, 1]]  # the helper moves the stick further
    moves = sorted(seen["helper_lets_go_of_the_stick"])
    assert moves == [[3, X, 16384], [3, Z, 0], [3, HAT_Y, 0]]  # now the gel has it


def test_a_fault_of_the_gels_leaves_the_helper_alone(seen):
    assert sorted(seen["gel_stalls"]) == [[1, B, 0], [3, X, 0]]
    assert sorted(seen["gel_again"]) == [[1, B, 1], [3, X, 16384]]


def test_unplugging_releases_the_helpers_share_and_nothing_else(seen):
    assert seen["unplugged"] == [[1, A, 0]]
    assert seen["pad_left"] is True


def test_it_goes_on_when_it_comes_back(seen):
    assert [1, A, 1] in seen["back"]


def test_closing_releases_everything_and_gives_the_device_back(seen):
    assert sorted(seen["closed"]) == [[1, A, 0], [1, B, 0], [3, X, 0]]
    assert seen["given_back"]["message"] == "done"


@pytest.mark.parametrize("when", ["rumble", "rumble_again"])
def test_games_shake_the_real_pad_through_ours(seen, when):
    assert seen["claims_rumble"] is True
    assert seen[when] == [[0x8000, 0x4000], [0, 0]]


def test_a_keyboard_plays_along(guest):
    seen = guest("copilot_keyboard")
    pressed = [[event[1], event[2]] for event in seen["keys"]]
    assert pressed == [[A, 1], [A, 0], [HAT_X, -1], [HAT_X, 0], [START, 1], [START, 0]]
    assert seen["claims_rumble"] is False


def test_the_desktop_sees_the_end_of_what_it_saw_begin_and_nothing_more(guest):
    seen = guest("copilot_keyboard")
    enter = [event for event in seen["desktop_before"] if event[0] == 1]
    assert enter[0] == [1, 28, 1]
    assert enter[-1] == [1, 28, 0]
    assert seen["desktop_after"] == []


def test_what_is_held_at_the_begin_is_waited_for(guest):
    said = guest("copilot_keyboard")["while_held"]
    assert said == "Helper keyboard plays along once all its buttons are released"


def test_chords_are_heard_on_a_keyboard_that_plays_along(guest):
    assert guest("copilot_keyboard")["chords"] == ["panic"]


def test_our_pointer_yields_to_the_mouse(guest):
    seen = guest("mouse")
    assert "Real mouse" in seen["said"]
    assert seen["steps"]["alone"] > 0
    assert seen["steps"]["while the mouse moves"] == 0
    assert seen["steps"]["afterwards"] > 0


def test_the_service_waits_for_who_plays_along(guest):
    seen = guest("copilot_service")
    assert seen["told"][-1] == "READY=1"
    assert seen["profile"] == "racing"  # the second player's
    assert seen["before"].startswith("waits for Helper pad. There is no input device 'Helper pad'")
    assert seen["there"].startswith("Helper pad (/dev/input/event")
    assert seen["away"].startswith("Helper pad is unplugged")


def test_who_plays_along_moves_the_services_pad(guest):
    seen = guest("copilot_service")
    assert sorted(seen["helper"]) == [[1, A, 1], [3, X, -32767]]
    assert sorted(seen["unplugged"]) == [[1, A, 0], [3, X, 0]]
    assert seen["back"] == [[1, B, 1]]
    assert seen["last"] == [1, B, 0]
    assert seen["exit_code"] == 0


def test_games_shake_who_comes_after_the_service(guest):
    assert guest("copilot_service")["rumble"] == [[0x8000, 0x4000], [0, 0]]


def test_a_service_without_the_right_says_so(guest):
    said = guest("copilot_service")["without_right"]
    assert said.startswith("waits for Helper pad. You have no right to read /dev/input/event")

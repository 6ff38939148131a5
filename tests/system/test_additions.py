"""What an administrator may add, in a whole Debian: a second player, the examples."""

import pytest


@pytest.fixture(scope="module")
def second(guest):
    return guest("second")


def test_another_player_has_a_service_and_a_pad_of_their_own(second):
    assert second["enabled"]["code"] == 0, second["enabled"]["err"]
    assert second["show"]["ActiveState"] == "active"
    assert second["show"]["User"] == "neurotouch"
    assert second["show"]["NRestarts"] == "0"
    assert second["exposure"] <= 1.0


def test_nobody_gets_the_camera_of_the_other(second):
    assert second["quiet_without_camera"]
    assert second["first_quiet"]
    assert second["second_quiet"]
    assert second["first_in_the_end"] == second["first"]


def test_an_order_reaches_the_player_who_is_meant(second):
    assert second["paused"]["code"] == 0, second["paused"]["err"]
    assert not second["first_paused"]
    assert second["resumed"]["code"] == 0


def test_two_services_leave_no_right_behind(second):
    assert not [line for line in second["uinput"]["acl"] if line.startswith("user:neurotouch")]


def test_services_that_start_at_the_same_moment_all_get_a_pad(guest):
    seen = guest("together")
    assert seen["started"]["code"] == 0, seen["started"]["err"]
    assert len(set(seen["pads"].values())) == 3
    for each in seen["show"].values():
        assert each == {"ActiveState": "active", "NRestarts": "0", "Result": "success"}
    assert not [line for line in seen["uinput"]["acl"] if line.startswith("user:neurotouch")]


def test_with_the_examples_it_is_a_true_hid_and_a_pad_plays_along(guest):
    seen = guest("examples")
    assert seen["restarted"]["code"] == 0, seen["restarted"]["err"]
    assert seen["name"].strip() == "NeuroTouch Gamepad"
    assert seen["both"]
    assert seen["player_reads_helper"]
    assert seen["exposure"] <= 1.0
    for node in seen["nodes"].values():
        assert node["mode"] == "0o600"
        assert not [line for line in node["acl"] if line.startswith("user:neurotouch")]

"""The service at work in a whole Debian: a game, orders, the cable, faults."""

import pytest


@pytest.mark.parametrize("library", ["sdl2", "sdl3"])
def test_a_game_of_the_user_sees_the_pad_and_reads_it(guest, library):
    seen = guest("play")["game"]
    assert seen["n_gamepads"][library] == 1
    assert "360" in seen["names"][library]
    _, high = seen["seen"][library]["leftx"]
    assert high > 16000, "the push to the right"


def test_the_user_at_the_seat_pauses_it_and_others_may_not(guest):
    seen = guest("order")
    assert seen["paused"]["code"] == 0, seen["paused"]["err"]
    assert seen["quiet"]
    assert "paused" in seen["status"]["out"]
    assert seen["resumed"]["code"] == 0
    assert seen["root"]["code"] == 0
    assert seen["stranger"]["code"] == 8
    assert "another user" in seen["stranger"]["err"]


def test_the_settings_of_the_person_at_the_seat_apply(guest):
    seen = guest("people")
    assert seen["player"]["code"] == 0, seen["player"]["err"]
    assert "does not play it: This driver belongs to another user" in seen["refused"]["out"]
    assert seen["not_theirs"]
    assert "visitor" in seen["status"] or "platformer" in seen["status"]
    assert seen["same"]
    assert seen["undone"]["code"] == 0, seen["undone"]["err"]
    assert seen["in_the_end"]


@pytest.mark.parametrize("who", ["root", "player", "service"])
def test_a_second_driver_is_refused_with_a_clear_sentence(guest, who):
    seen = guest("another")
    assert seen[who]["code"] == 75
    assert "already" in seen[who]["err"]
    assert "Traceback" not in seen[who]["err"]
    assert seen["same"]


def test_the_cable_pulled_in_a_gesture_makes_it_neutral_and_the_pad_stays(guest):
    seen = guest("pull")
    assert seen["stays"]
    assert seen["same"]
    assert max(seen["neutral_after_s"]) < 0.1


def test_after_a_pull_play_goes_on_with_the_same_node(guest):
    assert guest("pull")["same_reader_pushed"]


def test_after_a_storm_of_plugs_play_goes_on_with_the_same_node(guest):
    seen = guest("storm")
    assert seen["same"]
    assert seen["restarts"] == "0"
    before, after = seen["descriptors"]
    assert after <= before + 2, "a leak"


def test_a_port_switched_off_and_on_is_like_a_plug(guest):
    assert guest("switched_off")["same"]


def test_without_a_camera_nothing_is_restarted(guest):
    seen = guest("mute")
    assert seen["same"]
    assert seen["status"]["ActiveState"] == "active"


def test_a_mistake_in_its_settings_is_named_and_mended(guest):
    seen = guest("settings")
    assert seen["failed"]["code"] != 0
    assert "service.yaml:2:1" in seen["journal"]
    assert "'profile'" in seen["journal"]
    assert seen["mended"]["code"] == 0
    assert seen["profile"] == "spacecraft"


def test_stopped_in_a_gesture_nothing_is_stuck(guest):
    seen = guest("stop")
    assert seen["left_pressed"] == []
    assert seen["pad"] is None
    assert seen["result"]["Result"] == "success"


def test_killed_in_a_gesture_it_is_back_by_itself(guest):
    seen = guest("crash")
    assert seen["ended"] == "No such device"
    assert int(seen["restarts"]) >= 1


def test_hanging_it_is_ended_by_the_watchdog(guest):
    seen = guest("hang")
    assert seen["ended"] == "No such device"
    assert seen["after_s"] < 90

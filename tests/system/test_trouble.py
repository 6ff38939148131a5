"""What goes wrong around the service: play goes on, and nothing is lost."""

import pytest


@pytest.mark.parametrize("chapter", ["clock", "full", "read_only", "memory", "frozen"])
def test_play_goes_on_in_the_same_process(guest, chapter):
    assert guest(chapter)["same"]


def test_a_clock_that_jumps_by_hours_is_no_error(guest):
    seen = guest("clock")
    assert seen["codes"] == [0, 0, 0]
    assert seen["errors"] == [[], [], []]


@pytest.mark.parametrize("chapter", ["full", "read_only"])
def test_what_cannot_be_saved_is_refused_and_loses_nothing(guest, chapter):
    seen = guest(chapter)
    refused = seen["refused"]["out"] + seen["refused"]["err"]
    assert seen["refused"]["code"] == 6, refused
    assert "Saved" not in refused
    assert "Traceback" not in refused
    assert "Fix: " in refused
    assert seen["kept"]
    assert not seen["left_pressed"], "what was not saved acts"
    assert seen["saved"]["code"] == 0, seen["saved"]["err"]


def test_the_one_that_takes_all_memory_is_ended_and_not_the_service(guest):
    assert guest("memory")["codes"] == [0, -9]


def test_a_machine_that_stood_still_plays_on(guest):
    seen = guest("frozen")
    assert seen["seconds"] > 4.0
    assert seen["neutral_after_s"] < 0.1

"""A processor is taken away from a driver that plays on it."""

import pytest

from tests.kernel.test_run import NEUTRAL, follows, read_reports, read_trace

N_TAKEN = 5


@pytest.fixture(scope="module")
def saw(guest):
    return guest("processor")


def test_it_was_taken_away_while_the_driver_ran_on_it(saw):
    assert saw["ran_on"][: 2 * N_TAKEN] == [1, 0] * N_TAKEN


def test_the_driver_plays_on_and_the_pad_says_all_that_the_trace_says(saw, results):
    traced = read_trace(results / "processor.jsonl")
    assert len(traced) > 100
    assert follows(read_reports(saw["events"]), traced)


def test_in_the_end_all_is_neutral(saw):
    assert read_reports(saw["events"])[-1] == NEUTRAL
    assert saw["ended"] == "No such device"
    assert saw["exit_code"] == 0

"""A driver among disturbances leaves nothing behind; ``make soak`` looks for hours."""

from dataclasses import replace

import pytest

from neurotouch_hid.messages import GamepadState
from neurotouch_hid.profile import list_profiles
from tests.soak.people import PROFILES
from tests.soak.soak import MOST_KB_PER_HOUR, Result, Twin, Weight, build_pipeline, run_soak
from tests.soak.source import load_tour

PUSH_US = 2_000_000
"""The first gesture of the tour, and the rest around it."""


def test_two_disturbed_cycles_leave_nothing_behind(folder, monkeypatch):
    monkeypatch.setattr("tests.soak.source.CYCLE_US", 20_000_000)
    result = run_soak(40 / 3600, 1, folder, PUSH_US, print)
    assert result.faults == []
    assert result.n_equal == len(result.weights) == 2
    assert result.hours == pytest.approx(40 / 3600, rel=0.1)
    assert result.done["settle"] == 2


def test_people_choose_profiles_that_exist():
    assert set(PROFILES) <= set(list_profiles())


def test_a_driver_that_does_something_else_is_noticed():
    tour = load_tour(PUSH_US)
    twin, driver = Twin(tour, (), lambda: True), build_pipeline()
    for packet in tour:
        twin(driver.advance(packet))
    assert twin.faults == []
    twin(replace(driver.advance(tour[-1]), pad=GamepadState(0, keys=frozenset({"KEY_A"}))))
    assert len(twin.faults) == 1


def test_growth_of_the_memory_is_measured_after_the_start():
    weights = [Weight(100_000 + 1_000 * min(n, 40) + n, 9, 9, 9) for n in range(300)]
    assert Result(10.0, weights=weights).kb_per_hour == pytest.approx(30.0, rel=0.01)
    assert Result(0.1, weights=weights[:5]).kb_per_hour == 0.0
    assert MOST_KB_PER_HOUR > 30.0

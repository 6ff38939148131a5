"""Some hundred cases of each kind of message and of profiles; the same each time."""

import random

import pytest

from tests.fuzz.area import run_area
from tests.fuzz.areas import MESSAGES


@pytest.mark.parametrize("name", MESSAGES)
def test_whatever_comes_is_answered(tmp_path, name):
    assert run_area(MESSAGES[name], f"{name}-1", tmp_path, cases=200).faults == []


@pytest.mark.parametrize("name", MESSAGES)
def test_equal_seeds_give_equal_cases(name):
    one, same = random.Random("x"), random.Random("x")
    for _ in range(50):
        assert MESSAGES[name].make(one) == MESSAGES[name].make(same)

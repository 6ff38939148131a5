"""Some hundred cases of each kind of message and of profiles; the same each time."""

import random
from itertools import islice

import pytest

from tests.fuzz import control_socket, page_messages, profiles


@pytest.mark.parametrize("area", [control_socket, page_messages, profiles])
def test_whatever_comes_is_answered(area):
    for case in islice(area.cases(random.Random("messages-1")), 200):
        area.check(case)


@pytest.mark.parametrize("area", [control_socket, page_messages, profiles])
def test_equal_seeds_give_equal_cases(area):
    one, same = area.cases(random.Random("x")), area.cases(random.Random("x"))
    assert list(islice(one, 50)) == list(islice(same, 50))

"""The machine goes to sleep in a gesture, with the camera plugged in, and wakes up again.

The kernel's own test of suspending freezes all programs, the camera's too. Then the port is reset,
as Linux resets one that has lost its power in the sleep. Deeper than that the guest cannot sleep.
"""

import pytest

from tests.kernel.test_run import NEUTRAL, read_reports


@pytest.fixture(scope="module")
def saw(guest):
    return guest("sleeping")


def test_all_programs_stood_still(saw):
    assert saw["sleep"]["seconds"] >= 4.0


@pytest.mark.parametrize("what", ["sleep", "reset"])
def test_the_pad_is_neutral_and_then_plays_again_by_itself(saw, what):
    n_before = len(read_reports(saw["events"][: saw[what]["n_begun"]]))
    reports = read_reports(saw["events"][: saw[what]["n_after"]])
    assert reports[n_before - 1] != NEUTRAL
    assert NEUTRAL in reports[n_before:]
    assert reports[-1] != NEUTRAL
    assert saw["exit_code"] == 0

"""The values of a browser's message: each has a type and a bound, or is refused in a sentence."""

import json
import math

import pytest

from neurotouch_hid.errors import NeuroTouchError, PageError
from neurotouch_hid.ipc import read_object
from neurotouch_hid.page.hub import _measure
from neurotouch_hid.page.reading import LARGEST, LONGEST, read_number, read_word
from neurotouch_hid.source.simulator.hand_model import read_hand_command

HUGE = "1" + 400 * "0"


@pytest.mark.parametrize("digits", [HUGE, f"-{HUGE}", "1" + 5000 * "0"])
def test_a_whole_number_without_an_end_is_no_finite_number(digits):
    said = read_object(f'{{"value": {digits}}}')
    assert math.isinf(said["value"])
    with pytest.raises(PageError):
        read_number(said["value"])
    assert read_hand_command(f'{{"push_x_mm": {digits}}}'.encode()) is None


@pytest.mark.parametrize("text", ["", "{", "[]", "7", b"\xff", "[" * 100_000, '{"a": ' * 5000])
def test_what_is_no_object_is_none(text):
    assert read_object(text) is None


@pytest.mark.parametrize(
    "value", [None, True, "1", [1], {}, math.nan, math.inf, 1e308, LARGEST + 1, -LARGEST - 1]
)
def test_what_is_no_number_of_a_page_is_refused(value):
    with pytest.raises(PageError):
        read_number(value)


@pytest.mark.parametrize("value", [0, -3, 2.5, LARGEST])
def test_a_number_is_a_float(value):
    assert read_number(value) == value
    assert isinstance(read_number(value), float)


def test_a_word_is_a_text_of_some_length():
    request = {"a": "x" * LONGEST, "b": "x" * (LONGEST + 1), "c": 7, "d": None}
    assert read_word(request, "a") == "x" * LONGEST
    assert read_word(request, "d", "") == read_word(request, "e", "") == ""
    for key in "bcde":
        with pytest.raises(PageError, match=f"'{key}' must be a text"):
            read_word(request, key)


@pytest.mark.parametrize("number", ["1e308", HUGE, "null", '"5"', "[]"])
@pytest.mark.parametrize("key", ["width", "movement_s", "start"])
def test_trials_beyond_all_bounds_are_none(key, number):
    trial = '{"width": 40, "start": [0, 0], "target": [9, 9], "selected": [8, 8], "movement_s": 1}'
    trials = read_object(f'{{"trials": [{", ".join([trial] * 50)}]}}')["trials"]
    assert _measure(trials)
    trials[7] = {**trials[7], key: json.loads(number)}
    with pytest.raises(NeuroTouchError, match=r"trials|number"):
        _measure(trials)

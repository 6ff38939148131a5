"""Percentiles from classes are those of the values, to the width of a class."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from neurotouch_hid.runtime.histogram import Histogram


@given(st.lists(st.integers(0, 1 << 39), min_size=1, max_size=300), st.floats(0.0, 100.0))
def test_percentiles_are_true_to_the_width_of_a_class(values, rank):
    histogram = Histogram()
    histogram.add(values[::2])
    (found,) = histogram.percentiles([rank], values[1::2])
    exact = np.percentile(values, rank, method="inverted_cdf")
    assert exact <= found <= 1.125 * exact + 1


def test_nothing_counted_gives_nothing():
    assert Histogram().percentiles([50.0, 99.9]) == [0.0, 0.0]


def test_what_takes_for_ever_is_counted_as_well():
    histogram = Histogram()
    histogram.add([1 << 60])
    assert histogram.percentiles([50.0])[0] == 2**42

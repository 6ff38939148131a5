"""Values by their rank, and medians."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from neurotouch_hid.kernels.order_statistics import median, select

VALUES = st.lists(st.floats(-1e9, 1e9), min_size=1, max_size=40)


@given(VALUES)
@settings(max_examples=100, deadline=None)
def test_any_place_in_order_is_selected(values):
    chosen = [select(np.array(values), k) for k in range(len(values))]
    assert chosen == sorted(values)


@given(VALUES)
@settings(max_examples=100, deadline=None)
def test_the_median_is_that_of_numpy(values):
    assert median(np.array(values)) == np.median(values)

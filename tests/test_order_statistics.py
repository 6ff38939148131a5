"""Values by their rank, and medians."""

import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from neurotouch_hid.geometry import find_median
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
    assert find_median(np.array(values)) == np.median(values)


@pytest.mark.parametrize("n", [1, 2, 7, 176, 177])
def test_a_median_of_points_is_that_of_numpy(n):
    points = np.random.default_rng(n).normal(size=(n, 2)).astype(np.float32)
    assert find_median(points).tobytes() == np.median(points, axis=0).tobytes()


def test_there_is_no_median_of_nothing():
    assert np.isnan(find_median(np.empty((0, 2)))).all()


def test_a_play_does_not_load_what_the_median_of_numpy_needs():
    # Who compiles a kernel loads it with numba, so the first of two processes may do so.
    play = (
        "import sys; from neurotouch_hid.driver import REFERENCE, Driver; "
        "from dataclasses import replace\n"
        "with Driver(replace(REFERENCE, source='sim:tour')) as driver:\n"
        "    assert len([*driver.steps(seconds=3.0)]) > 200\n"
        "sys.exit('numpy.ma' in sys.modules and 'numba' not in sys.modules)"
    )
    for _ in range(2):
        subprocess.run([sys.executable, "-c", play], check=True, timeout=600)

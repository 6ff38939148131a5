"""Lengths in kernels are as exact as Python's."""

import math

import numpy as np
import pytest

from neurotouch_hid.gesture.elastic.kernels.length import find_length


@pytest.mark.parametrize("spread", [0.1, 3.0])
def test_a_length_is_that_of_python_to_the_last_bit(spread):
    sides = 10.0 ** np.random.default_rng(1).normal(-1.0, spread, (5000, 3))
    sides[::7, 2] = 0.0
    for x, y, z in sides.tolist():
        assert find_length(x, y, z) == math.hypot(x, y, z)

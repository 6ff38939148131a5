"""The tables of the search for a pattern."""

import subprocess
import sys

import numpy as np

from neurotouch_hid.tracker import spectrum

COUNT = """
import neurotouch_hid.driver.driver
from neurotouch_hid.tracker import spectrum
print(spectrum._make_tables.cache_info().currsize)
"""


def test_a_start_makes_no_tables():
    done = subprocess.run([sys.executable, "-c", COUNT], capture_output=True, text=True, check=True)
    assert done.stdout == "0\n"


def test_each_frequency_is_in_the_ring_of_its_distance():
    tables = spectrum._make_tables()
    assert sum(map(len, tables.by_ring)) == tables.ring.size
    for distance, places in enumerate(tables.by_ring):
        assert np.array_equal(places, np.flatnonzero(tables.ring == distance))

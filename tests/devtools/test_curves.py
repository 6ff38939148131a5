"""The curves: a lattice of any size, a cost for each, and pictures that can be read."""

from xml.etree import ElementTree

import numpy as np
import pytest
from neurotouch_devtools.bench import curves


@pytest.mark.parametrize("n", [50, 177, 2000])
def test_a_lattice_fills_the_sensor_and_neighbours_are_near(n):
    rest_px, neighbours = curves.lay_lattice(n)
    assert rest_px.shape == (n, 2)
    assert len(np.unique(rest_px, axis=0)) == n
    assert ((rest_px > 0) & (rest_px < (346, 260))).all()
    pitch = np.abs(rest_px[1] - rest_px[0]).max()
    for k in range(n):
        near = neighbours[k][neighbours[k] >= 0]
        assert k not in near
        assert len(set(near)) == len(near) >= 1
        assert np.abs(rest_px[near] - rest_px[k]).max() < 1.5 * pitch
        assert all(k in neighbours[other] for other in near)


def test_a_cost_is_told_for_few_and_many_markers():
    assert curves.measure_markers(50) > 0.0
    assert curves.measure_markers(2000) > 0.0


def test_both_pictures_are_drawn_of_what_was_measured(tmp_path):
    latency = curves.measure_rates(lambda _: None, (1e5,), 1.2, 200_000)
    assert set(latency[1e5]) == set(curves.RANKS)
    paths = curves.write_curves(tmp_path / "new", latency, {50: 20.0, 2000: 100.0})
    for path in paths:
        assert ElementTree.fromstring(path.read_text()).tag.endswith("svg")
    assert len(paths) == 2

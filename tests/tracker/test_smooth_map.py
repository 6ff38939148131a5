"""The blobs of a smooth map against their plain twin, which compares every pair."""

import numpy as np
import pytest

from neurotouch_hid.tracker.smooth_map import assign


def assign_plainly(model, points, gate_px):
    if not len(model) or not len(points):
        return np.full(len(model), -1)
    distance = np.hypot(*(model[:, None] - points).transpose(2, 0, 1))
    blob, marker = distance.argmin(axis=1), distance.argmin(axis=0)
    rows = np.arange(len(model))
    good = (marker[blob] == rows) & (distance[rows, blob] < gate_px)
    return np.where(good, blob, -1)


@pytest.mark.parametrize("grid_px", [0.0, 4.0], ids=["anywhere", "equally near"])
@pytest.mark.parametrize("gate_px", [1.0, 4.2, 30.0, 500.0])
def test_each_marker_gets_the_blob_that_the_twin_gives_it(gate_px, grid_px):
    rng = np.random.default_rng(1)
    for n, m in [(0, 5), (5, 0), (1, 1), *rng.integers(1, 250, (20, 2)).tolist()]:
        points = rng.uniform(0.0, 260.0, (m, 2))
        model = rng.uniform(-50.0, 300.0, (n, 2))
        n_near = min(n, m)
        model[:n_near] = points[:n_near] + rng.normal(0.0, 3.0, (n_near, 2))
        if grid_px:
            points, model = (np.round(each / grid_px) * grid_px for each in (points, model))
        found = assign(model, points, gate_px)
        assert found.tolist() == assign_plainly(model, points, gate_px).tolist()

"""The lattice is found with any rig, and nothing else is taken for it."""

import numpy as np
import pytest

from neurotouch_hid.geometry import PAPER_GEL, Rig
from neurotouch_hid.tracker.lattice import LatticeConfig, LatticeFinder

CONFIG = LatticeConfig()
FINDER = LatticeFinder(PAPER_GEL, CONFIG)


def look(rig, dome=0.06, tilt=0.0004):
    """Returns markers (177, 2) px as a tilted camera sees them on a dome."""
    r2 = (PAPER_GEL.points_mm**2).sum(axis=1, keepdims=True)
    return rig.to_px(
        PAPER_GEL.points_mm * (1 - dome * r2 / 900) * (1 + tilt * PAPER_GEL.points_mm[:, :1])
    )


def outside(rig, rng, n):
    angle, radius = rng.uniform(0, 2 * np.pi, n), rng.uniform(34, 55, n)
    return rig.to_px(np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1))


@pytest.mark.parametrize(
    ("px_per_mm", "rotation_rad", "centre_px"),
    [
        (2.5, 0.0, (172.5, 129.5)),
        (2.0, 0.35, (150.0, 140.0)),
        (3.0, -0.3, (175.0, 128.0)),
        (2.2, -0.7, (187.0, 115.0)),
        (2.8, 0.7, (165.0, 132.0)),
    ],
)
@pytest.mark.parametrize("seed", range(3))
def test_every_marker_in_lattice_order(px_per_mm, rotation_rad, centre_px, seed):
    rng = np.random.default_rng(seed)
    rig = Rig(centre_px, px_per_mm, rotation_rad)
    truth = look(rig)
    seen = truth + rng.normal(0, 0.1, truth.shape)
    points = np.concatenate([seen, outside(rig, rng, 30)])
    order = rng.permutation(len(points))
    lattice = FINDER.find(points[order])
    assert lattice is not None
    assert (order[lattice.blob] == np.arange(177)).all()  # exactly its own blobs, no spot
    np.testing.assert_array_equal(lattice.position_px, seen)
    assert lattice.bend_px < 0.3
    assert lattice.n_displaced == 0


@pytest.mark.parametrize("seed", range(5))
def test_missing_markers_are_filled_in_and_false_spots_left_out(seed):
    rng = np.random.default_rng(seed)
    rig = Rig((172.0, 130.0), 2.5, 0.2)
    truth = look(rig)
    missing = rng.choice(177, 14, replace=False)
    false = truth[rng.choice(177, 5, replace=False)] + rng.uniform(4, 6, (5, 2))
    points = np.concatenate([np.delete(truth, missing, axis=0), false, outside(rig, rng, 20)])
    lattice = FINDER.find(rng.permutation(points))
    assert lattice is not None
    assert lattice.n_found >= 163 - 2
    error = np.hypot(*(lattice.position_px - truth).T)
    assert np.delete(error, missing).max() < 0.5
    assert error.max() < 1.0


def test_a_known_rig_needs_no_search():
    rig = Rig((150.0, 120.0), 2.4, 0.9)  # a rotation the search could not tell from 0.9 - pi / 2
    lattice = FINDER.find(look(rig), rig)
    assert lattice is not None
    np.testing.assert_allclose(lattice.position_px, look(rig))


@pytest.mark.parametrize("n", [0, 1, 40, 177, 600])
def test_random_points_are_no_gel(n):
    points = np.random.default_rng(n).uniform((0, 0), (346, 260), (n, 2))
    lattice = FINDER.find(points)
    assert lattice is None or _is_refused(lattice)


def test_half_a_gel_is_no_gel():
    truth = look(Rig((30.0, 130.0), 2.5))
    lattice = FINDER.find(truth[truth[:, 0] > 0])
    assert lattice is None or _is_refused(lattice)


def _is_refused(lattice):
    return lattice.share < CONFIG.min_share or lattice.aside > CONFIG.max_aside

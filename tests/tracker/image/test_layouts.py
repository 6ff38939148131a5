"""Every layout is found, at any turn and scale, with dots missing and others beside them."""

import math

import numpy as np
import pytest

from neurotouch_hid.geometry import Rig, count_turns
from neurotouch_hid.tracker.growth import find_net
from neurotouch_hid.tracker.lattice import LatticeFinder
from tests.layouts import GRID, HEX, LAYOUTS, OBLONG, POINTS, RINGS

TURNS = {"paper": 4, "hex": 6, "rings": 6, "grid": 2, "oblong": 2, "points": 1}
NETS = {"paper": 4, "hex": 6, "grid": 4, "oblong": 2}
FINDERS = {name: LatticeFinder(gel) for name, gel in LAYOUTS.items()}


def look(gel, rig, dome=0.06, tilt=0.0004):
    """Returns the markers of a gel, (n, 2) px, as a tilted camera sees them on a dome."""
    points = gel.points_mm
    r2 = (points**2).sum(axis=1, keepdims=True)
    return rig.to_px(points * (1 - dome * r2 / 900) * (1 + tilt * points[:, :1]))


@pytest.mark.parametrize("name", LAYOUTS)
def test_turns_and_lattices_are_known(name):
    gel = LAYOUTS[name]
    net = find_net(gel)
    assert count_turns(gel) == TURNS[name]
    assert (None if net is None else net.n_turns) == NETS.get(name)
    if net is not None:
        z = net.sites @ np.array([net.first_mm, net.second_mm])
        off = gel.points_mm @ (1, 1j) - z
        np.testing.assert_allclose(off, off[0], atol=1e-9)


@pytest.mark.parametrize("share", [0.0, 0.1])
@pytest.mark.parametrize("px_per_mm", [1.6, 2.5, 4.0])
@pytest.mark.parametrize("degrees", [0, 7, 23, 45])
@pytest.mark.parametrize("name", LAYOUTS)
def test_a_gel_is_found(name, degrees, px_per_mm, share):
    gel, rng = LAYOUTS[name], np.random.default_rng((degrees, int(10 * px_per_mm)))
    rig = Rig((176.0, 127.0), px_per_mm, math.radians(degrees))
    truth = look(gel, rig)
    inside = ((truth > 1) & (truth < (345, 259))).all(axis=1)
    seen = inside & (rng.random(gel.n_markers) >= share)
    angle, far = rng.uniform(0, 2 * np.pi, 20), rng.uniform(34, 50, 20)
    lamps = rig.to_px(np.stack([far * np.cos(angle), far * np.sin(angle)], axis=1))
    glints = truth[rng.choice(gel.n_markers, 4, replace=False)] + rng.uniform(3, 5, (4, 2))
    points = np.concatenate([truth[seen] + rng.normal(0, 0.1, (seen.sum(), 2)), lamps, glints])
    expected = math.radians(degrees) + rng.uniform(-0.2, 0.2)
    lattice = FINDERS[name].find(rng.permutation(points), near_rad=expected)
    assert lattice is not None
    assert lattice.n_found >= 0.97 * seen.sum()
    error = np.hypot(*(lattice.position_px - truth).T)
    assert np.median(error[seen]) < 0.3
    assert np.quantile(error[seen], 0.98) < 0.8
    assert lattice.aside < FINDERS[name].config.max_aside or not inside.all()


@pytest.mark.parametrize(("gel", "turn"), [(HEX, 60), (RINGS, 60), (GRID, 180), (OBLONG, 180)])
def test_of_turns_that_look_the_same_the_expected_one_counts(gel, turn):
    points = look(gel, Rig((172.0, 130.0), 2.5, math.radians(10)), tilt=0.0)
    for k in range(-1, 2):
        lattice = FINDERS[gel.name].find(points, near_rad=math.radians(10 + turn * k + 20))
        moved = lattice.position_px - lattice.position_px.mean(axis=0)
        angle = np.angle(np.vdot(gel.points_mm @ (1, 1j), moved @ (1, 1j)))
        assert (math.degrees(angle) - 10 - turn * k + 180) % 360 - 180 == pytest.approx(0, abs=1)


def test_a_layout_without_symmetry_needs_no_expected_turn():
    for degrees in (-170, -95, 60, 140):
        truth = look(POINTS, Rig((172.0, 130.0), 2.5, math.radians(degrees)))
        lattice = FINDERS["points"].find(truth)
        assert np.hypot(*(lattice.position_px - truth).T).max() < 0.3


@pytest.mark.parametrize("name", ["hex", "rings", "points"])
def test_scattered_dots_are_no_gel(name):
    rng = np.random.default_rng(3)
    for _ in range(5):
        lattice = FINDERS[name].find(rng.uniform(5, 255, (150, 2)))
        assert lattice is None or lattice.share < FINDERS[name].config.min_share

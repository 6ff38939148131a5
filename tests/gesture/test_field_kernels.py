"""The field of sticking fingers against its plain twin and against elasticity."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from neurotouch_hid.geometry import LATTICE_MM
from neurotouch_hid.gesture.elastic.field.kernels import (
    couple,
    fill_responses,
    measure_gains,
    respond,
    rim_window,
)
from tests.reference import gesture_elastic as reference

PLACE = st.floats(-26, 26)


@given(PLACE, PLACE, PLACE, PLACE, st.floats(4.5, 9))
def test_respond_equals_its_twin(x, y, cx, cy, a):
    xx, xy, yy, tx, ty = respond(x, y, rim_window(x * x + y * y), cx, cy, a)
    expected = reference.respond(x, y, cx, cy, a)
    np.testing.assert_allclose([[xx, xy, tx], [xy, yy, ty]], expected, atol=1e-9)


@pytest.mark.parametrize("k", [1, 2, 3])
def test_couple_equals_its_twin(k):
    rng = np.random.default_rng(k)
    centres, radii = rng.uniform(-18, 18, (k, 2)), rng.uniform(5, 8, k)
    np.testing.assert_allclose(couple(centres, radii), reference.couple(centres, radii), atol=1e-9)


def test_a_lone_finger_has_its_own_motion():
    np.testing.assert_allclose(couple(np.zeros((1, 2)), np.full(1, 6.5)), np.eye(3), atol=1e-12)


def test_the_push_is_twice_as_large_along_as_across():
    """An incompressible half space far from the finger [Cerruti]; the rim is the same for both."""
    along = respond(20.0, 0.0, rim_window(400.0), 0.0, 0.0, 2.0)[0]
    across = respond(0.0, 20.0, rim_window(400.0), 0.0, 0.0, 2.0)[0]
    assert along / across == pytest.approx(2.0, abs=0.1)


@settings(max_examples=10)
@given(st.integers(0, 2**32 - 1))
def test_gains_equal_their_twin(seed):
    rng = np.random.default_rng(seed)
    points, sites = LATTICE_MM[::5], LATTICE_MM[60:110:9]
    residual, weight = rng.normal(0, 1, points.shape), rng.random(len(points))
    atoms, gains = np.empty((3 * len(sites), 2 * len(points))), np.empty(len(sites))
    fill_responses(points, sites, 6.5, atoms)
    rows = atoms.reshape(len(sites), 3, -1)
    inverse = np.linalg.inv(np.einsum("san,sbn->sab", rows, rows))
    measure_gains(atoms, inverse, residual, weight, gains)
    expected = reference.gains(points, sites, 6.5, residual, weight)
    np.testing.assert_allclose(gains, expected, rtol=1e-9)


def test_the_gain_of_a_finger_is_largest_where_it_is():
    atoms = np.empty((3 * len(LATTICE_MM), 2 * len(LATTICE_MM)))
    fill_responses(LATTICE_MM, LATTICE_MM, 6.5, atoms)
    rows = atoms.reshape(len(LATTICE_MM), 3, -1)
    inverse = np.linalg.inv(np.einsum("san,sbn->sab", rows, rows) + 1e-6 * np.eye(3))
    gains = np.empty(len(LATTICE_MM))
    for site in (88, 40, 120):
        field = (rows[site].T @ (1.0, -2.0, 0.1)).reshape(-1, 2)
        measure_gains(atoms, inverse, field, np.ones(len(field)), gains)
        assert gains.argmax() == site
        assert gains[site] == pytest.approx((field**2).sum(), rel=1e-3)

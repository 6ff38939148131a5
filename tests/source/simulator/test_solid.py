"""The gel of finite elements: what any elastic body must do, and what others computed for ours."""

import numpy as np
import pytest

from neurotouch_hid.geometry import PAPER_GEL
from neurotouch_hid.messages import GestureKind
from neurotouch_hid.source.simulator import GelConfig, SimulatorConfig, push, sequence
from neurotouch_hid.source.simulator.gel import GelMotion, solid
from neurotouch_hid.source.simulator.optics import CameraModel

CENTRE = np.array([[8.0, 0.0]])


def move(points, motion, depth=0.0, centre=CENTRE, radius=7.0):
    """Displacement (n, 3) mm: x, y, depth."""
    points = np.asarray(points, float)
    moved = solid.deform(
        points, centre, np.array([radius]), np.array([motion], float), np.array([depth])
    )
    return moved - np.column_stack([points, np.zeros(len(points))])


def ring(radius):
    angles = np.arange(24) * np.pi / 12
    return CENTRE + radius * np.column_stack([np.cos(angles), np.sin(angles)])


def test_no_code_is_shared_with_the_closed_forms():
    modules = {getattr(value, "__module__", "") for value in vars(solid).values()}
    assert not any("kernels" in str(name) for name in modules | set(vars(solid)))


def test_a_brick_resists_no_rigid_motion_and_a_strain_with_its_energy():
    unit = [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
    shape = np.array([[3.0, 0.4, 0.2], [-0.3, 2.5, 0.5], [0.1, 0.6, 2.0]])  # no right angles
    brick = np.array(unit, float) @ shape.T
    stiffness = solid._stiffen(brick[None])[0]
    strain = np.array([[0.3, 0.1, -0.2], [0.0, -0.1, 0.4], [0.1, 0.0, 0.2]])
    u = (brick @ strain.T).ravel()
    bulk = 2 * solid.POISSON_RATIO / (1 - 2 * solid.POISSON_RATIO)
    symmetric = 0.5 * (strain + strain.T)
    energy = 2 * (symmetric**2).sum() + bulk * np.trace(strain) ** 2
    assert u @ stiffness @ u == pytest.approx(energy * np.linalg.det(shape), rel=1e-9)
    spin = np.array([[0, -1, 0.5], [1, 0, -2], [-0.5, 2, 0]])
    assert np.allclose(stiffness @ (brick @ spin.T + 1.0).ravel(), 0.0, atol=1e-9)


def test_the_surface_obeys_betti_and_gives_way():
    compliance = solid.build_surface().compliance
    assert np.allclose(compliance, compliance.T, atol=1e-9 * compliance.max())
    assert np.linalg.eigvalsh(compliance)[0] > 0


@pytest.mark.parametrize(
    ("r", "low", "high"), [(8, 0.55, 0.72), (12, 0.34, 0.44), (18, 0.17, 0.28), (23, 0.12, 0.2)]
)
def test_a_drag_fades_as_in_other_finite_elements(r, low, high):
    # Quadratic hexahedra of a solid dome, bonded base, a = 7 mm, 8 mm off the axis: 0.61-0.66 at
    # 8 mm, 0.40-0.42 at 12, 0.26 at 18, 0.16-0.18 at 23.
    points = ring(r)
    points = points[np.hypot(*points.T) < 29]
    u = move(points, (0, 0.2, 0))[:, :2]
    assert low < np.hypot(*u.T).mean() / 0.2 < high


def test_a_finger_takes_along_what_it_touches():
    inside = ring(4.0)
    assert np.allclose(move(inside, (0, 0.2, 0))[:, :2], (0, 0.2), atol=0.02)
    turned = move(inside, (0, 0, 0.3))[:, :2]
    c, s = np.cos(0.3) - 1, np.sin(0.3)
    assert np.allclose(turned, (inside - CENTRE) @ np.array([[c, s], [-s, c]]), atol=0.2)


def test_a_press_goes_down_and_hardly_aside():
    u = move(np.vstack([CENTRE, ring(18)]), (0, 0, 0), depth=4.0)
    assert 3.0 < u[0, 2] < 4.2
    assert np.abs(u[1:, 2]).max() < 0.3
    assert np.hypot(*u[:, :2].T).max() < 1.0


def test_the_longest_push_folds_nothing():
    moved = PAPER_GEL.points_mm + move(PAPER_GEL.points_mm, (-18, 0, 0), 1.5, radius=6.5)[:, :2]
    apart = np.hypot(*(moved[:, None] - moved).T) + 99 * np.eye(len(moved))
    assert apart.min() > 0.6


def test_both_gels_play_the_same_script_alike():
    script = sequence("x", push(0.5, 6.0, (-4.0, 3.0)), rest_us=60_000)
    camera = SimulatorConfig().camera
    truths = [
        GelMotion(script, CameraModel(camera), GelConfig(elasticity=gel)).truth(700_000)
        for gel in ("half-space", "solid")
    ]
    assert [truth.kind for truth in truths] == [GestureKind.PUSH] * 2
    apart = np.hypot(*(truths[0].markers_px - truths[1].markers_px).T)
    assert 0.5 < apart.max() < 5.0  # other physics, the same gesture
    assert abs(truths[0].intensity_mm - truths[1].intensity_mm) < 0.4

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from neurotouch_hid.geometry import PAPER_GEL
from neurotouch_hid.source.simulator.kernels import gel as kernels
from tests.reference import gel as reference

MM = st.floats(-20, 20)


NO_NEIGHBOURS, NO_MOBILITY = np.empty((0, 8), np.intp), np.empty(0)


def move(points, centres, radii, motions, depths, neighbours=NO_NEIGHBOURS, mobility=NO_MOBILITY):
    out = np.empty((len(points), 3))
    arrays = [np.array(a, float) for a in (points, centres, radii, motions, depths)]
    kernels.move_points(*arrays, neighbours, mobility, out)
    return out


def drag(delta=5.0, at=(8.0, 0.0), a=7.0, points=PAPER_GEL.points_mm):
    return move(points, [at], [a], [(delta, 0, 0)], [0.0])[:, :2] - points


@settings(deadline=None)
@given(MM, MM, st.floats(4, 9), MM, MM, st.floats(-1, 1))
def test_patch_field_is_the_closed_form(x, y, a, dx, dy, turn):
    found = kernels.patch_field(x, y, a, dx, dy, turn)
    assert np.allclose(found, reference.patch_field(x, y, a, dx, dy, turn), atol=1e-9)


@settings(deadline=None)
@given(st.floats(0, 30), st.floats(4, 9))
def test_press_depth_is_hertz(r, a):
    assert kernels.press_depth(r * r, a) == pytest.approx(reference.hertz_depth(r, a), abs=1e-9)


@settings(max_examples=15, deadline=None)
@given(
    st.lists(
        st.tuples(st.floats(-5, 5), st.floats(-5, 5), st.floats(-0.4, 0.4), st.floats(0, 3)),
        min_size=1,
        max_size=3,
    )
)
def test_deform_equals_its_twin(fingers):
    centres = [(9.0, 1.0), (-8.0, 5.0), (-2.0, -12.0)][: len(fingers)]
    radii = [6.5, 5.5, 7.0][: len(fingers)]
    motions, depths = [f[:3] for f in fingers], [f[3] for f in fingers]
    points = PAPER_GEL.points_mm[::9]
    found = move(points, centres, radii, motions, depths)
    assert np.allclose(found, reference.deform(points, centres, radii, motions, depths), atol=1e-9)


@settings(deadline=None)
@given(st.lists(st.tuples(st.floats(-6, 6), st.floats(-6, 6)), min_size=2, max_size=3))
def test_every_patch_makes_its_own_motion(drags):
    centres = [(10.0, 0.0), (-8.0, 6.0), (-4.0, -11.0)][: len(drags)]
    motions = [(dx, dy, 0.0) for dx, dy in drags]
    found = move(centres, centres, [6.0] * len(drags), motions, [0.0] * len(drags))
    # The centre stands for the patch: the others bend it a little, they do not carry it away.
    assert np.abs(found[:, :2] - centres - drags).max() <= 0.12 * np.abs(drags).max() + 1e-9


def test_drag_agrees_with_finite_elements():
    """Drag of 5 mm at 8 mm off the axis, a = 7: percentages at a distance from the contact."""
    angles = np.linspace(0, 2 * np.pi, 72, endpoint=False)
    contact = np.array([8.0, 0.0])
    for r, low, high in [(8, 61, 66), (12, 40, 42), (14.5, 33, 33), (18, 26, 26), (23, 16, 18)]:
        ring = contact + r * np.column_stack([np.cos(angles), np.sin(angles)])
        ring = ring[np.hypot(*ring.T) < 29.0]
        # A small drag, scaled: the finite elements were linear.
        share = 100 * np.linalg.norm(drag(0.05, points=ring), axis=1).mean() / 0.05
        assert low - 6 <= share <= high + 6, (r, share)


def test_gel_moves_about_twice_as_far_along_the_drag_as_across():
    points = np.array([[14.0, 0.0], [0.0, 14.0]])
    along, across = np.linalg.norm(drag(0.1, at=(0.0, 0.0), points=points), axis=1)
    assert 1.4 <= along / across <= 2.7  # finite elements: 1.7-2.7 over all distances


def test_twist_agrees_with_finite_elements():
    """Twist of 0.5 rad, 8 mm off the axis, a = 7: mm at a distance from the contact."""
    for r, expected in [(5.5, 3.1), (8, 1.35), (12, 0.65), (18, 0.36)]:
        ring = np.array([[8.0, r], [8.0, -r]])
        moved = move(ring, [(8.0, 0.0)], [7.0], [(0, 0, 0.05)], [0.0])[:, :2] - ring
        at_half_rad = 10.0 * np.linalg.norm(moved, axis=1).mean()
        assert at_half_rad == pytest.approx(expected, abs=0.4), r


def test_press_hardly_moves_markers_sideways():
    moved = move(PAPER_GEL.points_mm, [(8.0, 0.0)], [7.0], [(0, 0, 0)], [4.0])
    sideways = np.linalg.norm(moved[:, :2] - PAPER_GEL.points_mm, axis=1)
    assert 0.1 <= sideways.max() <= 0.4
    assert moved[:, 2].max() == pytest.approx(4.0, abs=0.4)


def nearest(points):
    gaps = np.linalg.norm(points[:, None] - points[None], axis=2)
    return (gaps + 9.0 * np.eye(len(points))).min()


@pytest.mark.parametrize("at", [(-9.0, 0.0), (-9.0, 4.0)])
def test_markers_pile_up_and_never_merge(at):
    mobility = (np.hypot(*(PAPER_GEL.points_mm - at).T) > 7.0).astype(float)
    drags = [(18.0, 0.0, 0.0)]
    moved = move(PAPER_GEL.points_mm, [at], [7.0], drags, [0.0], PAPER_GEL.neighbours, mobility)
    assert 1.0 < nearest(moved[:, :2]) < 2.5


def test_resist_squeeze_equals_its_twin():
    rng = np.random.default_rng(5)
    mobility = rng.uniform(0, 1, 177) * (rng.random(177) < 0.7)
    moved = np.column_stack(
        [0.5 * PAPER_GEL.points_mm + rng.normal(0, 0.5, (177, 2)), np.zeros(177)]
    )
    expected = reference.resist_squeeze(PAPER_GEL.points_mm, PAPER_GEL.neighbours, mobility, moved)
    kernels.resist_squeeze(PAPER_GEL.points_mm, PAPER_GEL.neighbours, mobility, moved)
    assert np.allclose(moved, expected, atol=1e-6)


def test_the_rim_holds():
    rim = 30.9 * np.column_stack([np.cos(np.arange(12)), np.sin(np.arange(12))])
    assert np.linalg.norm(drag(18.0, at=(-4.0, 0.0), points=rim), axis=1).max() < 6.0
    assert np.linalg.norm(drag(18.0, at=(-4.0, 0.0), points=rim) + rim, axis=1).max() < 31.1

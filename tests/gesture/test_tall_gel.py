"""A gel that is taller than the closed form knows follows the fingers as a whole."""

import math

import numpy as np
import pytest

from neurotouch_hid.geometry import PAPER_GEL, Rig
from neurotouch_hid.gesture import GestureRecognizer
from neurotouch_hid.messages import GestureKind, MarkerField
from neurotouch_hid.source.simulator.gel import solid

RIG = Rig((171.0, 128.0), 2.5, 0.03)
ALL = np.ones(PAPER_GEL.n_markers, np.bool_)
STEPS = 8
SEEN_LARGER = 0.01  # per mm that the gel sinks towards the lens


@pytest.fixture(scope="module", params=[(15.0, 30.0), (4.0, 17.0)], ids=["tall", "as simulated"])
def gel(request):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(solid, "RIM_MM", request.param[0])
        patch.setattr(solid, "RISE_MM", request.param[1])
        solid.build_surface.cache_clear()
        yield request.param
    solid.build_surface.cache_clear()


def play(centres, motions, knock_mm=(0.0, 0.0)):
    """Returns the last gesture of a motion of 0.4 s, and how far the gel under the fingers goes.

    The whole gel is ``knock_mm`` off its place at rest from the start.
    """
    centres, motions = np.array(centres), np.array(motions)
    points = np.concatenate([PAPER_GEL.points_mm, centres])
    radii, depths = np.full(len(centres), 6.5), np.full(len(centres), 1.5)
    moved = [
        solid.deform(points, centres, radii, k / STEPS * motions, min(1.0, 0.5 * k) * depths)
        for k in range(STEPS + 1)
    ]
    recognizer, rng = GestureRecognizer(), np.random.default_rng(2)
    rest_px = RIG.to_px(PAPER_GEL.points_mm).astype(np.float32)
    for t_us in range(10_000, 750_000, 10_000):
        part = STEPS * min(max((t_us - 200_000) / 400_000, 0.0), 1.0)
        k = min(int(part), STEPS - 1)
        now = (moved[k] + (part - k) * (moved[k + 1] - moved[k]))[: PAPER_GEL.n_markers]
        px = RIG.to_px(now[:, :2] * (1.0 + SEEN_LARGER * now[:, 2:]) + knock_mm)
        px += rng.normal(0.0, 0.1, px.shape)
        gesture = recognizer.update(MarkerField(t_us, rest_px, px.astype(np.float32), ALL))
    x, y, sunk = moved[-1][PAPER_GEL.n_markers :].T
    far = np.hypot(*(np.column_stack([x, y]) * (1.0 + SEEN_LARGER * sunk[:, None]) - centres).T)
    return gesture, float(far.mean())


@pytest.mark.parametrize("knock_mm", [(0.0, 0.0), (1.0, -0.5)])
@pytest.mark.parametrize(
    ("centre", "drag"),
    [
        ((-2.0, 2.0), (-8.4, -2.8)),
        ((5.0, -14.0), (-1.4, -5.6)),
        ((11.5, 4.2), (3.3, 6.5)),
        ((-18.0, -7.0), (0.8, 6.8)),
    ],
)
def test_a_push_is_one_contact_as_far_as_the_gel_goes(gel, centre, drag, knock_mm):
    gesture, far_mm = play([centre], [(*drag, 0.0)], knock_mm)
    assert gesture.kind is GestureKind.PUSH
    assert len(gesture.contacts_mm) == 1
    assert gesture.intensity_mm == pytest.approx(far_mm, rel=0.09)


<<<<<<< HEAD
@pytest.mark.parametrize(("centre", "drag"), [((0.5, -4.0), (0.6, 7.1)), ((6.0, -6.5), (4.0, 3.7))])
def test_a_push_that_presses_deep_is_one_contact(gel, centre, drag):
    gesture, far_mm = play([centre], [(*drag, 0.0)], depth_mm=6.5)
    assert gesture.kind is GestureKind.PUSH
    assert len(gesture.contacts_mm) == 1
    assert gesture.intensity_mm == pytest.approx(far_mm, rel=0.12)


=======
>>>>>>> parent of 3664f3a (gesture: gel that is pressed flows aside far from the finger, which it sticks to: a deep push on a tall gel was two contacts)
def test_a_twist_is_as_far_as_the_gel_goes(gel):
    angle = 0.4
    centres = 11.0 * np.array([[1.0, 0.0], [-1.0, 0.0]])
    cos, sin = math.cos(angle), math.sin(angle)
    drags = centres @ np.array([[cos, sin], [-sin, cos]]) - centres
    gesture, far_mm = play(centres, np.column_stack([drags, [angle, angle]]))
    assert gesture.kind in (GestureKind.TWIST_CW, GestureKind.TWIST_CCW)
    assert len(gesture.contacts_mm) == 2
    assert gesture.intensity_mm == pytest.approx(far_mm, rel=0.09)

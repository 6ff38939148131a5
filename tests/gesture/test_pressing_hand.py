"""A hand that presses before it drags is found where it drags."""

import numpy as np
import pytest

from neurotouch_hid.geometry import PAPER_GEL, Rig
from neurotouch_hid.gesture import GestureRecognizer
from neurotouch_hid.messages import GestureKind, MarkerField
from neurotouch_hid.source.simulator.gel import solid

RIG = Rig((171.0, 128.0), 2.5, 0.03)
ALL = np.ones(PAPER_GEL.n_markers, np.bool_)
RADIUS_MM = 6.5
SEEN_LARGER = 0.01  # per mm that the gel sinks towards the lens
PINCH_MM = 3.5


@pytest.mark.parametrize(
    ("centres", "depth_mm"),
    [
        ([(11.1, 4.6), (-7.5, 2.1), (4.0, -11.9)], 7.2),
        ([(0.5, -6.9), (12.3, 4.6), (-2.9, 8.5)], 4.9),
        ([(6.2, 3.7), (-12.2, 8.8), (-10.3, -9.2)], 6.0),
        ([(7.3, 8.5), (-10.6, 4.0), (5.5, -9.2)], 5.0),
    ],
)
def test_three_fingers_that_press_first_pinch(centres, depth_mm):
    centres = np.array(centres)
    inward = centres.mean(axis=0) - centres
    motions = np.zeros((3, 3))
    motions[:, :2] = PINCH_MM * inward / np.hypot(*inward.T)[:, None]
    gestures = _play(centres, motions, np.full(3, depth_mm))
    assert gestures[-1].kind is GestureKind.PINCH
    assert len(gestures[-1].contacts_mm) == 3
    assert gestures[-1].intensity_mm == pytest.approx(PINCH_MM, abs=1.0)


@pytest.mark.parametrize(
    ("kind", "centres", "motions", "depths_mm"),
    [
        (
            GestureKind.TWIST_CW,
            [(-11.6, 13.5), (6.2, 0.1)],
            [(-1.3, -2.3, 0.18), (1.3, 2.3, 0.18)],
            (6.8, 3.9),
        ),
        (
            GestureKind.ZOOM,
            [(3.8, -8.8), (-21.3, 0.5)],
            [(1.5, -0.6, 0.0), (-1.6, 0.6, 0.0)],
            (6.1, 4.2),
        ),
        (
            GestureKind.ZOOM,
            [(-5.2, 4.9), (19.3, -1.7)],
            [(-1.8, 0.5, 0.0), (1.7, -0.5, 0.0)],
            (7.9, 3.4),
        ),
    ],
)
def test_two_fingers_that_press_deep_are_two_contacts(kind, centres, motions, depths_mm):
    """The gel flows aside, far from both, as if a third finger dragged it."""
    gestures = _play(np.array(centres), np.array(motions), np.array(depths_mm))[-13:]
    assert {gesture.kind for gesture in gestures} == {kind}
    assert {len(gesture.contacts_mm) for gesture in gestures} == {2}


def _play(centres, motions, depths):
    """Returns the gestures of a hand that presses, waits and then drags; one for each 10 ms."""
    still = np.zeros_like(motions)
    press = [_deform(centres, still, share * depths) for share in np.linspace(0.0, 1.0, 5)]
    drag = [_deform(centres, share * motions, depths) for share in np.linspace(0.0, 1.0, 9)]
    recognizer, rng = GestureRecognizer(), np.random.default_rng(2)
    rest_px = RIG.to_px(PAPER_GEL.points_mm).astype(np.float32)
    gestures = []
    for t_us in range(10_000, 700_001, 10_000):
        # 0.1 s of rest, 0.2 s in which it presses, 0.1 s in which it waits, 0.3 s of drag
        pressed = np.clip((t_us - 100_000) / 200_000, 0.0, 1.0)
        dragged = np.clip((t_us - 400_000) / 300_000, 0.0, 1.0)
        now = _blend(drag, dragged) if dragged else _blend(press, pressed)
        px = RIG.to_px(now) + rng.normal(0.0, 0.1, now.shape)
        gestures.append(recognizer.update(MarkerField(t_us, rest_px, px.astype(np.float32), ALL)))
    return gestures


def _deform(centres, motions, depths):
    """Where the camera sees the markers, (n, 2) mm."""
    moved = solid.deform(
        PAPER_GEL.points_mm, centres, np.full(len(centres), RADIUS_MM), motions, depths
    )
    return moved[:, :2] * (1.0 + SEEN_LARGER * moved[:, 2:])


def _blend(fields, share):
    at = share * (len(fields) - 1)
    k = min(int(at), len(fields) - 2)
    return fields[k] + (at - k) * (fields[k + 1] - fields[k])

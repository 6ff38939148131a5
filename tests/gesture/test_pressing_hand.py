"""A hand that presses before it drags is found where it drags."""

import numpy as np
import pytest

from neurotouch_hid.geometry import PAPER_GEL, Rig
from neurotouch_hid.gesture import GestureRecognizer
from neurotouch_hid.messages import GestureKind, MarkerField
from neurotouch_hid.source.simulator.gel import solid

RIG = Rig((171.0, 128.0), 2.5, 0.03)
ALL = np.ones(PAPER_GEL.n_markers, np.bool_)
RADII, STILL = np.full(3, 6.5), np.zeros((3, 3))
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
    depths = np.full(3, depth_mm)
    press = [_deform(centres, STILL, share * depths) for share in np.linspace(0.0, 1.0, 5)]
    drag = [_deform(centres, share * motions, depths) for share in np.linspace(0.0, 1.0, 9)]
    recognizer, rng = GestureRecognizer(), np.random.default_rng(2)
    rest_px = RIG.to_px(PAPER_GEL.points_mm).astype(np.float32)
    for t_us in range(10_000, 700_001, 10_000):
        # 0.1 s of rest, 0.2 s in which it presses, 0.1 s in which it waits, 0.3 s of drag
        pressed = np.clip((t_us - 100_000) / 200_000, 0.0, 1.0)
        dragged = np.clip((t_us - 400_000) / 300_000, 0.0, 1.0)
        now = _blend(drag, dragged) if dragged else _blend(press, pressed)
        px = RIG.to_px(now) + rng.normal(0.0, 0.1, now.shape)
        gesture = recognizer.update(MarkerField(t_us, rest_px, px.astype(np.float32), ALL))
    assert gesture.kind is GestureKind.PINCH
    assert len(gesture.contacts_mm) == 3
    assert gesture.intensity_mm == pytest.approx(PINCH_MM, abs=1.0)


def _deform(centres, motions, depths):
    """Where the camera sees the markers, (n, 2) mm."""
    moved = solid.deform(PAPER_GEL.points_mm, centres, RADII, motions, depths)
    return moved[:, :2] * (1.0 + SEEN_LARGER * moved[:, 2:])


def _blend(fields, share):
    at = share * (len(fields) - 1)
    k = min(int(at), len(fields) - 2)
    return fields[k] + (at - k) * (fields[k + 1] - fields[k])

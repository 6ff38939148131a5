"""The motion of the rig is found among markers that a finger moves."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from neurotouch_hid.geometry import PAPER_GEL, Rig
from neurotouch_hid.tracker.kernels import rigid

AT_PX = Rig((172.0, 130.0), 2.5).to_px(PAPER_GEL.points_mm)
REACH_PX = 80.0


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=30, deadline=None)
def test_touched_and_unseen_markers_do_not_count(seed):
    rng = np.random.default_rng(seed)
    moved = Rig(tuple(rng.uniform(100, 200, 2)), rng.uniform(2.2, 2.8), rng.uniform(-0.2, 0.2))
    true_px = moved.to_px(PAPER_GEL.points_mm)
    order = rng.permutation(len(AT_PX))
    now_px = true_px + rng.normal(0, 0.05, true_px.shape)
    now_px[order[:30]] += rng.uniform(-8, 8, (30, 2))
    match = np.arange(len(AT_PX), dtype=np.int32)
    match[order[30:60]] = -1
    out_px = np.empty_like(AT_PX)
    far_px = rigid.follow_rig(AT_PX, now_px, match, out_px)
    assert np.abs(out_px - true_px).max() < 0.3
    assert far_px == pytest.approx(np.median(np.hypot(*(true_px - AT_PX).T)), rel=0.2)


@pytest.mark.parametrize("by_px", [(0.0, 0.0), (9.0, 4.0), (-15.0, 8.0)])
def test_a_disc_that_moved_by_more_than_a_pitch_is_found_again(by_px):
    lamps = np.array([[290.0, 30.0], [40.0, 210.0]])
    points = np.concatenate([AT_PX + by_px, lamps])
    found = rigid.recentre(points, AT_PX.mean(axis=0), REACH_PX)
    np.testing.assert_allclose(found, by_px, atol=3.5)  # the gate of the pairs


def test_too_few_markers_show_no_motion():
    match = np.full(len(AT_PX), -1, np.int32)
    out_px = np.empty_like(AT_PX)
    assert rigid.follow_rig(AT_PX, AT_PX + 3.0, match, out_px) == 0.0
    np.testing.assert_array_equal(out_px, AT_PX)

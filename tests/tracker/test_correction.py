"""The compiled assignment of blobs to tracks against its plain twin."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from neurotouch_hid.geometry import PAPER_GEL, Rig
from neurotouch_hid.tracker import TrackerConfig
from neurotouch_hid.tracker.config import make_tracks
from neurotouch_hid.tracker.kernels import filter as kernels
from neurotouch_hid.tracker.kernels import tracks as track_kernels
from neurotouch_hid.tracker.kernels.correction import (
    assign_blobs,
    compare,
    recall,
)
from neurotouch_hid.tracker.kernels.rest_position import drift
from neurotouch_hid.tracker.kernels.rigid import median_size
from tests.reference import tracker as reference

REST_PX = Rig((172.0, 130.0), 2.5, 0.1).to_px(PAPER_GEL.points_mm)
TUNING = TrackerConfig().tuning()


@given(st.integers(0, 2**32 - 1), st.floats(0.0, 0.2))
@settings(max_examples=20, deadline=None)
def test_blobs_are_those_of_the_plain_twin(seed, share):
    """Some tracks follow a neighbour, some blobs are hidden, merged or of no marker."""
    rng = np.random.default_rng(seed)
    truth = REST_PX + rng.normal(0, 1, REST_PX.shape)
    then = truth + rng.normal(0, 0.5, REST_PX.shape)
    astray = rng.random(177) < share
    then[astray] += rng.uniform(-12, 12, (int(astray.sum()), 2))
    points = truth[rng.random(177) < 0.95]
    points = np.concatenate([points, rng.uniform(100, 240, (5, 2))])
    areas = np.where(rng.random(len(points)) < 0.05, 14, rng.integers(5, 8, len(points)))
    begin = np.concatenate([[0], np.cumsum(areas)]).astype(np.int32)
    sharp, missed = rng.random(177) < 0.95, rng.integers(0, 2, 177)
    tracks = make_tracks(PAPER_GEL.neighbours, TrackerConfig())
    tracks.rest_px[:], tracks.lost[:] = REST_PX, rng.random(177) < share
    tracks.state["n_missed"], blob = missed, np.empty(177, np.int32)
    assign_blobs(then, sharp, points, begin, tracks, TUNING, blob)
    twin, twin_missed = reference.assign_blobs(
        then.tolist(), sharp.tolist(), points.tolist(), areas.tolist(), missed.tolist(),
        tracks.lost.tolist(), REST_PX.tolist(), PAPER_GEL.neighbours.tolist(), TUNING,
    )  # fmt: skip
    assert [None if j < 0 else j for j in blob.tolist()] == twin
    assert tracks.state["n_missed"].tolist() == twin_missed
    assert sum(j is not None for j in twin) > 100


def test_past_positions_are_interpolated_as_far_back_as_the_ring_reaches():
    tracks = make_tracks(PAPER_GEL.neighbours, TrackerConfig())
    tracks.rest_px[:] = REST_PX
    track_kernels.place(np.arange(177), REST_PX, 1.0, 0.0, tracks, TUNING)
    tracks.state["vx"] = 100.0
    out = np.empty((177, 2))
    for t_us in range(0, 200_000, 2_000):
        kernels.check(t_us, tracks, TUNING)
        tracks.common["next_check_us"] += 2_000
    assert recall(197_000, tracks, out)
    ring = tracks.past_px[(tracks.common["n_checks"][0] - 1) % 64]
    np.testing.assert_allclose(out, ring, atol=1e-9)
    assert recall(198_500, tracks, out)  # after the last check
    assert not recall(70_000, tracks, out)
    assert not recall(260_000, tracks, out)
    kernels.check(206_000, tracks, TUNING)  # a late check
    assert recall(204_000, tracks, out)
    before, after = (tracks.past_px[(tracks.common["n_checks"][0] - k) % 64] for k in (2, 1))
    np.testing.assert_allclose(out, before + 0.75 * (after - before), atol=1e-9)


def test_tracks_are_compared_with_where_the_markers_were():
    tracks = make_tracks(PAPER_GEL.neighbours, TrackerConfig())
    tracks.rest_px[:] = REST_PX
    track_kernels.place(np.arange(177), REST_PX, 1.0, 0.0, tracks, TUNING)
    by_px, astray = np.empty((177, 2)), np.empty(177, np.bool_)
    off_px = np.array([0.5, -0.25])
    shown_px = (REST_PX + off_px).astype(np.float32)
    assert compare(tracks, 2_000, shown_px, 2.0, by_px, astray) == -1  # there is no past yet
    kernels.check(2_000, tracks, TUNING)
    shown_px[7] += (9.0, 0.0)
    tracks.lost[:3], tracks.state["n_missed"][:1] = True, 3
    assert compare(tracks, 2_000, shown_px, 2.0, by_px, astray) == 1
    assert np.flatnonzero(astray).tolist() == [7]
    assert np.flatnonzero(tracks.lost).tolist() == [0]  # frames have missed it too often
    expected = np.where(astray[:, None], 0.0, shown_px - REST_PX)
    np.testing.assert_allclose(by_px, expected, atol=1e-4)


@given(st.integers(0, 2**32 - 1), st.floats(0.01, 3.0))
@settings(max_examples=20, deadline=None)
def test_rest_positions_follow_as_the_plain_twin_does(seed, sigma_px):
    rng = np.random.default_rng(seed)
    off = rng.normal(0.1, sigma_px, (177, 2))
    rest_px = REST_PX.copy()
    drift(off, 0.3, 0.1, 0.2, 1.0, rest_px)
    twin = reference.drift(off.tolist(), 0.3, 0.1, 0.2, 1.0, REST_PX.tolist())
    np.testing.assert_allclose(rest_px, twin, atol=1e-9)
    np.testing.assert_allclose(median_size(off), np.median(np.hypot(*off.T)))

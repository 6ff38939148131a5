"""Where frames are rare, each event of a marker's edge is a step of its motion."""

import numpy as np
import pytest

from neurotouch_hid.geometry import PAPER_GEL, Rig
from neurotouch_hid.tracker import TrackerConfig
from neurotouch_hid.tracker.config import make_tracks
from neurotouch_hid.tracker.kernels.filter import check
from neurotouch_hid.tracker.kernels.slow_motion import (
    FEW_STEPS,
    OFTEN_US,
    SELDOM_US,
    SHOWN,
    SLOW_PX_S,
    STEPS_PER_PX,
    follow_steps,
    forget_steps,
    is_due,
    needs_steps,
)
from neurotouch_hid.tracker.kernels.tracks import note_frame

CHECK_S = 2e-3
CONFIG = TrackerConfig()


@pytest.fixture
def tracks():
    tracks = make_tracks(PAPER_GEL.neighbours, CONFIG)
    places_px = Rig((172.5, 129.5), 2.6).to_px(PAPER_GEL.points_mm)
    tracks.state["x"], tracks.state["y"] = places_px.T
    return tracks


def follow(tracks, steps, n_checks, moved_px_s=(0.0, 0.0)):
    """Returns how far steps have moved each marker; ``moved_px_s``: their events' places do."""
    begin_px = np.column_stack([tracks.state["x"], tracks.state["y"]])
    by_places_px = np.array(moved_px_s) * CHECK_S
    for _ in range(n_checks):
        before_px = np.column_stack([tracks.state["x"], tracks.state["y"]])
        now_px = before_px + by_places_px
        tracks.state["x"], tracks.state["y"] = now_px.T
        tracks.steps[:] += steps
        follow_steps(CHECK_S, before_px, now_px, tracks, CONFIG.tuning())
        assert np.allclose(now_px, np.column_stack([tracks.state["x"], tracks.state["y"]]))
    now_px = np.column_stack([tracks.state["x"], tracks.state["y"]])
    return now_px - begin_px - n_checks * by_places_px


def test_steps_move_slow_markers(tracks):
    px_s = np.array((0.6, -0.8))
    moved_px = follow(tracks, STEPS_PER_PX * px_s * CHECK_S, 1_000)
    assert np.allclose(moved_px, 2.0 * px_s, rtol=0.03)


def test_a_step_now_and_then_moves_as_far_as_many_small_ones(tracks):
    """Most of the time a slow marker makes no event, so the middle one of its neighbours does not.

    With thresholds of 0.4, a push of 2 mm in 4 s makes 40 steps a second.
    """
    rng, n_checks, n = np.random.default_rng(2), 2_000, PAPER_GEL.n_markers
    steps = rng.poisson(40.0 * CHECK_S, (n_checks, n))
    for now in steps:
        tracks.steps[:, 0] += now
        places_px = np.column_stack([tracks.state["x"], tracks.state["y"]])
        follow_steps(CHECK_S, places_px, places_px.copy(), tracks, CONFIG.tuning())
    begin_px = Rig((172.5, 129.5), 2.6).to_px(PAPER_GEL.points_mm)
    moved_px = tracks.state["x"] - begin_px[:, 0]
    assert moved_px.mean() == pytest.approx(steps.sum(axis=0).mean() / STEPS_PER_PX, rel=0.03)


def test_fast_markers_are_followed_by_the_places_of_their_events(tracks):
    px_s = 10.0 * SLOW_PX_S
    moved_px = follow(tracks, (STEPS_PER_PX * px_s * CHECK_S, 0.0), 500)
    assert 0.0 < moved_px[:, 0].max() < 0.02 * px_s


def test_in_flickering_light_steps_tell_less_of_what_places_have_shown(tracks):
    """A quick motion stops: its last steps are still in the mean."""
    quick = (STEPS_PER_PX * 60.0 * CHECK_S, 0.0)
    after_px = []
    for event_lag in (0.0, 0.45):
        forget_steps(tracks)
        tracks.common["event_lag"] = event_lag
        follow(tracks, quick, 50, moved_px_s=(60.0, 0.0))
        after_px.append(follow(tracks, (0.0, 0.0), 50)[:, 0])
    steady_px, flickering_px = after_px
    assert steady_px.min() > 0.1
    assert np.allclose(flickering_px, (1.0 - SHOWN) * steady_px, rtol=0.03)


def test_what_fires_beside_one_marker_alone_does_not_move_it(tracks):
    steps = np.zeros((PAPER_GEL.n_markers, 2))
    steps[80] = 0.4, 0.0  # a hot pixel of 200 Hz
    assert np.abs(follow(tracks, steps, 1_000)).max() < 1e-3


@pytest.mark.parametrize("steps_per_px", [40.0, 150.0])
def test_the_steps_of_a_pixel_of_motion_are_learnt(tracks, steps_per_px):
    """Thresholds of 0.4 and 0.1, or paler dots, take another number of events."""
    follow(tracks, (steps_per_px * 40.0 * CHECK_S, 0.0), 200, moved_px_s=(40.0, 0.0))
    forget_steps(tracks)  # but not what was learnt
    moved_px = follow(tracks, (steps_per_px * CHECK_S, 0.0), 1_000)
    assert np.allclose(moved_px, (2.0, 0.0), rtol=0.05)


def test_steps_are_counted_only_where_frames_are_rare(tracks):
    assert needs_steps(1_000_000, tracks)
    tracks.common["placed_us"] = 990_000
    assert not needs_steps(1_000_000, tracks)
    for end_us in range(1_000_000, 1_400_000, 40_000):  # 25 frames/s
        note_frame(end_us, tracks)
        assert not needs_steps(end_us + 50_000, tracks)
    assert needs_steps(end_us + 60_000, tracks)


def test_steps_are_counted_from_frame_to_frame_of_a_slow_camera(tracks):
    for end_us in (1_000_000, 1_250_000, 1_500_000):
        note_frame(end_us, tracks)
    assert needs_steps(1_510_000, tracks)  # a gesture that ends now is not seen for 0.24 s
    note_frame(1_540_000, tracks)
    assert not needs_steps(1_550_000, tracks)


def test_steps_are_counted_where_noise_hides_slow_motion(tracks):
    note_frame(1_000_000, tracks)
    note_frame(1_040_000, tracks)
    tracks.common["noise_hz"] = 300.0  # the whole gel moves
    assert not needs_steps(1_050_000, tracks)
    tracks.common["rest_noise_hz"] = 150.0
    assert needs_steps(1_050_000, tracks)


def test_steps_are_followed_seldom_unless_a_marker_has_made_some(tracks):
    """Following them takes as long as half of a check."""
    assert not is_due(SELDOM_US - 1, 0, tracks)
    assert is_due(SELDOM_US, 0, tracks)
    tracks.steps[80, 1] = -FEW_STEPS
    assert is_due(OFTEN_US, 0, tracks)
    assert not is_due(OFTEN_US - 1, 0, tracks)


@pytest.mark.parametrize("px_s", [0.5, 2.0, 8.0])
def test_a_slow_marker_goes_as_far_whenever_its_steps_are_followed(tracks, px_s):
    begin_px = tracks.state["x"].copy()
    tuning, followed = CONFIG.tuning(), set()
    for t_us in range(2_000, 3_000_000, 2_000):
        tracks.steps[:, 0] += STEPS_PER_PX * px_s * CHECK_S
        check(t_us, tracks, tuning)
        followed.add(int(tracks.common["followed"][0]))
    assert np.allclose(
        tracks.state["x"] - begin_px, 3.0 * px_s / (1 + (px_s / SLOW_PX_S) ** 2), rtol=0.05
    )
    assert len(followed) <= 3_000_000 / OFTEN_US

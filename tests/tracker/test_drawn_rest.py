"""Tracks near rest follow what all events since the last rest show."""

import numpy as np
import pytest

from neurotouch_hid.geometry import PAPER_GEL, Rig
from neurotouch_hid.messages import EVENT_DTYPE, EventPacket, RestField
from neurotouch_hid.tracker import MarkerTracker
from neurotouch_hid.tracker.drawn_rest import DrawnRest

RIG = Rig((172.5, 129.5), 2.5)
REST_PX = RIG.to_px(PAPER_GEL.points_mm)
TOUCHED = np.hypot(*PAPER_GEL.points_mm.T) < 9.0
SIGMA_PX = 1.1
DEPTH = 13.0  # events of a dot that leaves its place
STEP_US = 10_000
N_REST = 80  # slices


def draw(markers_px):
    """How many events brighter than the gel each pixel is."""
    y, x = np.mgrid[:260, :346]
    level = np.zeros((260, 346))
    for cx, cy in markers_px:
        spot = np.exp(-((x - cx) ** 2 + (y - cy) ** 2) / (2 * SIGMA_PX**2))
        level = np.maximum(level, DEPTH * np.log1p(10.0 * spot) / np.log(11.0))
    return level


def make_events(change):
    counts = np.rint(change).astype(int)
    y, x = np.nonzero(counts)
    n = np.abs(counts[y, x])
    events = np.zeros(n.sum(), EVENT_DTYPE)
    events["x"], events["y"] = np.repeat(x, n), np.repeat(y, n)
    events["p"] = np.repeat(counts[y, x] > 0, n)
    return events


@pytest.fixture
def tracker():
    """A tracker at rest, whose camera sends no frames."""
    tracker = MarkerTracker()
    tracker.anchor(RestField(0, REST_PX.astype(np.float32), is_new=True))
    for k in range(N_REST):
        pass_time(tracker, k)
    return tracker


def pass_time(tracker, k):
    """Gives the tracker the slice number ``k``, with one event beside the gel."""
    events = np.zeros(1, EVENT_DTYPE)
    events["t"] = STEP_US * k
    tracker.update(EventPacket(STEP_US * k, STEP_US * (k + 1), events))


def follow(tracker, moved_px, *, shown_at=0.0, is_at_rest=False):
    """Returns how far each track goes when the touched dots have moved without it, px."""
    tracks = tracker._tracks
    drawn = DrawnRest(tracks, PAPER_GEL)
    drawn.begin(STEP_US * N_REST)
    markers_px = REST_PX.copy()
    markers_px[TOUCHED] += moved_px
    tracks.state["x"][TOUCHED] += shown_at
    before_px = np.stack([tracks.state["x"], tracks.state["y"]], axis=1)
    events = make_events(draw(markers_px) - draw(REST_PX))
    for k in range(N_REST, N_REST + 20):
        pass_time(tracker, k)
        t_us = STEP_US * (k + 1)
        drawn.update(events, t_us, tracker._tuning, is_at_rest=is_at_rest)
        events = events[:0]
    return np.stack([tracks.state["x"], tracks.state["y"]], axis=1) - before_px


def test_tracks_go_most_of_the_way_to_the_dots(tracker):
    """The tail of a hole, where a dot was, draws it back by a quarter of a pixel or so."""
    gone_px = follow(tracker, (1.0, -0.5))
    shares = np.median(gone_px[TOUCHED], axis=0) / (1.0, -0.5)
    assert (shares > 0.6).all()
    assert (shares < 1.1).all()
    stayed_px = np.abs(gone_px[~TOUCHED]).max(axis=1)
    assert np.median(stayed_px) < 0.05
    assert stayed_px.max() < 0.3


def test_tracks_far_from_rest_stay(tracker):
    gone_px = follow(tracker, (4.0, 0.0), shown_at=3.0)
    assert not gone_px[TOUCHED].any()


def test_nothing_moves_while_the_gel_is_at_rest(tracker):
    assert not follow(tracker, (1.0, 0.0), is_at_rest=True).any()


def test_a_picture_drawn_from_events_counts_as_no_frame(tracker):
    follow(tracker, (1.0, 0.0))
    assert tracker.is_frameless

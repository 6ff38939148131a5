"""Frames alone carry the tracks: the markers go on at their velocity and stay who they are."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from neurotouch_hid.geometry import PAPER_GEL, Rig, make_gel, place_square
from neurotouch_hid.gesture import GestureConfig, GestureRecognizer
from neurotouch_hid.messages import (
    EVENT_DTYPE,
    EventPacket,
    Frame,
    GelProblem,
    GestureKind,
    RestField,
)
from neurotouch_hid.profile import load_profile
from neurotouch_hid.runtime import Pipeline
from neurotouch_hid.source.simulator import (
    Fingertips,
    Simulator,
    StrokeTiming,
    push,
    sequence,
    twist,
)
from neurotouch_hid.source.simulator.nuisances import read_nuisances
from neurotouch_hid.tracker import MarkerTracker, TrackerConfig
from neurotouch_hid.tracker.blobs import BlobFinder, Blobs
from neurotouch_hid.tracker.config import make_tracks
from neurotouch_hid.tracker.kernels import frames_alone
from neurotouch_hid.tracker.kernels import tracks as track_kernels
from tests.reference import tracker as reference

REST_PX = Rig((172.0, 130.0), 2.5, 0.1).to_px(PAPER_GEL.points_mm)
TUNING = TrackerConfig().tuning()
NEIGHBOURS = PAPER_GEL.neighbours
QUICK = StrokeTiming(165_000, 200_000, 180_000)


@given(st.integers(0, 2**32 - 1), st.floats(0.0, 0.15), st.floats(0.0, 4.0))
@settings(max_examples=20, deadline=None)
def test_pairs_are_those_of_the_plain_twin(seed, hidden, haste_px):
    """A patch is off its expected places; some blobs are hidden, merged or of no marker."""
    rng = np.random.default_rng(seed)
    bell = np.exp(-((PAPER_GEL.points_mm / 9) ** 2).sum(1, keepdims=True))
    way = rng.uniform(-math.pi, math.pi)
    truth = REST_PX + 20 * bell * (math.cos(way), math.sin(way)) + rng.normal(0, 0.1, (177, 2))
    expected = truth - haste_px * bell * (math.cos(way), math.sin(way))
    points = truth[rng.random(177) >= hidden]
    points = np.concatenate([points, rng.uniform(100, 240, (4, 2))])
    areas = np.where(rng.random(len(points)) < 0.04, 14, rng.integers(5, 8, len(points)))
    begin = np.concatenate([[0], np.cumsum(areas)]).astype(np.int32)
    blob, place = np.empty(177, np.int32), np.empty((177, 2))
    frames_alone.pair_blobs(
        expected, points, begin, REST_PX, NEIGHBOURS.copy(), TUNING, blob, place
    )
    twin, twin_place = reference.pair_blobs(
        expected.tolist(), points.tolist(), areas.tolist(), REST_PX.tolist(), NEIGHBOURS.tolist(),
        TUNING,
    )  # fmt: skip
    assert [None if j < 0 else j for j in blob.tolist()] == twin
    np.testing.assert_allclose(place, twin_place, atol=1e-9)
    assert sum(j is not None for j in twin) > 90


def test_a_velocity_is_that_of_the_blobs_and_ripples_fade():
    tracks = make_tracks(NEIGHBOURS, TrackerConfig())
    tracks.rest_px[:] = REST_PX
    track_kernels.place(np.arange(177), REST_PX, 1.0, 0.0, tracks, TUNING)
    begin = np.arange(0, 6 * 178, 6, dtype=np.int32)
    rng = np.random.default_rng(1)
    for k in range(1, 30):
        noise = rng.normal(0, 0.05, (177, 2)) if k < 10 else np.zeros((177, 2))
        at = REST_PX + noise
        at[:, 0] += 2.0 * k
        n = frames_alone.follow(8_000 * k, 8_000 * k + 2_000, at, begin, tracks, TUNING)
        assert n == 177
    state = tracks.state
    np.testing.assert_allclose(state["vx"], 250.0, atol=0.5)
    np.testing.assert_allclose(state["vy"], 0.0, atol=0.5)
    np.testing.assert_allclose(state["x"], at[:, 0])


def test_a_hidden_marker_of_a_still_gel_does_not_drift_away():
    """Noise has given it a velocity of a pixel from frame to frame before it was hidden."""
    tracks = make_tracks(NEIGHBOURS, TrackerConfig())
    tracks.rest_px[:] = REST_PX
    track_kernels.place(np.arange(177), REST_PX, 1.0, 0.0, tracks, TUNING)
    hidden = 88
    tracks.state["vx"][hidden] = 60.0
    shown = np.delete(REST_PX, hidden, axis=0)
    begin = np.arange(0, 6 * 177, 6, dtype=np.int32)
    for k in range(1, 8):
        frames_alone.follow(16_500 * k, 16_500 * k + 4_000, shown, begin, tracks, TUNING)
    assert tracks.lost.nonzero()[0].tolist() == [hidden]
    assert abs(tracks.state["x"][hidden] - REST_PX[hidden, 0]) < 0.3


def test_a_dot_that_goes_alone_is_noise_but_a_finger_moves_several():
    """A speck joins a dot's blob; later a finger goes a pixel, and all dots under it with it."""
    tracks = make_tracks(NEIGHBOURS, TrackerConfig())
    tracks.rest_px[:] = REST_PX
    track_kernels.place(np.arange(177), REST_PX, 1.0, 0.0, tracks, TUNING)
    begin = np.arange(0, 6 * 178, 6, dtype=np.int32)
    middle = int(np.hypot(*PAPER_GEL.points_mm.T).argmin())
    shown = REST_PX.copy()
    shown[middle, 0] += 1.2
    frames_alone.follow(16_500, 18_000, shown, begin, tracks, TUNING)
    assert 0.0 < tracks.state["x"][middle] - REST_PX[middle, 0] < 0.4
    finger = np.exp(-((PAPER_GEL.points_mm / 9) ** 2).sum(1))
    for k in range(2, 6):
        shown = REST_PX.copy()
        shown[:, 0] += 0.9 * (k - 1) * finger
        frames_alone.follow(16_500 * k, 16_500 * k + 1_500, shown, begin, tracks, TUNING)
    np.testing.assert_allclose(tracks.state["x"], shown[:, 0], atol=0.1)


def test_a_speck_beside_a_hidden_marker_does_not_pass_for_it():
    """A dot at the rim runs together with the border; a faint dot is as small as the speck."""
    tracks = make_tracks(NEIGHBOURS, TrackerConfig())
    tracks.rest_px[:] = REST_PX
    track_kernels.place(np.arange(177), REST_PX, 1.0, 0.0, tracks, TUNING)
    rng, area = np.random.default_rng(3), np.full(177, 12)
    rim = int(np.hypot(*(PAPER_GEL.points_mm - (8.0, -28.0)).T).argmin())
    faint = int(np.hypot(*PAPER_GEL.points_mm.T).argmin())
    area[[rim, faint]] = 2
    begin = np.concatenate([[0], area.cumsum()]).astype(np.int32)
    for k in range(1, 40):
        shown = REST_PX + rng.normal(0.0, 0.1, REST_PX.shape)
        shown[rim] += (0.9, 0.4)
        frames_alone.follow(16_500 * k, 16_500 * k + 1_500, shown, begin, tracks, TUNING)
        off_px = np.column_stack([tracks.state["x"], tracks.state["y"]]) - REST_PX
        assert np.hypot(*off_px[[rim, faint]].T).max() < 0.3
    finger = np.exp(-((PAPER_GEL.points_mm / 9) ** 2).sum(1))
    for k in range(1, 6):
        shown = REST_PX.copy()
        shown[:, 0] += 1.5 * k * finger
        t_us = 16_500 * (40 + k)
        frames_alone.follow(t_us, t_us + 1_500, shown, begin, tracks, TUNING)
    assert tracks.state["x"][faint] == pytest.approx(shown[faint, 0], abs=0.1)


class Shown:
    """Stands in for the search of blobs, which the pixels of this test would only slow down."""

    def find(self, _pixels):
        return self.blobs


@pytest.mark.parametrize("fps", [60, 125])
def test_noise_of_single_dots_is_no_gesture(fps):
    """Three dots of a hundred are off by more than noise, others each time, between frames too."""
    rng, shown = np.random.default_rng(1), Shown()
    tracker, recognizer = MarkerTracker(finder=shown), GestureRecognizer()
    tracker.anchor(RestField(0, REST_PX.astype(np.float32), is_new=True))
    begin, t_us, seen = np.arange(0, 12 * 178, 12, dtype=np.int32), 0, 0
    for k in range(1, 15 * fps):
        frame_us = k * 1_000_000 // fps
        odd = rng.random((177, 1)) < 0.03
        places_px = REST_PX + rng.normal(0, 0.15, (177, 2)) + odd * rng.normal(0, 0.8, (177, 2))
        shown.blobs = Blobs(places_px, begin, np.zeros(0, np.int32))
        frame = Frame(np.full((1, 1), k % 251, np.uint8), frame_us - 4_000, frame_us)
        for end_us, frames in ((frame_us - 6_000, ()), (frame_us + 1, (frame,))):
            packet = EventPacket(t_us, end_us, np.empty(0, EVENT_DTYPE), frames)
            seen += recognizer.update(tracker.update(packet)).kind is not GestureKind.NONE
            t_us = end_us
    assert not seen


AWAY_PX = np.hypot(*(2.5 * PAPER_GEL.points_mm.T))
DRAG = 2.0 / math.pi * np.arcsin(16.0 / np.maximum(AWAY_PX, 16.0))
"""How far each marker goes with a finger on the middle, which goes 1 [Mindlin]."""


def drag(ways_px):
    """Returns a tracker after a finger has gone these ways, one in each frame, and the dots."""
    shown = Shown()
    tracker = MarkerTracker(finder=shown)
    tracker.anchor(RestField(0, REST_PX.astype(np.float32), is_new=True))
    for k, way_px in enumerate(ways_px):
        places_px = REST_PX + np.column_stack([way_px * DRAG, 0.0 * DRAG])
        shown.blobs = Blobs(places_px, np.arange(0, 2136, 12, np.int32), np.zeros(0, np.int32))
        t_us = 16_000 * (k + 1)
        frame = Frame(np.full((1, 1), k, np.uint8), t_us - 4_000, t_us)
        tracker.update(EventPacket(t_us - 16_000, t_us, np.empty(0, EVENT_DTYPE), (frame,)))
    return tracker, places_px


def coast(ways_px, after_us):
    """Returns where a finger's own dot is told to be some time after the last of these frames."""
    tracker, _ = drag(ways_px)
    end_us = 16_000 * len(ways_px)
    packet = EventPacket(end_us, end_us + after_us, np.empty(0, EVENT_DTYPE))
    middle = int(AWAY_PX.argmin())
    return float(tracker.update(packet).position_px[middle, 0] - REST_PX[middle, 0])


def test_a_gel_that_comes_back_does_not_go_beyond_rest():
    """What is left halves from frame to frame; a quick hand then lets go at once."""
    back = 16.0 * 0.5 ** np.arange(8)
    left = [coast((0.0, 8.0, 16.0, *back[:k]), 8_000) / back[k - 1] for k in range(4, 8)]
    assert min(left) > 0.6  # the truth is 0.65; the velocity alone gives 0.53
    assert coast((0.0, 8.0, 16.0, 9.0, 0.5), 8_000) >= 0.0


def count_mistaken(tracker, places_px):
    state = tracker._tracks.state
    return int((np.hypot(*(np.column_stack([state["x"], state["y"]]) - places_px).T) > 5.0).sum())


@pytest.mark.parametrize("jerk_px", [10.0, 14.0])
def test_markers_are_told_apart_after_a_jerk(jerk_px):
    """The finger goes farther than the pitch from one frame to the next, in a way it has begun."""
    ways_px = (0.0, 0.0, 3.0, 3.0 + jerk_px, 3.0 + jerk_px)
    tracker, places_px = drag(ways_px)
    assert count_mistaken(tracker, places_px) == 0
    assert not tracker.is_unsure


def test_a_jerk_that_nothing_explains_is_a_hand_too_fast_until_it_has_stopped():
    """Every third dot under the finger is hidden where it arrives, so that no motion is certain."""
    tracker, _ = drag((0.0, 0.0, 3.0))
    shown = tracker._finder
    places_px = REST_PX + np.column_stack([25.0 * DRAG, 9.0 * DRAG])
    rng = np.random.default_rng(4)
    places_px[AWAY_PX < 30.0] += rng.uniform(-6, 6, ((AWAY_PX < 30.0).sum(), 2))
    unsure = []
    for k in range(4, 20):  # 0.25 s
        t_us = 16_000 * k
        shown.blobs = Blobs(places_px, np.arange(0, 2136, 12, np.int32), np.zeros(0, np.int32))
        frame = Frame(np.full((1, 1), k, np.uint8), t_us - 4_000, t_us)
        tracker.update(EventPacket(t_us - 16_000, t_us, np.empty(0, EVENT_DTYPE), (frame,)))
        unsure.append(tracker.is_unsure)
    assert all(unsure[:5])
    assert not unsure[-1]


def test_a_picture_without_the_gel_changes_nothing():
    tracks = make_tracks(NEIGHBOURS, TrackerConfig())
    tracks.rest_px[:] = REST_PX
    track_kernels.place(np.arange(177), REST_PX, 1.0, 0.0, tracks, TUNING)
    before = tracks.state.copy()
    few = REST_PX[:40].copy()
    begin = np.arange(0, 6 * 41, 6, dtype=np.int32)
    assert frames_alone.follow(8_000, 10_000, few, begin, tracks, TUNING) == 0
    np.testing.assert_array_equal(tracks.state, before)


def play(script, *nuisances):
    """Returns the steps of a script, and the true markers and gesture at the end of each."""
    simulator = Simulator(script, nuisances=read_nuisances(nuisances), seed=2)
    pipeline = Pipeline.build(load_profile("spacecraft"), GestureConfig())
    return [(pipeline.advance(packet), simulator.truth(packet.t_end_us)) for packet in simulator]


FAST = sequence("fast", *(push(way, 18.0, timing=QUICK) for way in (math.pi, 0.4, 1.9)))


@pytest.mark.parametrize("fps", [125, 60])
def test_fast_strokes_are_followed(fps):
    """The quickest stroke of the paper: 18 mm at 210 mm/s; half the pitch is 5 px."""
    played = [p for p in play(FAST, f"uvc={fps}") if np.isfinite(p[0].markers.rest_px).all()]
    touched = [(s, t) for s, t in played if t.kind is GestureKind.PUSH]
    error_mm = np.mean([abs(s.gesture.intensity_mm - t.intensity_mm) for s, t in touched])
    count = np.mean([len(s.gesture.contacts_mm) == len(t.contacts_px) for s, t in played])
    assert error_mm < 1.0
    assert count > 0.95
    held = [(s, t) for s, t in touched if t.intensity_mm > 16.0]
    off_px = [np.hypot(*(s.markers.position_px - t.markers_px).T) for s, t in held]
    assert len(held) > 30
    assert (np.array(off_px) > 5.0).mean() < 0.01  # nobody is taken for a neighbour


def test_a_frame_that_comes_twice_does_not_stop_the_markers():
    errors = []
    for more in ((), ("doubled=30",)):
        played = play(sequence("push", push(0.0, 9.0)), "uvc=125", *more)
        played = [p for p in played if np.isfinite(p[0].markers.rest_px).all()]
        off = [np.hypot(*(s.markers.position_px - t.markers_px).T).max() for s, t in played]
        errors.append(np.percentile(off, 95))
    assert errors[1] < errors[0] + 1.0


def test_a_hand_too_fast_for_the_camera_leaves_the_pad_neutral_and_is_told():
    played = play(FAST, "uvc=30")
    unsure = [s for s, t in played if t.intensity_mm > 8.0 and s.gesture.kind is GestureKind.NONE]
    assert unsure
    assert all(step.pad.is_neutral for step in unsure[3:])
    assert GelProblem.TOO_FAST in {step.gel.problem for step, _ in played}
    slow = play(sequence("slow", push(0.0, 9.0)), "uvc=30")
    assert GelProblem.TOO_FAST not in {step.gel.problem for step, _ in slow}


def test_a_hand_that_holds_still_after_a_jerk_is_no_longer_too_fast():
    """Twice the paper's speed: some markers stay at a neighbour's place, but not the gesture."""
    jerk = StrokeTiming(83_000, 500_000, 150_000)
    played = play(sequence("jerk", push(-1.75, 18.0, (2.0, 9.0), jerk)), "uvc=60")
    held = [(s, t) for s, t in played if t.intensity_mm > 16.5]
    late = [(s, t) for s, t in held if s.packet.t_end_us > held[0][0].packet.t_end_us + 200_000]
    assert GelProblem.TOO_FAST in {step.gel.problem for step, _ in held}
    assert len(late) > 10
    assert all(s.gesture.kind is GestureKind.PUSH for s, _ in late)


def test_events_take_over_from_frames_alone():
    """A camera whose events come late is followed by both, one after the other."""
    simulator = Simulator(sequence("two", push(0.0, 9.0), push(2.0, 9.0)), seed=3)
    pipeline = Pipeline.build(load_profile("spacecraft"), GestureConfig())
    for packet in simulator:
        silent = packet.t_end_us < 1_000_000
        step = pipeline.advance(
            replace(packet, events=np.empty(0, EVENT_DTYPE)) if silent else packet
        )
        truth = simulator.truth(packet.t_end_us).markers_px
        if packet.t_end_us > 1_500_000:
            off = np.hypot(*(step.markers.position_px - truth).T)
            assert np.median(off) < 0.5


def test_a_slow_twist_that_hides_dots_is_no_haste():
    """Three fingers that turn far squeeze dots together, which a frame then shows as one."""
    hand = Fingertips(n_fingers=3, spread_mm=12.0)
    script = sequence("twist", twist(0.9, hand, StrokeTiming(700_000, 400_000, 700_000)))
    played = play(script, "uvc=125")
    held = [s for s, t in played if t.intensity_mm > 8.0]
    assert held
    assert {s.gesture.kind for s in held} == {GestureKind.TWIST_CW}


SMALL = make_gel("small", place_square(2.0, 15.0), pitch_mm=2.0, radius_mm=15.0, dot_mm=0.5)
"""Half of the paper's gel. A webcam's picture is scaled, so its dots are 10 px apart, too."""


def draw_dots(places_px):
    """A frame's pixels with a dot at each place."""
    y, x = np.mgrid[:260, :346]
    pixels = np.full(x.shape, 20.0)
    for u, v in places_px:
        a, b = slice(int(v) - 5, int(v) + 6), slice(int(u) - 5, int(u) + 6)
        pixels[a, b] += 180.0 * np.exp(-((x[a, b] - u) ** 2 + (y[a, b] - v) ** 2) / 2.0)
    return np.clip(pixels, 0, 255).astype(np.uint8)


@pytest.mark.parametrize(("way_px", "is_unsure"), [(4.0, False), (6.5, True)])
def test_half_of_the_pitch_is_that_of_the_gel(way_px, is_unsure):
    rest_px = SMALL.points_mm * 5.0 + (173.0, 130.0)
    tracker = MarkerTracker(gel=SMALL)
    tracker.anchor(RestField(0, rest_px.astype(np.float32), is_new=True))
    hidden = np.hypot(*SMALL.points_mm.T) < 5.0
    moved_px = rest_px.copy()
    for k in range(8):
        moved_px[:, 0] += min(2.0 * k, way_px)
        seen_px = moved_px[~hidden] if k > 5 else moved_px
        begin_us = 8_000 * k
        frame = Frame(draw_dots(seen_px), begin_us, begin_us + 4_000)
        tracker.update(EventPacket(begin_us, begin_us + 8_000, np.empty(0, EVENT_DTYPE), (frame,)))
    assert tracker.is_unsure == is_unsure


def squeeze(places_px, n_pairs):
    """Returns places where pairs of dots in a column in the middle have run together."""
    squeezed_px = places_px.copy()
    rows = np.flatnonzero(np.abs(SMALL.points_mm[:, 0]) < 0.1)
    rows = rows[np.argsort(np.abs(SMALL.points_mm[rows, 1]))][:n_pairs]
    for i in rows:
        j = int(np.hypot(*(SMALL.points_mm - SMALL.points_mm[i] - (2.0, 0.0)).T).argmin())
        squeezed_px[[i, j]] = places_px[[i, j]].mean(axis=0)
        squeezed_px[i, 0] -= 1.5
        squeezed_px[j, 0] += 1.5
    return squeezed_px


@pytest.mark.parametrize("n_hidden", [0, 1])
def test_dots_that_run_together_are_no_haste_and_end_it(n_hidden):
    """Many dots disappear while the gel goes fast, all at once or first into each other.

    Args:
        n_hidden: frames in which some dots are not seen for no reason.
    """
    rest_px = SMALL.points_mm * 5.0 + (173.0, 130.0)
    tracker = MarkerTracker(gel=SMALL)
    tracker.anchor(RestField(0, rest_px.astype(np.float32), is_new=True))
    hidden = np.hypot(*SMALL.points_mm.T) < 5.0
    moved_px, unsure = rest_px.copy(), []
    for k, way_px in enumerate((0.0, 2.0, 4.0, 6.0, 6.5, 6.5, 6.5, 4.0, 2.0, 0.0, 0.0, 0.0)):
        moved_px[:, 0] += way_px
        is_hidden = 6 <= k < 6 + n_hidden
        seen_px = moved_px[~hidden] if is_hidden else squeeze(moved_px, 6 if k > 5 else 0)
        begin_us = 8_000 * k
        frame = Frame(draw_dots(seen_px), begin_us, begin_us + 4_000)
        tracker.update(EventPacket(begin_us, begin_us + 8_000, np.empty(0, EVENT_DTYPE), (frame,)))
        unsure.append(tracker.is_unsure)
    assert any(unsure) == bool(n_hidden)
    assert not unsure[-1]


def test_dots_are_found_finely_until_an_event_comes():
    """With events, frames only correct, and the time for it is not spent."""
    finder = BlobFinder()
    tracker = MarkerTracker(finder=finder)
    tracker.update(EventPacket(0, 10_000, np.empty(0, EVENT_DTYPE)))
    assert finder.is_fine
    event = np.array([(12_000, 5, 5, True)], EVENT_DTYPE)
    tracker.update(EventPacket(10_000, 20_000, event))
    tracker.update(EventPacket(20_000, 30_000, np.empty(0, EVENT_DTYPE)))
    assert not finder.is_fine

"""All markers, followed through simulated gestures, noise, gaps and mistakes."""

from dataclasses import replace

import numpy as np
import pytest

from neurotouch_hid.geometry import PAPER_GEL, Rig
from neurotouch_hid.messages import EVENT_DTYPE, EventPacket, GestureKind, RestField
from neurotouch_hid.source.simulator import Simulator, SimulatorConfig
from neurotouch_hid.source.simulator.config import SensorConfig
from neurotouch_hid.source.simulator.optics import CameraConfig
from neurotouch_hid.source.simulator.script import Finger, Stroke, sequence
from neurotouch_hid.tracker import BlobFinder, MarkerTracker, RestDetector, TrackerConfig
from neurotouch_hid.tracker.kernels import tracks as track_kernels

REST_PX = Rig((172.0, 130.0), 2.5).to_px(PAPER_GEL.points_mm).astype(np.float32)


def stroke(*fingers, kind=GestureKind.PUSH, move_us=250_000, hold_us=150_000):
    return Stroke(kind, fingers, attack_us=move_us, hold_us=hold_us, release_us=move_us)


def twist(turn_rad, radius_mm=12.0):
    around = [(radius_mm * np.cos(a), radius_mm * np.sin(a)) for a in (0.3, 2.4, 4.5)]
    return stroke(*(Finger(c, turn_rad=turn_rad) for c in around), kind=GestureKind.TWIST_CW)


def play(*strokes, shot_hz=1.0, rig=None, seed=1, nuisances=None):
    """Returns packets of a script, and the true markers at the end of each."""
    config = SimulatorConfig(
        camera=CameraConfig(rig=rig or Rig((172.5, 129.5), 2.5)),
        sensor=SensorConfig(shot_hz=shot_hz),
    )
    script = sequence("test", *strokes, rest_us=150_000)
    simulator = Simulator(script, config, nuisances=nuisances, seed=seed)
    packets, truth = [], []
    for packet in simulator:
        packets.append(packet)
        truth.append(simulator.truth(packet.t_end_us).markers_px)
    return packets, np.array(truth)


def follow(packets, tracker=None, *, frames=True, detector=None):
    """Returns the fields of a pipeline: rest detection, then the tracker."""
    tracker, detector = tracker or MarkerTracker(), detector or RestDetector()
    fields = []
    for packet in packets:
        for frame in packet.frames:
            rest = detector.update(frame)
            if rest is not None and (frames or not tracker.stats().n_anchors):
                tracker.anchor(rest)
        fields.append(tracker.update(packet if frames else replace(packet, frames=())))
    return fields


def errors(fields, truth):
    """Returns (slices, 177) px, NaN before the anchor."""
    return np.hypot(*(np.array([f.position_px for f in fields]) - truth).transpose(2, 0, 1))


@pytest.fixture(scope="module")
def gestures():
    return play(
        stroke(Finger((2.0, 3.0), (6.0, -5.0))),
        twist(0.6),
        stroke(Finger((-9.0, 0.0), (5.0, 0.0)), Finger((9.0, 0.0), (-5.0, 0.0))),
        shot_hz=5.0,
        rig=Rig((176.0, 126.0), 2.4, 0.2),
    )


def test_a_search_by_tiles_equals_a_search_of_all(gestures):
    packets, _ = gestures
    listed, plain = (
        follow(packets, MarkerTracker(TrackerConfig(search=search))) for search in ("tiles", "all")
    )
    for a, b in zip(listed, plain, strict=True):
        np.testing.assert_array_equal(a.position_px, b.position_px)
        np.testing.assert_array_equal(a.valid, b.valid)


def test_one_finder_for_both_changes_nothing(gestures):
    packets, _ = gestures
    finder = BlobFinder()
    shared = follow(packets, MarkerTracker(finder=finder), detector=RestDetector(finder=finder))
    for a, b in zip(shared, follow(packets), strict=True):
        np.testing.assert_array_equal(a.position_px, b.position_px)


def test_no_marker_is_lost_in_noise(gestures):
    packets, truth = gestures
    fields = follow(packets)
    error = errors(fields, truth)[10:]
    assert np.median(error) < 0.4
    assert (error > 3.0).mean() < 0.002
    assert (error[-1] < 1.0).all()
    assert np.mean([f.valid for f in fields[10:]]) > 0.98


def test_without_frames_markers_drift_but_stay(gestures):
    packets, truth = (part[:200] for part in gestures)
    error = errors(follow(packets, frames=False), truth)[10:]
    assert np.median(error) < 0.6
    assert (error > 3.0).mean() < 0.002


@pytest.mark.parametrize("late", [1, 4, 9])
def test_a_rest_position_may_come_late(gestures, late):
    packets, truth = gestures
    tracker, detector, mail, fields = MarkerTracker(), RestDetector(), {}, []
    for k, p in enumerate(packets[:150]):
        mail[k + late] = [r for r in map(detector.update, p.frames) if r is not None]
        for rest in mail.pop(k, []):
            tracker.anchor(rest)
        fields.append(tracker.update(p))
    error = errors(fields, truth[:150])[25:]
    assert np.median(error) < 0.4
    assert (error > 3.0).mean() < 0.002


def test_a_fast_long_push_is_followed():
    # Minimum jerk: 17 mm in 150 ms is 210 mm/s, the fastest of the paper.
    fast = stroke(Finger((-6.0, 1.0), (16.5, 4.0)), move_us=152_000)
    packets, truth = play(fast)
    speed = np.hypot(*np.diff(truth, axis=0).transpose(2, 0, 1)).max() / 0.01
    assert speed > 480.0
    fields = follow(packets)
    error = errors(fields, truth)[10:]
    assert np.median(error) < 0.4
    assert (error[-1] < 2.0).all()
    assert (error > 3.0).mean() < 0.01


def test_quick_taps_are_followed_out_and_back():
    # 5 mm out and back in 60 ms: 310 mm/s, and no moment of rest where they turn.
    taps = [Finger((4.0, 2.0), (-4.7, -1.7)), Finger((-6.0, -3.0), (4.5, -2.2))]
    packets, truth = play(*(stroke(tap, move_us=30_000, hold_us=0) for tap in taps))
    fields = follow(packets)
    error = errors(fields, truth)[10:]
    assert (error > 4.0).mean() < 2e-4
    assert all(field.valid.all() for field in fields[10:])


def test_a_replay_is_the_same_bit_for_bit(gestures):
    packets, _ = gestures
    for one, other in zip(follow(packets[:60]), follow(packets[:60]), strict=True):
        assert np.array_equal(one.position_px, other.position_px, equal_nan=True)
        assert np.array_equal(one.valid, other.valid)


def merge(packets, n):
    for k in range(0, len(packets), n):
        part = packets[k : k + n]
        events = np.concatenate([p.events for p in part])
        frames = tuple(f for p in part for f in p.frames)
        yield EventPacket(part[0].t_begin_us, part[-1].t_end_us, events, frames)


def test_long_slices_end_where_short_ones_do(gestures):
    packets, truth = gestures
    rest = RestField(0, truth[0])
    short, long = MarkerTracker(), MarkerTracker()
    short.anchor(rest)
    long.anchor(rest)
    fine = [short.update(p) for p in packets[:120]][9::10]
    coarse = [long.update(p) for p in merge(packets[:120], 10)]
    for one, other in zip(fine, coarse, strict=True):
        assert np.array_equal(one.position_px, other.position_px)
        assert np.array_equal(one.valid, other.valid)


def packet(k, events=(), gap=0):
    return EventPacket(k * 10_000, (k + 1) * 10_000, np.array([*events], EVENT_DTYPE), gap=gap)


def test_nothing_is_known_before_the_anchor():
    tracker = MarkerTracker()
    field = tracker.update(packet(0))
    assert field.t_us == 10_000
    assert np.isnan(field.rest_px).all()
    assert np.isnan(field.position_px).all()
    assert not field.valid.any()
    tracker.anchor(RestField(5_000, REST_PX))
    field = tracker.update(packet(1))
    assert field.valid.all()
    np.testing.assert_allclose(field.position_px, REST_PX, atol=1e-4)
    assert tracker.stats().n_gaps == 0


def test_a_field_is_not_changed_by_the_next_one():
    tracker = MarkerTracker()
    tracker.anchor(RestField(0, REST_PX))
    one = tracker.update(packet(0))
    before = one.position_px.copy(), one.valid.copy()
    x, y = np.rint(REST_PX[80]).astype(int)
    tracker.update(packet(1, [(11_000 + 10 * k, x + 2, y, True) for k in range(100)]))
    assert np.array_equal(one.position_px, before[0])
    assert np.array_equal(one.valid, before[1])


def test_events_that_cannot_be_written_are_read():
    tracker = MarkerTracker()
    tracker.anchor(RestField(0, REST_PX))
    x, y = np.rint(REST_PX[80]).astype(int)
    slice_ = packet(0, [(1_000 + 10 * k, x + 2, y, True) for k in range(100)])
    slice_.events.setflags(write=False)
    assert tracker.update(slice_).position_px[80, 0] > REST_PX[80, 0] + 0.5


@pytest.mark.parametrize("lost", ["gap", "jump", "backwards"])
def test_missing_events_end_all_motion(lost):
    tracker = MarkerTracker()
    tracker.anchor(RestField(0, REST_PX))
    x, y = np.rint(REST_PX[80]).astype(int)
    run = [(100 * k, x + int(0.05 * k), y, k % 2 == 0) for k in range(100)]
    moving = tracker.update(packet(0, run))
    k, gap = {"gap": (1, 500), "jump": (90, 0), "backwards": (0, 0)}[lost]
    still = tracker.update(packet(k, gap=gap))
    assert moving.position_px[80, 0] > REST_PX[80, 0] + 2.0
    assert np.abs(still.position_px - moving.position_px).max() < 1.0
    assert tracker.update(packet(k + 1)).position_px[80, 0] == still.position_px[80, 0]
    assert tracker.stats().n_gaps == 1


def test_after_a_long_gap_markers_are_unknown_until_the_next_anchor():
    tracker = MarkerTracker()
    tracker.anchor(RestField(0, REST_PX))
    assert tracker.update(packet(0)).valid.all()
    assert not tracker.update(packet(50, gap=1)).valid.any()
    assert not tracker.update(packet(51)).valid.any()
    moved_px = REST_PX + np.float32(5.0)  # the camera is elsewhere afterwards
    tracker.anchor(RestField(512_000, moved_px))
    field = tracker.update(packet(52))
    assert field.valid.all()
    np.testing.assert_allclose(field.position_px, moved_px, atol=1e-4)
    np.testing.assert_allclose(field.rest_px, moved_px, atol=1e-4)


def test_the_rest_position_stays_one_object_while_it_hardly_moves():
    tracker = MarkerTracker()
    tracker.anchor(RestField(0, REST_PX))
    first = tracker.update(packet(0)).rest_px
    for k in range(1, 50):
        tracker.anchor(RestField(k * 40_000, REST_PX + np.float32(0.08)))
        assert tracker.update(packet(k)).rest_px is first
    for k in range(50, 125):
        tracker.anchor(RestField(k * 40_000, REST_PX + np.float32(0.3)))
        last = tracker.update(packet(k)).rest_px
    assert last is not first
    np.testing.assert_allclose(last, REST_PX + 0.3, atol=0.11)


def test_after_a_bump_the_place_of_each_marker_is_learnt_again():
    """Other pixels show the dots now, and the rig still swings by 0.3 px about its new place."""
    own_px = np.random.default_rng(1).normal(0, 0.12, REST_PX.shape).astype(np.float32)
    tracker = MarkerTracker()
    for k in range(20):
        tracker.anchor(RestField(k * 40_000, REST_PX))
        tracker.update(packet(k))
    for k in range(20, 40):
        swing_px = np.float32(5.0 + 0.3 * (-1) ** k)
        tracker.anchor(RestField(k * 40_000, REST_PX + own_px + swing_px))
        rest_px = tracker.update(packet(k)).rest_px
    off_px = rest_px - (REST_PX + own_px + 5.0)
    assert np.abs(off_px.mean(axis=0)).max() < 0.1
    assert off_px.std() < 0.06


@pytest.mark.parametrize("px", [0.25, 0.6, 1.5])
def test_a_soft_touch_that_looks_like_rest_is_not_absorbed(px):
    touched = REST_PX.copy()
    touched[80:92, 0] += px
    tracker = MarkerTracker()
    tracker.anchor(RestField(0, REST_PX))
    for k in range(1, 750):  # 30 s
        tracker.anchor(RestField(k * 40_000, touched))
        field = tracker.update(packet(k))
    assert np.abs(field.rest_px - REST_PX).max() < max(0.15 * px, 0.1)
    for k in range(750, 900):
        tracker.anchor(RestField(k * 40_000, REST_PX))
        field = tracker.update(packet(k))
    assert np.abs(field.rest_px - REST_PX).max() < 0.15


def test_the_rest_position_is_the_mean_of_the_first_noisy_frames():
    rng, tracker = np.random.default_rng(4), MarkerTracker()
    for k in range(16):
        noise_px = rng.normal(0, 0.3, REST_PX.shape).astype(np.float32)
        tracker.anchor(RestField(k * 40_000, REST_PX + noise_px))
        field = tracker.update(packet(k))
    assert np.std(field.rest_px - REST_PX) < 0.12


def test_a_quick_push_is_followed_out_of_focus():
    push = stroke(Finger((2.0, 3.0), (6.0, -5.0)), move_us=120_000)
    packets, truth = play(push, nuisances={"blur": 2.5})
    fields = follow(packets)
    moved = np.hypot(*(truth - truth[0]).transpose(2, 0, 1)) > 4.0
    error = errors(fields, truth)[moved]
    assert (error > 3.0).mean() < 0.15
    assert np.median(error) < 0.6


@pytest.mark.parametrize("side", [0, 1])
def test_half_of_the_markers_hidden_costs_that_half_only(gestures, side):
    packets, truth = gestures
    tracker = MarkerTracker()
    tracker.anchor(RestField(0, truth[0]))
    hidden = (truth[0][:, 0] < 176) == (side == 0)

    def hide(p):
        events = p.events[(p.events["x"] >= 176) == (side == 0)]
        frames = []
        for frame in p.frames:
            pixels = frame.pixels.copy()
            pixels[:, slice(176) if side == 0 else slice(176, None)] = 10
            frames.append(replace(frame, pixels=pixels))
        return replace(p, events=events, frames=tuple(frames))

    fields = [tracker.update(hide(p)) for p in packets[:60]]
    error = errors(fields, truth[:60])[-1]
    inner = np.abs(truth[59][:, 0] - 176) > 10
    assert fields[-1].valid[hidden & inner].mean() < 0.05
    assert fields[-1].valid[~hidden & inner].mean() > 0.95
    assert np.median(error[~hidden]) < 0.4
    fields = [tracker.update(p) for p in packets[60:200]]
    assert fields[-1].valid.all()
    assert (errors(fields, truth[60:200])[-1] < 1.0).all()


def test_a_bumped_camera_moves_the_rest_position_at_once():
    tracker = MarkerTracker()
    tracker.anchor(RestField(0, REST_PX))
    tracker.update(packet(0))
    tracker.anchor(RestField(9_000, REST_PX + np.float32(6.0)))
    field = tracker.update(packet(1))
    np.testing.assert_allclose(field.rest_px, REST_PX + 6.0, atol=1e-4)
    np.testing.assert_allclose(field.position_px, REST_PX + 6.0, atol=0.01)


@pytest.mark.parametrize("ahead_us", [1_000, 9_000, 12_000])
def test_a_frame_at_rest_corrects_tracks_although_its_slice_is_not_yet_followed(ahead_us):
    tracker = MarkerTracker()
    tracker.anchor(RestField(0, REST_PX))
    for k in range(5):
        end_us = tracker.update(packet(k, [(10_000 * k, 3, 3, True)])).t_us
    tracker._tracks.state["x"][40] += 1.0  # a speck beside the dot has moved it
    tracker._tracks.past_px[:, 40, 0] += 1.0
    tracker.anchor(RestField(end_us + ahead_us, REST_PX))
    field = tracker.update(packet(5))
    np.testing.assert_allclose(field.position_px[40], REST_PX[40], atol=0.05)


def test_the_rest_position_follows_a_rig_that_turns():
    centre_px, tracker = REST_PX.mean(axis=0), MarkerTracker()
    for k in range(250):  # 10 s, 0.5 degrees
        turn = np.radians(0.002 * k)
        by_px = turn * (REST_PX - centre_px)[:, ::-1] * (-1, 1)
        tracker.anchor(RestField(k * 40_000, (REST_PX + by_px).astype(np.float32)))
        rest_px = tracker.update(packet(k)).rest_px
    assert np.abs(rest_px - (REST_PX + by_px)).max() < 0.15


@pytest.mark.parametrize("bump_px", [0.0, 5.0])
def test_the_rest_position_follows_a_rig_that_creeps_or_was_bumped(bump_px):
    print_px = REST_PX + np.random.default_rng(1).normal(0, 0.3, REST_PX.shape).astype(np.float32)
    tracker = MarkerTracker()
    tracker.anchor(RestField(0, print_px))
    for k in range(1, 75):  # 3 s; 0.5 px/s are 3 mm in 15 s
        place_px = print_px + np.float32(0.02 * k + (bump_px if k > 30 else 0.0))
        tracker.anchor(RestField(k * 40_000, place_px))
        field = tracker.update(packet(k))
        assert np.abs(field.rest_px - place_px).max() < 0.6


def test_a_bump_does_not_forget_the_places_of_single_markers():
    tracker = MarkerTracker()
    tracker.anchor(RestField(0, REST_PX))
    touched = REST_PX + np.float32(4.0)
    touched[80:92, 0] += 0.6  # a soft touch, just when the rig is found elsewhere
    tracker.anchor(RestField(40_000, touched))
    rest_px = tracker.update(packet(0)).rest_px
    np.testing.assert_allclose(rest_px, REST_PX + 4.0, atol=0.1)


def swap(tracker, i, j):
    """Swaps two tracks, as crossing markers would."""
    state = tracker._tracks.state
    for name in ("x", "y"):
        state[name][[i, j]] = state[name][[j, i]]
    for k in (i, j):
        tracker._tracks.past_px[:, k] = state["x"][k], state["y"][k]


def test_swapped_markers_are_corrected_at_the_next_rest(gestures):
    packets, truth = gestures
    tracker, detector = MarkerTracker(), RestDetector()
    follow(packets[:10], tracker, detector=detector)
    swap(tracker, 88, 89)
    fields = follow(packets[10:20], tracker, detector=detector)
    assert (errors(fields, truth[10:20])[-1] < 1.0).all()
    assert fields[-1].valid.all()
    assert fields[0].position_px.shape == (PAPER_GEL.n_markers, 2)


def test_a_frame_does_not_correct_a_repaired_marker_twice(gestures):
    """Tracks that lagged behind a knock once jumped across their places with each frame."""
    packets, truth = gestures
    tracker, detector = MarkerTracker(), RestDetector()
    follow(packets[:10], tracker, detector=detector)
    tracks, lagging = tracker._tracks, np.arange(0, 177, 8)
    track_kernels.shift(tracks, lagging, np.full((len(lagging), 2), 1.6))
    fields = follow(packets[10:20], tracker, detector=detector)
    frame = next(k for k, p in enumerate(packets[10:20]) if p.frames)
    assert (errors(fields, truth[10:20])[frame:] < 1.0).all()


def test_a_marker_that_is_not_seen_is_not_valid(gestures):
    packets, truth = gestures
    tracker = MarkerTracker()
    tracker.anchor(RestField(0, truth[0]))
    x, y = np.rint(truth[0][20]).astype(int)
    for p in packets[:14]:
        dirty = []
        for frame in p.frames:
            pixels = frame.pixels.copy()
            pixels[y - 4 : y + 5, x - 4 : x + 5] = pixels.min()
            dirty.append(replace(frame, pixels=pixels))
        field = tracker.update(replace(p, frames=tuple(dirty)))
    assert np.flatnonzero(~field.valid).tolist() == [20]


@pytest.mark.parametrize("level", [0, 255])
def test_a_frame_that_shows_nothing_changes_nothing(gestures, level):
    packets, truth = gestures
    blank = np.full((260, 346), level, np.uint8)
    one, other = MarkerTracker(), MarkerTracker()
    for tracker in (one, other):
        tracker.anchor(RestField(0, truth[0]))
    for p in packets[:40]:
        frames = tuple(replace(frame, pixels=blank) for frame in p.frames)
        with_frames = one.update(replace(p, frames=frames))
        without = other.update(replace(p, frames=()))
    assert np.array_equal(with_frames.position_px, without.position_px)
    assert with_frames.valid.all()


def test_the_shadow_of_a_hand_moves_no_marker():
    script = sequence("test", stroke(Finger((0.0, 0.0), drag_mm=(5.0, 0.0))), rest_us=480_000)
    simulator = Simulator(script, nuisances={"shadow": 40.0}, seed=3)
    packets, truth = [], []
    for packet in simulator:
        if packet.t_end_us > 470_000:  # the finger touches next
            break
        packets.append(packet)
        truth.append(simulator.truth(packet.t_end_us).markers_px)
    light = [int(packet.events["p"].sum()) / max(len(packet.events), 1) for packet in packets]
    assert min(light) < 0.1  # the shadow passes: nearly all pixels darken
    error = errors(follow(packets), np.array(truth))[5:]  # found by then
    assert np.percentile(error, 99, axis=1).max() < 0.6  # between frames it was 2.5

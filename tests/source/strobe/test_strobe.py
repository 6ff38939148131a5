"""A camera without frames whose LED ring goes off at regular times: simulated."""

import logging
from dataclasses import replace

import numpy as np
import pytest

from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.messages import EVENT_DTYPE, EventPacket, GestureKind
from neurotouch_hid.profile import load_profile
from neurotouch_hid.runtime import Pipeline
from neurotouch_hid.source import open_source
from neurotouch_hid.source.replay import Replay
from neurotouch_hid.source.simulator import Simulator
from neurotouch_hid.source.simulator.dataset import write_dataset
from neurotouch_hid.source.simulator.script import Finger, Stroke, sequence
from neurotouch_hid.source.strobe.config import StrobeConfig
from neurotouch_hid.source.strobe.decoder import Strobe
from neurotouch_hid.tracker import BlobFinder

START_US = 500_000
PERIOD_US = 50_000


def simulate(script=None, **nuisances):
    script = script or sequence("rest", rest_us=START_US)
    return Simulator(script, nuisances={"strobe": 1.5, **nuisances}, seed=3)


@pytest.fixture(scope="module")
def rest():
    """Half a second of a gel that nobody touches, and its markers."""
    simulator = simulate()
    return list(simulator), simulator.truth(0).markers_px


def find_dots(frame, markers_px):
    """Returns how far each marker is from the nearest dot of a frame, px."""
    dots_px = BlobFinder().find(frame.pixels).centroid_px
    return np.hypot(*(markers_px[:, None] - dots_px).transpose(2, 0, 1)).min(axis=1)


def take_frames(packets, config=None):
    strobe = Strobe(config or StrobeConfig())
    return [frame for packet in packets for frame in strobe.take(packet).frames]


def test_each_dip_shows_all_dots_where_they_are(rest):
    packets, markers_px = rest
    frames = take_frames(packets)
    assert len(frames) >= 7
    for frame in frames:
        off_px = find_dots(frame, markers_px)
        assert (off_px < 1.5).all()
        assert off_px.mean() < 0.25


@pytest.mark.parametrize(
    "nuisances",
    [{}, {"pale": 3.0}, {"noise": 15.0}, {"mismatch": 0.08}, {"threshold": 0.4}, {"sun": 15.0}],
    ids=str,
)
def test_the_gel_is_found_within_half_a_second_and_no_touch(nuisances):
    pipeline, strobe = Pipeline.build(load_profile("default"), GestureConfig()), None
    strobe = Strobe(StrobeConfig())
    steps = [pipeline.advance(strobe.take(packet)) for packet in simulate(**nuisances)]
    assert steps[-1].gel.is_found
    assert all(step.gesture.kind is GestureKind.NONE for step in steps)


def test_what_dips_make_never_reaches_the_tracker_and_all_else_does(rest):
    packets, _ = rest
    strobe = Strobe(StrobeConfig())
    taken = [strobe.take(packet) for packet in packets]
    before, after = (np.concatenate([p.events for p in some[15:]]) for some in (packets, taken))
    phase_us = before["t"] % PERIOD_US
    clear = (phase_us > 9_000) & (phase_us < PERIOD_US - 1_000)
    dark = (phase_us > 300) & (phase_us < 8_000)
    assert dark.sum() > 5_000
    assert not np.isin(before[dark]["t"], after["t"]).any()
    kept_us = after["t"] % PERIOD_US
    kept = after[(kept_us > 9_000) & (kept_us < PERIOD_US - 1_000)]
    assert kept.tolist() == before[clear].tolist()


@pytest.mark.parametrize("slice_us", [4_000, 10_000, 48_000])
def test_slices_of_any_length_give_the_same_frames(rest, slice_us):
    events = np.concatenate([packet.events for packet in rest[0]])
    edges = np.arange(0, START_US + 1, slice_us)
    cuts = np.searchsorted(events["t"], edges)
    packets = [
        EventPacket(int(a), int(b), events[i:j])
        for a, b, i, j in zip(edges, edges[1:], cuts, cuts[1:], strict=False)
    ]
    usual, others = take_frames(rest[0]), take_frames(packets)
    assert len(others) >= 6
    by_time = {frame.t_us: frame.pixels for frame in usual}
    same = [np.array_equal(f.pixels, by_time[f.t_us]) for f in others if f.t_us in by_time]
    assert len(same) >= 5
    assert all(same)


@pytest.mark.parametrize("hz", [19.6, 20.4])
def test_the_ring_may_have_another_clock(rest, hz):
    frames = take_frames(rest[0], StrobeConfig(hz=hz))
    assert len(frames) >= 6
    assert find_dots(frames[-1], rest[1]).mean() < 0.25


def test_a_dip_that_got_lost_is_no_frame_and_the_next_ones_are(rest):
    packets = [
        replace(packet, events=packet.events[:0])
        if 250_000 <= packet.t_begin_us < 260_000
        else packet
        for packet in rest[0]
    ]
    strobe = Strobe(StrobeConfig())
    frames = [frame for packet in packets for frame in strobe.take(packet).frames]
    assert strobe.n_missed == 1
    assert len(frames) == len(take_frames(rest[0])) - 1
    assert frames[-1].t_us > 450_000


def test_motion_is_no_dip():
    finger = Finger((2.0, 3.0), (12.0, -5.0), press_mm=1.0)
    strokes = [Stroke(GestureKind.PUSH, (finger,), attack_us=60_000, hold_us=100_000)] * 3
    simulator = Simulator(sequence("fast", *strokes, rest_us=100_000, gap_us=100_000), seed=2)
    strobe = Strobe(StrobeConfig())
    for packet in simulator:
        taken = strobe.take(replace(packet, frames=()))
        assert not taken.frames
        assert taken.events.tolist() == packet.events.tolist()


def test_a_ring_that_stays_on_is_said_once(caplog):
    strobe = Strobe(StrobeConfig())
    with caplog.at_level(logging.WARNING):
        for k in range(600):
            strobe.take(EventPacket(10_000 * k, 10_000 * (k + 1), np.empty(0, EVENT_DTYPE)))
    assert [record.message for record in caplog.records] == [
        "camera.yaml says that the LED ring goes off 20 times a second, but the camera does not "
        "see it. The frequency may be another, or the ring stays on."
    ]


def test_strobed_play_has_no_drift_and_no_false_gesture():
    finger = Finger((2.0, 3.0), (6.0, -5.0), press_mm=1.0)
    stroke = Stroke(GestureKind.PUSH, (finger,))
    simulator = simulate(
        sequence("pushes", stroke, stroke, stroke, rest_us=START_US, gap_us=400_000)
    )
    rest_px, pushed, seen = simulator.truth(0).markers_px, [], []
    pipeline, strobe = (
        Pipeline.build(load_profile("default"), GestureConfig()),
        Strobe(StrobeConfig()),
    )
    for packet in simulator:
        step = pipeline.advance(strobe.take(packet))
        truth = simulator.truth(packet.t_end_us)
        moved_px = np.hypot(*(truth.markers_px - rest_px).T).max()
        if packet.t_end_us > START_US and (moved_px > 4.0 or moved_px < 0.25):
            pushed.append(moved_px > 4.0)
            seen.append(step.gesture.kind is GestureKind.PUSH)
    pushed, seen = np.array(pushed), np.array(seen)
    assert pushed.sum() > 50
    assert seen[pushed].mean() > 0.95
    assert not seen[~pushed].any()
    off_px = np.hypot(*(step.markers.position_px - truth.markers_px).T)
    assert off_px.mean() < 0.4
    assert off_px.max() < 1.5


def test_a_strobed_scene_and_its_recording_have_frames(tmp_path):
    with open_source("sim:random,strobe", speed="max") as source:
        n = [len(packet.frames) for _, packet in zip(range(30), source, strict=False)]
    assert sum(n) >= 3
    path, *_ = write_dataset(tmp_path, 1, 0.1, nuisances={"strobe": 1.0})
    assert path.with_suffix(".rig.yaml").read_text() == "strobe: {hz: 20, dark_us: 1000}\n"
    frames = [f for _, packet in zip(range(50), Replay(path), strict=False) for f in packet.frames]
    assert len(frames) >= 7
    assert len(BlobFinder().find(frames[0].pixels).centroid_px) > 150

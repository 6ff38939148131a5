"""A live line: frames are taken in after the pad was written, and seldom while nothing happens."""

from dataclasses import replace

import numpy as np
import pytest

from neurotouch_hid.evaluation.speed.workload import load_scene
from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.messages import GamepadState, GelProblem
from neurotouch_hid.profile import load_profile
from neurotouch_hid.runtime import Pipeline
from neurotouch_hid.runtime.pipeline import IDLE_FRAME_US, IDLE_US
from neurotouch_hid.source.partial import cut_partial
from neurotouch_hid.source.simulator import Simulator
from neurotouch_hid.source.simulator.script import Finger, sequence
from tests.tracker.test_markers import stroke
from tests.waiting import wait_until


@pytest.fixture
def lines():
    """A live one and one for recordings."""
    both = [
        Pipeline.build(load_profile("default"), GestureConfig(), frame_thread=it)
        for it in (True, False)
    ]
    yield both
    for line in both:
        line.close()


def play_live(line, packet):
    """A slice with all the time that a look at its frame takes."""
    step = line.advance(packet)
    looked_us = line._looked_us
    line.finish(step)
    if line._looked_us != looked_us:
        wait_until(lambda: line.rest._results)
    return step


def test_frames_that_wait_for_the_pad_tell_the_same(push, lines):
    live, usual = lines
    apart_px, same = [], []
    for packet in push.packets:
        late, now = play_live(live, packet), usual.advance(packet)
        if packet.t_end_us > 300_000:
            off = late.markers.position_px - now.markers.position_px
            apart_px.append(np.hypot(*off.T))
            same.append(late.gesture.kind is now.gesture.kind)
        assert not (live.is_idle and late.gesture.kind)
    assert np.max(apart_px) < 1.0
    assert np.median(apart_px) < 0.1
    assert np.mean(same) > 0.98
    assert live.tracker.stats().n_anchors > 5


@pytest.mark.parametrize(("nuisances", "told"), [({"mains": 60.0}, (True, 0)), ({}, (False, 1))])
def test_looking_for_flicker_and_hot_pixels_waits_for_the_pad(lines, nuisances, told):
    """It takes up to a millisecond, now and then."""
    live, usual = lines
    for packet in Simulator(sequence("rest", rest_us=1_300_000), nuisances=nuisances, seed=8):
        usual.advance(add_hot_pixel(packet))
        known = find_known(live)
        step = live.advance(add_hot_pixel(packet))
        assert find_known(live) == known
        live.finish(step)
    assert find_known(live) == find_known(usual) == told


def find_known(line):
    """Whether the light flickers, and how many pixels are hot."""
    return line.tracker.flicker is not None, line.tracker._hot._n_hot


def add_hot_pixel(packet):
    hot = packet.events[:0].copy()
    hot.resize(10)
    hot["t"] = np.linspace(packet.t_begin_us, packet.t_end_us - 1, 10)
    hot["x"], hot["y"] = 5, 5
    events = np.concatenate([packet.events, hot])
    return replace(packet, events=events[np.argsort(events["t"], kind="stable")])


def test_without_a_profile_the_gestures_are_the_same_and_the_pad_is_neutral(push):
    mapped, alone = (
        Pipeline.build(load_profile("default"), GestureConfig(), frame_thread=False)
        for _ in range(2)
    )
    pads = []
    for packet in push.packets:
        usual, step = mapped.advance(packet), alone.recognize(packet)
        assert step.gesture.kind is usual.gesture.kind
        assert step.gesture.intensity_mm == usual.gesture.intensity_mm
        np.testing.assert_array_equal(step.markers.position_px, usual.markers.position_px)
        assert step.pad == GamepadState(usual.pad.t_us)
        pads.append(usual.pad.is_neutral)
    assert not all(pads)


def test_a_slice_whose_head_was_taken_in_before_tells_the_same(push):
    plain, early = (
        Pipeline.build(load_profile("default"), GestureConfig(), frame_thread=True)
        for _ in range(2)
    )
    apart_px, same = [], []
    for packet in push.packets:
        early.advance_partial(cut_partial(packet))
        now, then = play_live(plain, packet), play_live(early, packet)
        assert then.packet is packet
        if packet.t_end_us > 300_000:
            apart_px.append(np.abs(then.markers.position_px - now.markers.position_px).max())
            same.append(then.gesture.kind is now.gesture.kind)
    assert np.max(apart_px) < 0.01
    assert np.mean(same) > 0.98
    assert early.tracker.stats().n_gaps == plain.tracker.stats().n_gaps == 0
    assert early.tracker.stats().n_events == plain.tracker.stats().n_events
    plain.close()
    early.close()


def test_a_head_whose_slice_never_came_is_a_gap(push):
    line = Pipeline.build(load_profile("default"), GestureConfig())
    for packet in push.packets[:20]:
        line.advance(packet)
    line.has_frame_thread = True
    line.advance_partial(cut_partial(push.packets[20]))
    line.advance(push.packets[21])
    assert line.tracker.stats().n_gaps == 1
    line.advance_partial(cut_partial(push.packets[22]))
    line.advance(replace(push.packets[22], gap=7))  # lost after the head
    assert line.tracker.stats().n_gaps == 2
    line.close()


def test_an_idle_line_looks_at_a_frame_now_and_then(lines):
    live = lines[0]
    n_frames, idle_since_us = 0, None
    for packet in load_scene("rest", 10_000, 2_500_000).packets:
        if idle_since_us is None and live.is_idle:
            idle_since_us, n_frames = packet.t_begin_us, live.rest.detector.stats().n_frames
        play_live(live, packet)
    assert idle_since_us == pytest.approx(IDLE_US, abs=20_000)
    looked = live.rest.detector.stats().n_frames - n_frames
    assert looked == pytest.approx((2_500_000 - idle_since_us) / IDLE_FRAME_US, abs=2)


@pytest.mark.parametrize(
    ("nuisances", "may_skip"), [({}, True), ({"mains": 60.0}, False), ({"uvc": 60.0}, False)]
)
def test_frames_are_seldom_only_in_steady_light_and_beside_events(lines, nuisances, may_skip):
    live = lines[0]
    still = sequence("still", stroke(Finger((2.0, 3.0), (4.0, -2.0))), rest_us=900_000)
    for packet in Simulator(still, nuisances=nuisances, seed=8):
        if packet.t_end_us > 900_000:
            break
        play_live(live, packet)
    assert live.is_idle
    assert live.is_at_rest is may_skip


def test_a_stroke_after_an_idle_time_is_seen_whole_by_frames_alone(lines):
    live = lines[0]
    push_5_mm = sequence("x", stroke(Finger((2.0, 3.0), (5.0, 0.0))), rest_us=1_500_000)
    largest_mm = 0.0
    for packet in Simulator(push_5_mm, nuisances={"uvc": 60.0}, seed=8):
        largest_mm = max(largest_mm, play_live(live, packet).gesture.intensity_mm)
    assert largest_mm == pytest.approx(5.0, abs=0.6)


def test_frames_alone_are_in_their_own_step_and_wait_for_no_thread(lines):
    """A step that waits for the frame thread is one or two frames late."""
    live, usual = lines
    push_9_mm = sequence("x", stroke(Finger((2.0, 3.0), (9.0, 0.0))), rest_us=600_000)
    apart_px, same = [], []
    for packet in Simulator(push_9_mm, nuisances={"uvc": 60.0}, seed=8):
        now, then = play_live(live, packet), usual.advance(packet)
        if packet.t_end_us > 700_000:
            apart_px.append(np.abs(then.markers.position_px - now.markers.position_px).max())
            same.append(then.gesture.kind is now.gesture.kind)
    assert len(same) > 100
    assert np.percentile(apart_px, 95) < 0.2
    assert np.mean(same) > 0.98


@pytest.mark.parametrize("live", [True, False])
def test_without_events_a_dot_is_seen_to_go_a_part_of_a_pixel(lines, live):
    """The middle of the pixels above a threshold jumps; all dots at rest are found as finely."""
    line = lines[not live]
    slow = sequence("x", stroke(Finger((2.0, 3.0), (0.6, 0.0)), move_us=800_000), rest_us=600_000)
    simulator, off_px = Simulator(slow, nuisances={"uvc": 125.0}, seed=8), []
    start_px = simulator.truth(0).markers_px
    for packet in simulator:
        step = play_live(line, packet) if live else line.advance(packet)
        way_px = simulator.truth(packet.t_end_us).markers_px - start_px
        moves = (np.hypot(*way_px.T) > 0.5) & (packet.t_end_us > 600_000)
        off_px.append((step.markers.position_px - step.markers.rest_px - way_px)[moves])
    off_px = np.concatenate(off_px)
    assert len(off_px) > 200
    assert np.median(np.abs(off_px)) < 0.05


def test_the_gel_says_that_the_light_flickers_as_long_as_it_does(lines):
    _, line = lines
    still = sequence("still", stroke(Finger((2.0, 3.0), (4.0, -2.0))), rest_us=2_200_000)
    flickering, steady = (Simulator(still, nuisances=n, seed=8) for n in ({"mains": 60.0}, {}))
    problems, hz = [], []
    for lit, unlit in zip(flickering, steady, strict=False):
        if lit.t_end_us > 2_200_000:
            break
        step = line.advance(lit if lit.t_end_us <= 600_000 else unlit)
        problems.append(step.gel.problem)
        hz.append(step.gel.flicker_hz)
    assert problems[59] is GelProblem.FLICKER
    assert hz[59] == pytest.approx(100.0, abs=2.0)
    assert problems[-1] is GelProblem.NONE
    assert hz[-1] is None

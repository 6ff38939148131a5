"""The gel found in events alone, and drawn from them."""

from dataclasses import replace

import numpy as np
import pytest

from neurotouch_hid.geometry import PAPER_GEL
from neurotouch_hid.messages import EVENT_DTYPE, EventPacket, Frame, GelProblem
from neurotouch_hid.source.simulator import Simulator, SimulatorConfig
from neurotouch_hid.source.simulator.config import GelConfig, SensorConfig
from neurotouch_hid.source.simulator.script import Finger, Stroke, sequence
from neurotouch_hid.tracker import MarkerTracker, RestDetector
from neurotouch_hid.tracker.event_camera import count_lost, find_lead
from neurotouch_hid.tracker.faint_spots import find_faint_spots
from tests.tracker.test_markers import stroke


@pytest.fixture(scope="module", params=["half-space", "solid"])
def touch(request):
    """Returns packets of two fast pushes of 8 mm, without frames, and the true markers."""
    first = stroke(Finger((2.0, 3.0), (6.0, -5.0)), move_us=150_000)
    second: Stroke = stroke(Finger((-4.0, 0.0), (7.0, 3.0)))
    config = SimulatorConfig(
        gel=GelConfig(elasticity=request.param), sensor=SensorConfig(shot_hz=1.0)
    )
    script = sequence("test", first, second, rest_us=200_000, gap_us=700_000)
    simulator = Simulator(script, config, seed=4)
    packets = [replace(packet, frames=()) for packet in simulator]
    return packets, np.array([simulator.truth(p.t_end_us).markers_px for p in packets])


def play(packets, detector, tracker):
    """Yields the markers at the end of each packet, and the frame drawn from events."""
    for packet in packets:
        drawn = detector.watch(packet)
        if drawn is not None:
            if drawn.rest is not None:
                tracker.anchor(drawn.rest)
            tracker.correct(drawn.frame, drawn.blobs)
        yield tracker.update(packet), drawn


def measure_errors(field, truth):
    return np.hypot(*(field.position_px - truth).T)


def test_the_first_push_shows_the_gel_and_the_second_one_is_followed(touch):
    packets, truth = touch
    detector, tracker = RestDetector(), MarkerTracker()
    moved_px = np.hypot(*(truth - truth[0]).transpose(2, 0, 1)).max(axis=1)
    begins = np.flatnonzero((moved_px[1:] > 1.0) & (moved_px[:-1] <= 1.0))
    assert len(begins) == 2
    errors = []
    for k, (field, _) in enumerate(play(packets, detector, tracker)):
        if k == begins[1]:
            assert detector.gel.is_found
            first_px = measure_errors(field, truth[k])
            assert np.median(first_px) < 0.6
            assert first_px.max() < 3.0
        if k >= begins[1]:
            errors.append(measure_errors(field, truth[k]))
    errors = np.array(errors)
    assert np.median(errors) < 0.6
    assert (errors > 3.0).mean() < 0.01
    last_px = errors[-1]
    assert np.median(last_px) < 0.5
    assert last_px.max() < 2.0
    assert detector.gel.problem is GelProblem.EVENTS_ONLY


def test_each_touch_makes_the_places_more_certain(touch):
    packets, truth = touch
    fields = [
        drawn.rest
        for _, drawn in play(packets, RestDetector(), MarkerTracker())
        if drawn is not None and drawn.rest is not None and drawn.rest.is_new
    ]
    first_px, last_px = (measure_errors(field, truth[0]) for field in (fields[0], fields[-1]))
    assert len(fields) >= 2
    assert np.quantile(last_px, 0.9) < np.quantile(first_px, 0.9)


def test_a_hold_is_not_taken_for_rest(touch):
    packets, truth = touch
    moved_px = np.hypot(*(truth - truth[0]).transpose(2, 0, 1)).max(axis=1)
    for k, (_, drawn) in enumerate(play(packets, RestDetector(), MarkerTracker())):
        if drawn is not None and drawn.rest is not None:
            assert moved_px[k - 1] < 1.5


def test_a_frame_of_the_camera_takes_over(touch):
    packets, _ = touch
    detector = RestDetector()
    for packet in packets:
        detector.watch(packet)
    assert detector.gel.is_found
    t_us = packets[-1].t_end_us
    assert detector.update(Frame(np.full((260, 346), 20, np.uint8), t_us, t_us + 10_000)) is None
    assert not detector.is_watching
    assert detector.watch(packets[-1]) is None


def test_it_asks_for_a_touch_as_long_as_nothing_moves(touch):
    packets, _ = touch
    detector = RestDetector()
    assert all(detector.watch(packet) is None for packet in packets[:15])
    assert detector.stats().problem is GelProblem.NO_FRAMES
    assert detector.stats().n_references == 0


def test_noise_is_no_gel():
    rng = np.random.default_rng(0)
    detector = RestDetector()
    for k in range(20):
        events = np.zeros(20_000, EVENT_DTYPE)
        events["t"] = np.sort(rng.integers(k * 10_000, (k + 1) * 10_000, 20_000))
        events["x"], events["y"] = rng.integers(0, 346, 20_000), rng.integers(0, 260, 20_000)
        events["p"] = rng.random(20_000) < 0.5
        assert detector.watch(EventPacket(k * 10_000, (k + 1) * 10_000, events)) is None


@pytest.mark.parametrize("moved_px", [0.3, 1.0, 2.0, 4.0, 9.0])
def test_the_lead_is_that_of_two_spots(moved_px):
    x = np.linspace(-20.0, 30.0, 5001)
    sigma_px = 1.2
    before, after = (np.exp(-0.5 * ((x - at) / sigma_px) ** 2) for at in (0.0, moved_px))
    change = after - before
    dark, bright = (
        (x * part).sum() / part.sum() for part in (np.maximum(-change, 0), np.maximum(change, 0))
    )
    assert find_lead(bright - dark, sigma_px) == pytest.approx(-dark, abs=0.03)


def test_one_light_push_shows_the_gel():
    light = stroke(Finger((3.0, -4.0), (1.2, 0.9), press_mm=1.0), move_us=200_000)
    simulator = Simulator(sequence("test", light, rest_us=200_000, gap_us=200_000), seed=6)
    detector = RestDetector()
    for packet in simulator:
        drawn = detector.watch(replace(packet, frames=()))
        if drawn is not None and drawn.rest is not None:
            break
    assert detector.gel.is_found
    assert packet.t_end_us - 200_000 < 2_000_000  # from the touch on
    off_px = np.hypot(*(drawn.rest.position_px - simulator.truth(0).markers_px).T)
    assert np.median(off_px) < 1.0
    assert off_px.max() < 3.0  # no marker is taken for its neighbour


def test_markers_around_a_finger_alone_do_not_tell_which_they_are():
    far_mm = np.hypot(*PAPER_GEL.points_mm.T)
    assert count_lost(PAPER_GEL, far_mm < 0.8 * PAPER_GEL.radius_mm) == 0
    to_the_rim = (far_mm < 0.8 * PAPER_GEL.radius_mm) | (PAPER_GEL.points_mm[:, 0] > 0.0)
    assert count_lost(PAPER_GEL, to_the_rim) == 0  # they may all belong farther left
    assert count_lost(PAPER_GEL, np.ones(PAPER_GEL.n_markers, np.bool_)) > 10


def test_dots_that_have_moved_a_little_are_found_between_their_sides():
    rng = np.random.default_rng(2)
    y, x = np.mgrid[:260, :346]
    places_px = np.array([(60.3, 80.6), (75.0, 92.2), (200.7, 150.1)])
    change = rng.normal(0.0, 0.3, x.shape)
    for at_x, at_y in places_px:
        ahead, behind = (
            np.exp(-0.5 * (((x - at_x - by) ** 2 + (y - at_y) ** 2) / 1.2**2))
            for by in (0.15, -0.15)
        )
        change += 12.0 * (ahead - behind)
    change = change.astype(np.float32)
    found_px = find_faint_spots(change, np.empty((0, 2)))
    assert len(found_px) == len(places_px)
    assert np.hypot(*(found_px - places_px[np.argsort(places_px[:, 1])]).T).max() < 0.6
    assert len(find_faint_spots(change, places_px[:1])) == len(places_px) - 1

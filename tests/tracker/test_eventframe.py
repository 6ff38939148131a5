"""The gel found in events alone."""

from dataclasses import replace

import numpy as np
import pytest

from neurotouch_hid.messages import EVENT_DTYPE, EventPacket, GelProblem
from neurotouch_hid.source.simulator import Simulator, SimulatorConfig
from neurotouch_hid.source.simulator.config import SensorConfig
from neurotouch_hid.source.simulator.script import Finger, Stroke, sequence
from neurotouch_hid.tracker import MarkerTracker, RestDetector
from tests.tracker.test_markers import stroke


@pytest.fixture(scope="module")
def touch():
    """Returns packets of a light touch and a push, without frames, and the true markers."""
    light = stroke(Finger((2.0, 3.0), (2.0, -1.5), press_mm=1.0), move_us=300_000)
    firm: Stroke = stroke(Finger((-4.0, 0.0), (6.0, 2.0)))
    config = SimulatorConfig(sensor=SensorConfig(shot_hz=1.0))
    simulator = Simulator(sequence("test", light, firm, rest_us=200_000), config, seed=4)
    packets = [replace(packet, frames=()) for packet in simulator]
    return packets, np.array([simulator.truth(p.t_end_us).markers_px for p in packets])


def test_the_first_touch_shows_the_gel(touch):
    packets, truth = touch
    detector, tracker, fields = RestDetector(), MarkerTracker(), []
    for packet in packets:
        rest = detector.watch(packet)
        if rest is not None:
            tracker.anchor(rest)
            error = np.hypot(*(rest.position_px - truth[0]).T)
            assert np.median(error) < 0.6
            assert error.max() < 3.0
        fields.append(tracker.update(packet))
    assert tracker.stats().n_anchors == 1
    assert detector.stats().n_references == 1
    assert detector.stats().problem is GelProblem.EVENTS_ONLY
    error = np.hypot(*(fields[-1].position_px - truth[-1]).T)
    assert np.median(error) < 1.0
    assert (error > 3.0).mean() < 0.02


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

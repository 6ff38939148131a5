"""Light that flickers is found, named and kept from the tracks."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from neurotouch_hid.messages import EVENT_DTYPE
from neurotouch_hid.source.simulator import Simulator
from neurotouch_hid.source.simulator.hand_model import GuidedHand, HandCommand
from neurotouch_hid.source.simulator.nuisances import light
from neurotouch_hid.source.simulator.script import Finger, sequence
from neurotouch_hid.tracker import MarkerTracker
from neurotouch_hid.tracker.flicker import LEAST_WIDTH, FlickerFilter, make_pixels
from neurotouch_hid.tracker.kernels import flicker as kernels
from tests.tracker.test_markers import errors, follow, stroke

PUSH = stroke(Finger((2.0, 3.0), (4.0, -2.0)))


def play(duration_us, rest_us, nuisances):
    """Returns packets of a push after a rest, and the true markers at the end of each."""
    simulator = Simulator(sequence("test", PUSH, rest_us=rest_us), nuisances=nuisances, seed=8)
    packets, truth = [], []
    for packet in simulator:
        packets.append(packet)
        truth.append(simulator.truth(packet.t_end_us).markers_px)
        if packet.t_end_us >= duration_us:
            break
    return packets, np.array(truth)


def look(packets):
    """Returns what is known about flicker after some packets."""
    tracker = MarkerTracker()
    for packet in packets:
        tracker.update(packet)
    return tracker.flicker


@pytest.mark.parametrize(
    ("hz", "nuisances"),
    [
        (100.0, {"mains": 60.0}),
        (120.0, {"mains": 60.0}),
        (100.0, {"mains-leak": 15.0}),
        (200.0, {"pwm": 30.0}),
    ],
)
def test_flicker_has_its_frequency(monkeypatch, hz, nuisances):
    if "pwm" not in nuisances:
        monkeypatch.setattr(light, "MAINS_HZ", hz)
    packets, _ = play(150_000, 400_000, nuisances)
    found = look(packets)
    assert found is not None
    assert found.hz == pytest.approx(hz, abs=2.0)
    n_events = sum(len(packet.events) for packet in packets) / 0.15
    assert found.share > 0.4
    assert 0.4 * n_events < found.events_hz < 1.1 * n_events


def test_a_hand_that_moves_does_not_change_the_frequency():
    """What a motion leaves of low frequencies is not that of the light."""
    weak = {"mains": 5.0, "mains-leak": 1.0, "fan": 0.03}
    flicker, seen = FlickerFilter(), []
    for packet in play(1_200_000, 300_000, weak)[0]:
        flicker.update(packet.events, packet.t_begin_us, packet.t_end_us)
        seen += [] if flicker.flicker is None else [flicker.flicker.hz]
    assert len(seen) > 50
    assert np.abs(np.array(seen) - 100.0).max() < 3.0


@pytest.mark.parametrize("nuisances", [{}, {"music": 0.2}, {"noise": 15.0}, {"readout": 80.0}])
def test_motion_vibration_noise_and_readout_are_no_flicker(nuisances):
    packets, _ = play(400_000, 50_000, nuisances)
    assert all(look(packets[:n]) is None for n in (4, 8, 16, 30, 40))


def thin(packets, share):
    """Returns packets of a sensor that makes only a share of the OFF events, as many do."""
    rng = np.random.default_rng(5)
    left = [packet.events["p"] | (rng.random(len(packet.events)) < share) for packet in packets]
    return [
        replace(packet, events=packet.events[keep])
        for packet, keep in zip(packets, left, strict=True)
    ]


@pytest.mark.parametrize("nuisances", [{"music": 0.5}, {"fan": 0.3}])
def test_vibration_is_no_flicker_where_one_polarity_is_weaker(nuisances):
    """Shaken at 55 and 24 Hz: both polarities still have their rhythm at the same time."""
    packets = thin(play(900_000, 300_000, nuisances)[0], 0.5)
    assert [look(packets[:n]) for n in range(30, 90, 6)] == [None] * 10


def test_flicker_is_found_where_one_polarity_is_weaker():
    found = look(thin(play(150_000, 400_000, {"mains": 60.0})[0], 0.5))
    assert found is not None
    assert found.hz == pytest.approx(100.0, abs=2.0)


def test_a_hand_that_stops_and_goes_on_is_no_flicker():
    """As the mouse gel's does, between two commands of its page."""
    commands = (
        HandCommand(down=True, push_x_mm=4.0 * math.sin(0.025 * k)) if k % 5 == 0 else None
        for k in itertools.count()
    )
    hand = GuidedHand(lambda: next(commands), lambda _command, _t_us: None)
    tracker = MarkerTracker()
    for packet in Simulator(hand, seed=3):
        tracker.update(packet)
        assert tracker.flicker is None
        if packet.t_end_us >= 3_000_000:
            break


def test_flicker_may_begin_and_end():
    flickering, _ = play(100_000, 400_000, {"mains": 60.0})
    steady, _ = play(250_000, 400_000, {})
    tracker, end_us, seen = MarkerTracker(), 0, []
    for packet in 3 * steady + 13 * flickering + 7 * steady:
        events = packet.events.copy()
        events["t"] += end_us - packet.t_begin_us
        tracker.update(replace(packet, t_begin_us=end_us, t_end_us=end_us + 10_000, events=events))
        end_us += 10_000
        seen.append(tracker.flicker is not None)
    assert not any(seen[:75])
    assert all(seen[190:205])
    assert not any(seen[-20:])


@pytest.mark.parametrize("nuisances", [{"mains-leak": 15.0}, {"pwm": 30.0}])
def test_flicker_does_not_move_the_gel(nuisances):
    packets, truth = play(550_000, 300_000, nuisances)
    error = errors(follow(packets), truth)
    still = error[15:30]
    assert np.median(still) < 0.1
    assert np.percentile(still, 98) < 0.45
    pushed = error[30:]
    assert np.median(pushed) < 0.4
    assert (pushed > 2.0).mean() < 0.02


QUIET = [True, True, False, False] * 50


def burst(pixel, polarities, t_us, step_us):
    events = np.zeros(len(polarities), EVENT_DTYPE)
    events["t"] = t_us + step_us * np.arange(len(polarities))
    events["x"], events["y"], events["p"] = *pixel, polarities
    return events


@pytest.mark.parametrize(("up", "down"), [(1, 1), (3, 3), (4, 3), (3, 5), (9, 9)])
def test_a_pixel_that_flickers_still_shows_a_change(up, down):
    pixels = make_pixels()
    cycle = [True] * up + [False] * down
    steady = burst((17, 40), cycle * 240, 5_000, 10_000 // len(cycle))
    out = np.empty(len(steady), EVENT_DTYPE)
    kernels.remove_flicker(steady[: len(steady) // 2], pixels, 0.0, out)
    n_left = kernels.remove_flicker(steady[len(steady) // 2 :], pixels, 0.0, out)
    assert n_left <= 2 + 0.01 * len(steady)
    brighter = burst((17, 40), [True] * (up + 8), steady["t"][-1] + 100, 500)
    n_left = kernels.remove_flicker(brighter, pixels, 0.0, out)
    assert 6 <= n_left <= 9
    assert out["p"][:n_left].all()


@pytest.mark.parametrize("more", [2, 4, 6])
def test_a_pixel_brightens_and_darkens_alike_and_then_rests(more):
    left = {}
    for way in (True, False):
        pixels, t_us, left[way] = make_pixels(), 5_000, []
        moving = [True] * (2 + more * way) + [False] * (2 + more * (not way))
        for cycles in ([True, True, False, False] * 150, moving * 3, QUIET):
            events = burst((17, 40), cycles, t_us, 2_000)
            t_us += 2_000 * len(events)
            out = np.empty(len(events), EVENT_DTYPE)
            n_left = kernels.remove_flicker(events, pixels, 0.0, out)
            polarity = out["p"][:n_left].astype(int)
            left[way].append(int((2 * polarity - 1).sum()) * (1 if way else -1))
    for way in (True, False):
        _, moved, after = left[way]
        assert 3 * more - 2 <= moved <= 3 * more + 1
        assert abs(after) <= 0.15 * 3 * more + 1
    assert abs(left[True][1] - left[False][1]) <= 2


@pytest.mark.parametrize("least", [0.0, LEAST_WIDTH])
def test_a_pixel_without_flicker_keeps_its_events(least):
    pixels = make_pixels()
    slow = burst((17, 40), [True, True, False, False] * 50, 50_000, 30_000)
    out = np.empty(len(slow), EVENT_DTYPE)
    n_left = kernels.remove_flicker(slow, pixels, least, out)
    np.testing.assert_array_equal(out[:n_left], slow)


def test_a_pixel_that_begins_to_flicker_draws_no_track():
    pixels = make_pixels()
    began = burst((17, 40), [True, False] * 40, 50_000, 5_000)
    out = np.empty(len(began), EVENT_DTYPE)
    assert kernels.remove_flicker(began, pixels, LEAST_WIDTH, out) <= 3


def test_events_without_flicker_are_not_copied():
    filter_ = FlickerFilter()
    for k in range(40):
        events = burst((17 + k, 40), [True, False] * 20, 10_000 * k, 200)
        assert filter_.update(events, 10_000 * k, 10_000 * (k + 1)) is events

"""Pixels that fire by themselves are found by that they fire alone."""

import numpy as np
import pytest

from neurotouch_hid.messages import EVENT_DTYPE
from neurotouch_hid.tracker.hot_pixels import WINDOW_US, HotPixelFilter

SLICE_US = 10_000
PLACE = (120, 80)


def fire(rng, places, hz, begin_us, end_us):
    """Events of some pixels, in the order of their times."""
    n = rng.poisson(hz * (end_us - begin_us) * 1e-6, len(places))
    events = np.zeros(n.sum(), EVENT_DTYPE)
    events["x"], events["y"] = np.repeat(places, n, axis=0).T
    events["t"] = np.sort(rng.integers(begin_us, end_us, len(events)))
    events["p"] = rng.integers(0, 2, len(events))
    return events


def play(pixels, places, hz, seconds, begin_us=0, also=()):
    """Returns the share of the events that is left, slice after slice."""
    rng, shares = np.random.default_rng(1), []
    for at_us in range(begin_us, begin_us + round(1e6 * seconds), SLICE_US):
        events = fire(rng, [*places, *also], hz, at_us, at_us + SLICE_US)
        left = pixels.update(events, at_us, at_us + SLICE_US)
        is_left = np.isin(left["x"], [x for x, _ in places])
        is_one = np.isin(events["x"], [x for x, _ in places])
        shares.append(is_left.sum() / max(is_one.sum(), 1))
        assert (np.diff(left["t"].astype(np.int64)) >= 0).all()
    return np.array(shares)


@pytest.mark.parametrize("place", [PLACE, (0, 0), (345, 259)])
def test_a_pixel_that_fires_alone_is_removed_within_a_second(place):
    shares = play(HotPixelFilter(), [place], 200.0, 2.0, also=[(200, 200)])
    assert (shares[:90] > 0.0).sum() > 70
    assert not shares[110:].any()


def test_two_neighbours_are_hot_too():
    assert not play(HotPixelFilter(), [PLACE, (121, 80)], 200.0, 2.0)[110:].any()


def test_the_edge_of_a_dot_that_trembles_stays():
    edge = [(120 + k, 80 + k // 2) for k in range(6)]
    assert (play(HotPixelFilter(), edge, 200.0, 3.0)[110:] > 0.0).all()


def test_pixels_that_hardly_fire_stay():
    shares = play(HotPixelFilter(), [PLACE], 20.0, 3.0)
    assert shares[150:].any()


def test_a_pixel_that_stops_is_heard_again():
    pixels = HotPixelFilter()
    play(pixels, [PLACE], 200.0, 2.0)
    play(pixels, [PLACE], 0.0, 0.5, begin_us=2_000_000)
    assert (play(pixels, [PLACE], 200.0, 0.3, begin_us=2_500_000) > 0.0).any()


def test_a_hot_pixel_stays_known_while_a_dot_moves_beside_it():
    pixels, edge = HotPixelFilter(), [(200 + k, 80) for k in range(-1, 2)]
    play(pixels, [(200, 80)], 200.0, 2.0)
    for at_us in range(2_000_000, 3_000_000, SLICE_US):
        events = fire(np.random.default_rng(at_us), edge, 200.0, at_us, at_us + SLICE_US)
        assert not (pixels.update(events, at_us, at_us + SLICE_US)["x"] == 200).any()


def test_others_are_not_touched_and_cost_no_copy():
    pixels, rng = HotPixelFilter(), np.random.default_rng(2)
    events = fire(rng, [(k, 5) for k in range(300)], 5.0, 0, WINDOW_US)
    assert pixels.update(events, 0, WINDOW_US) is events


def test_a_busy_time_tells_nothing():
    pixels, rng = HotPixelFilter(), np.random.default_rng(3)
    for at_us in range(0, 2_000_000, SLICE_US):
        events = fire(rng, [PLACE, (200, 100)], 2e6, at_us, at_us + SLICE_US)
        assert pixels.update(events, at_us, at_us + SLICE_US) is events


def test_a_hot_pixel_stays_known_in_a_busy_time():
    pixels = HotPixelFilter()
    play(pixels, [PLACE], 200.0, 2.0)
    play(pixels, [PLACE, (200, 100)], 2e6, 1.0, begin_us=2_000_000)
    assert not play(pixels, [PLACE], 200.0, 0.2, begin_us=3_000_000).any()

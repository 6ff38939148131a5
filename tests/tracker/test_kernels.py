"""The compiled event filter and neighbour check against their plain twins."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from neurotouch_hid.geometry import PAPER_GEL, Rig
from neurotouch_hid.messages import EVENT_DTYPE, SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX
from neurotouch_hid.tracker import TrackerConfig
from neurotouch_hid.tracker.config import make_tracks as make_empty_tracks
from neurotouch_hid.tracker.kernels import filter as kernels
from neurotouch_hid.tracker.kernels import nearest as nearest_kernels
from neurotouch_hid.tracker.kernels import tracks as track_kernels
from neurotouch_hid.tracker.kernels.neighbours import expect, find_collisions, find_tears
from tests.reference import tracker as reference

REST_PX = Rig((172.0, 130.0), 2.5, 0.1).to_px(PAPER_GEL.points_mm)
TUNING = TrackerConfig().tuning()


def make_tracks(position_px, search="tiles"):
    n = len(position_px)
    tracks = make_empty_tracks(PAPER_GEL.neighbours[:n], TrackerConfig(search=search))
    tracks.rest_px[:] = position_px
    put(tracks, range(n), position_px)
    return tracks


def put(tracks, markers, at_px, t_us=0.0):
    at_px = np.array(at_px, np.float64).reshape(-1, 2)
    track_kernels.place(np.array(markers, np.intp), at_px, 1.0, t_us, tracks, TUNING)


def rows(tracks):
    """Returns the markers as (n, 16) float64, in the order of the fields; a view."""
    return tracks.state.view(np.float64).reshape(len(tracks.state), -1)


def find_nearest(x, y, on, gate_px, tracks):
    i, px2 = nearest_kernels.nearest(x, y, on, gate_px**2, tracks.targets)
    return i if px2 < gate_px**2 else -1


def make_events(rng, n, until_us=20_000):
    events = np.zeros(n, EVENT_DTYPE)
    events["t"] = np.sort(rng.integers(0, until_us, n))
    events["x"] = rng.integers(0, SENSOR_WIDTH_PX, n)
    events["y"] = rng.integers(0, SENSOR_HEIGHT_PX, n)
    events["p"] = rng.random(n) < 0.5
    return events


@given(st.integers(0, 2**32 - 1), st.floats(0.0, 8.0), st.sampled_from(["tiles", "all"]))
@settings(max_examples=20, deadline=None)
def test_filter_equals_a_matrix_filter_with_a_search_of_all(seed, scatter, search):
    tuning = TrackerConfig(search=search).tuning()
    rng = np.random.default_rng(seed)
    position = REST_PX + rng.normal(0, scatter, REST_PX.shape)
    tracks, events = make_tracks(position), make_events(rng, 600)
    near = rng.integers(0, len(position), 600)  # most events lie around a marker
    events["x"][:500] = np.clip(position[near, 0] + rng.normal(0, 2, 600), 0, 345)[:500]
    events["y"][:500] = np.clip(position[near, 1] + rng.normal(0, 2, 600), 0, 259)[:500]
    rows(tracks)[:, 8:10] = rng.uniform(-0.7, 0.7, (177, 2))
    tracks.r_px2[:] = rng.uniform(5, 50, (177, 2))
    track_kernels.aim(10_000.0, tracks, tuning)
    state, aim = rows(tracks).tolist(), tracks.targets.aim_px[:, ::-1].reshape(177, 4).tolist()

    assert kernels.filter_events(events, 0, 20_000, tracks, tuning) == 600

    taken = reference.filter_events(events.tolist(), state, aim, tracks.r_px2, tuning)
    assert sum(i >= 0 for i in taken) > 300
    np.testing.assert_allclose(rows(tracks), state, rtol=1e-9, atol=1e-9)


def test_filter_stops_at_the_moment_given():
    events = make_events(np.random.default_rng(1), 300)
    tracks = make_tracks(REST_PX)
    cut = kernels.filter_events(events, 0, 9_000, tracks, TUNING)
    assert cut == (events["t"] < 9_000).sum()
    assert tracks.state["t_us"].max() < 9_000


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=20, deadline=None)
def test_the_lists_contain_every_marker_near_an_event(seed):
    rng = np.random.default_rng(seed)
    tracks = make_tracks(rng.uniform(-20, 370, (177, 2)))
    for i in rng.integers(0, 177, 20):
        put(tracks, [i], rng.uniform((-900, -900), (900, 900)))
    lead_px = rng.uniform(-0.7, 0.7, (177, 2))
    rows(tracks)[:, 8:10] = lead_px
    track_kernels.aim(0.0, tracks, TUNING)
    for on in (True, False):
        expected = (rows(tracks)[:, :2] + (lead_px if on else -lead_px)).tolist()
        for x, y in rng.integers(0, (SENSOR_WIDTH_PX, SENSOR_HEIGHT_PX), (100, 2)).tolist():
            twin = reference.nearest(x, y, 3.5, expected)
            assert find_nearest(x, y, on, 3.5, tracks) == twin


@given(st.integers(0, 2**32 - 1), st.floats(0.0, 0.2))
@settings(max_examples=20, deadline=None)
def test_lists_of_markers_that_move_are_those_made_from_nothing(seed, pull):
    """Also in a crowd of more markers than a list has places."""
    rng = np.random.default_rng(seed)
    at_px, tracks = rng.uniform(-20, 370, (177, 2)), make_tracks(REST_PX)
    for k in range(20):
        at_px += pull * (100.0 - at_px) * (1 if k < 10 else -1) + rng.normal(0.0, 1.0, (177, 2))
        put(tracks, range(177), at_px)
        moved, fresh = tracks.targets, make_tracks(at_px).targets
        np.testing.assert_array_equal(moved.n_near, fresh.n_near)
        for tile in np.flatnonzero(moved.n_near):
            n = moved.n_near[tile]
            np.testing.assert_array_equal(moved.near[:n, tile], fresh.near[:n, tile])


@given(st.integers(0, 2**32 - 1), st.floats(0.2, 1.0))
@settings(max_examples=20, deadline=None)
def test_expectation_is_the_median_of_the_neighbours(seed, share):
    rng = np.random.default_rng(seed)
    position = REST_PX + rng.normal(0, 5, REST_PX.shape)
    usable = rng.random(177) < share
    expected, spread = np.empty((177, 2)), np.empty(177)
    expect(position, usable, REST_PX, PAPER_GEL.neighbours.copy(), expected, spread)
    twin = reference.expect(
        position.tolist(), REST_PX.tolist(), PAPER_GEL.neighbours.tolist(), usable
    )
    for i, answer in enumerate(twin):
        if answer is None:
            assert np.isnan(expected[i]).all()
        else:
            np.testing.assert_allclose((*expected[i], spread[i]), answer, atol=1e-9)


def test_check_repairs_a_stray_marker_and_accepts_a_steep_field():
    # 18 mm of push at 8 mm from the centre of a finger: 45 px here, 27 px one pitch further.
    r = np.hypot(*(PAPER_GEL.points_mm - (4.0, 2.0)).T)
    field = np.stack([45.0 / (1.0 + (r / 9.0) ** 2), np.zeros_like(r)], axis=1)
    tracks = make_tracks(REST_PX + field)
    tracks.rest_px[:] = REST_PX
    kernels.check(2_000, tracks, TUNING)
    assert not tracks.lost.any()

    put(tracks, [60], rows(tracks)[60, :2] + (0.0, 17.0), 2_000.0)
    kernels.check(4_000, tracks, TUNING)
    kernels.check(6_000, tracks, TUNING)
    assert np.flatnonzero(tracks.lost).tolist() == [60]
    np.testing.assert_allclose(rows(tracks)[60, :2], (REST_PX + field)[60], atol=4.0)
    assert tracks.common[["n_checks", "n_repairs"]].tolist() == [(3, 1)]


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=20, deadline=None)
def test_of_two_markers_at_one_place_one_is_wrong(seed):
    rng = np.random.default_rng(seed)
    position = REST_PX + rng.normal(0, 4, REST_PX.shape)
    expected = REST_PX + rng.normal(0, 1, REST_PX.shape)
    out = np.zeros(177, np.bool_)
    find_collisions(position, expected, PAPER_GEL.neighbours.copy(), out)
    twin = reference.collide(
        position.tolist(), expected.tolist(), PAPER_GEL.neighbours.tolist(), 1.5
    )
    assert set(np.flatnonzero(out).tolist()) == twin


@given(st.integers(0, 2**32 - 1), st.floats(0.3, 1.0))
@settings(max_examples=20, deadline=None)
def test_a_marker_that_moves_alone_would_tear_the_gel(seed, share):
    rng = np.random.default_rng(seed)
    far = rng.random((177, 1)) < 0.3
    position = REST_PX + rng.normal(0, 1, REST_PX.shape) + far * rng.normal(0, 8, REST_PX.shape)
    usable, out = rng.random(177) < share, np.zeros(177, np.bool_)
    find_tears(position, usable, REST_PX, PAPER_GEL.neighbours.copy(), 4.0, out)
    twin = reference.tear(
        position.tolist(), usable, REST_PX.tolist(), PAPER_GEL.neighbours.tolist(), 4.0
    )
    assert set(np.flatnonzero(out).tolist()) == twin


def test_a_patch_one_place_off_recovers():
    patch = np.flatnonzero((np.abs(PAPER_GEL.points_mm) < 6.0).all(axis=1))  # 3 x 3 markers
    start = REST_PX.copy()
    start[patch] += (0.0, -10.0)
    tracks = make_tracks(start)
    tracks.rest_px[:] = REST_PX
    for k in range(1, 12):
        tracks.n_new[patch] = 10  # they make events, most others none
        kernels.check(k * 2_000, tracks, TUNING)
    np.testing.assert_allclose(rows(tracks)[:, :2], REST_PX, atol=0.1)
    assert not tracks.lost.any()


def test_a_lost_marker_without_events_of_its_own_stays_lost():
    tracks = make_tracks(REST_PX)
    tracks.lost[[30, 90]] = True
    for k in range(1, 6):
        tracks.n_new[30] = 10
        kernels.check(k * 2_000, tracks, TUNING)
    assert np.flatnonzero(tracks.lost).tolist() == [90]


def test_a_marker_that_follows_its_neighbour_is_not_valid():
    tracks = make_tracks(REST_PX)
    put(tracks, [88], REST_PX[89] - (0.5, 0.0))
    tracks.rest_px[:] = REST_PX
    kernels.check(2_000, tracks, TUNING)
    assert np.flatnonzero(tracks.lost).tolist() == [88]
    np.testing.assert_allclose(rows(tracks)[88, :2], REST_PX[88], atol=0.5)


@given(
    st.integers(0, 2**32 - 1),
    st.sampled_from([0, 30, 100_000]),
    st.sampled_from([2_000, 4_000, 8_000]),
    st.booleans(),
)
@settings(max_examples=20, deadline=None)
def test_weights_are_those_of_the_plain_twin(seed, n_checks, elapsed_us, is_rare):
    rng = np.random.default_rng(seed)
    tracks = make_tracks(REST_PX)
    rows(tracks)[:, 2:4] = rng.normal(0, 200, (177, 2))
    tracks.state["t_us"] = rng.uniform(-30_000, 2_000, 177)
    tracks.rate_hz[:] = rng.uniform(0, 2000, 177)
    tracks.n_new[:] = rng.integers(0, 20, 177)
    rows(tracks)[:, 8:10] = rng.uniform(-0.7, 0.7, (177, 2))
    rows(tracks)[:, 11:13] = tracks.n_new[:, None] * rng.normal(0, 1, (177, 2))
    tracks.state["excess"] = tracks.n_new - 2 * rng.integers(0, tracks.n_new + 1)
    tracks.state["excess_hz"] = rng.uniform(-1, 1, 177) * tracks.rate_hz
    variance = tracks.state["var_v"].copy()
    tracks.common["noise_hz"][0] = rng.uniform(0, 2000)
    tracks.common["n_checks"] = n_checks
    tracks.common["counts_steps"] = is_rare
    motion = rows(tracks)[:, [2, 3, 7, 8, 9, 11, 12, 13, 14]].tolist()
    twin = reference.weigh(
        10_000, motion, tracks.n_new.tolist(), tracks.rate_hz.tolist(),
        float(tracks.common["noise_hz"][0]), PAPER_GEL.neighbours.tolist(), n_checks,
        10_000 - elapsed_us, TUNING, is_rare=is_rare,
    )  # fmt: skip
    tracks.past_us[(n_checks - 1) % len(tracks.past_us)] = 10_000 - elapsed_us
    kernels.weigh(10_000, tracks, TUNING)
    rate, noise, r_px2, lead_px, growth = twin
    np.testing.assert_allclose(tracks.rate_hz, rate)
    np.testing.assert_allclose(tracks.common["noise_hz"][0], noise)
    np.testing.assert_allclose(tracks.r_px2, r_px2)
    np.testing.assert_allclose(rows(tracks)[:, 8:10], lead_px)
    np.testing.assert_allclose(tracks.state["var_v"] - variance, growth, atol=1e-6)
    assert not tracks.n_new.any()
    assert not rows(tracks)[:, 11:14].any()


@pytest.mark.parametrize(("n_events", "n_checks"), [(0, 13), (1, 13), (3, 17), (9, 50)])
def test_a_gel_without_motion_is_checked_less_often(n_events, n_checks):
    tracks = make_tracks(REST_PX)
    track_kernels.place(np.arange(177), REST_PX, 1.0, 0.0, tracks, TUNING)
    tracks.common["next_check_us"] = 2_000
    events = np.zeros(50 * n_events, EVENT_DTYPE)  # in each 2 ms some of one marker
    events["t"] = np.repeat(1_000 + 2_000 * np.arange(50), n_events)
    events["x"], events["y"] = REST_PX[80].round()
    field, valid = np.empty((177, 2), np.float32), np.empty(177, np.bool_)
    kernels.filter_slice(tracks, TUNING, events, 0, 100_000, field, valid)
    assert tracks.common["n_checks"][0] == n_checks
    checked_us = tracks.past_us[:n_checks]
    assert checked_us[0] == 2_000
    assert np.diff(checked_us).max() <= kernels.STILL_US
    assert not (checked_us % TUNING.check_us).any()


def test_noise_of_few_events_is_no_motion_where_frames_are_rare():
    """36 events a second, less than one in the time over which a rate is averaged."""
    tracks, rng = make_tracks(REST_PX), np.random.default_rng(4)
    tracks.common["counts_steps"] = True
    trusted = []
    for k in range(1, 2_001):
        tracks.n_new[:] = rng.poisson(0.002 * 36.0, 177)
        kernels.weigh(2_000 * k, tracks, TUNING)
        tracks.common["n_checks"] += 1
        trusted.append(np.median(TUNING.r_px2 / tracks.r_px2))
    assert np.mean(trusted[1_000:]) < 1.2 * kernels.MIN_TRUST  # 0.49 by single markers
    assert tracks.common["noise_hz"][0] == pytest.approx(30.0, rel=0.2)


def test_noise_counts_less_than_motion():
    tracks = make_tracks(REST_PX)
    for k in range(1, 101):  # 250 noise events per second at each marker
        tracks.n_new[:] = k % 2
        tracks.n_new[80:90] += 2 * (k > 90)  # then ten of them move
        kernels.weigh(2_000 * k, tracks, TUNING)
        tracks.common["n_checks"] += 1
    assert tracks.common["noise_hz"][0] == pytest.approx(250.0, rel=0.2)
    assert (tracks.r_px2[85] < 4.0 * TUNING.r_px2).all()
    assert (tracks.r_px2[20] > 10.0 * TUNING.r_px2).all()


@pytest.mark.parametrize(("n_off", "least", "most"), [(10, 0.9, 1.2), (0, 5.0, 20.0)])
def test_events_of_a_passing_shadow_count_little(n_off, least, most):
    tracks = make_tracks(REST_PX)
    for k in range(1, 101):
        tracks.n_new[:] = k % 2
        tracks.n_new[40:140] += (10 + n_off) * (k > 90)  # a marker that moves makes both
        tracks.state["excess"][40:140] += (10 - n_off) * (k > 90)
        kernels.weigh(2_000 * k, tracks, TUNING)
        tracks.common["n_checks"] += 1
    off, on = tracks.r_px2[85] / TUNING.r_px2
    assert off < 4.0
    assert least <= on / off <= most


def make_sided_events(at_px, way, n, begin_us, *, one_sided=False):
    """Returns events of a bright marker on its way: ON ahead of it, OFF behind it, one by one."""
    events = np.zeros(n, EVENT_DTYPE)
    events["t"] = begin_us + np.arange(n) * 2_000 // n
    events["p"] = one_sided | (np.arange(n) % 2 == 0)
    side = np.where(np.arange(n) % 2 == 0, 2.0, -2.0)
    events["x"], events["y"] = (np.rint(at_px + side[:, None] * way)).T
    return events


@pytest.mark.parametrize(("one_sided", "turns"), [(False, True), (True, False)])
def test_the_sides_of_the_events_show_that_a_marker_has_turned(one_sided, turns):
    tracks, marker = make_tracks(np.rint(REST_PX)), 88
    tracks.state["vx"][marker], tracks.state["lead_x"][marker] = 100.0, 1.0
    track_kernels.aim(2_000.0, tracks, TUNING)
    variance = tracks.state["var_v"][marker]
    back = np.array([-1.0, 0.0])
    events = make_sided_events(np.rint(REST_PX[marker]), back, 30, 0, one_sided=one_sided)
    kernels.filter_events(events, 0, 2_000, tracks, TUNING)
    assert tracks.n_new[marker] == 30
    filtered = tracks.state["var_v"][marker]
    kernels.weigh(2_000, tracks, TUNING)
    assert (tracks.state["lead_x"][marker] < -0.5) == turns
    assert (tracks.state["var_v"][marker] > filtered + variance) == turns


def test_a_predicted_motion_fades():
    tracks = make_tracks(REST_PX[:1])
    tracks.state["vx"][0] = 100.0
    out = np.empty((1, 2))

    def travelled(t_us):
        track_kernels.predict(t_us, 0.02, tracks, out)
        return out[0, 0] - REST_PX[0, 0]

    assert travelled(1_000.0) == pytest.approx(0.1 * (1 - 0.025))
    assert travelled(20_000.0) == pytest.approx(1.0)
    assert travelled(5_000_000.0) == pytest.approx(1.0)


def test_slices_do_not_change_what_advance_does():
    events = make_events(np.random.default_rng(3), 20_000, until_us=50_000)
    whole, cut = make_tracks(REST_PX), make_tracks(REST_PX)
    n = len(REST_PX)
    where = np.empty((n, 2), np.float32), np.empty(n, np.bool_)
    kernels.filter_slice(whole, TUNING, events, 0, 50_000, *where)
    start = 0
    for until_us in (*range(1_500, 50_000, 1_500), 50_000):
        start = kernels.filter_slice(cut, TUNING, events, start, until_us, *where)
    for one, other in zip((*whole.targets, *whole[2:]), (*cut.targets, *cut[2:]), strict=True):
        assert np.array_equal(one, other)
    assert np.array_equal(whole.state, cut.state)


def test_shift_moves_the_past_too():
    tracks = make_tracks(REST_PX)
    kernels.check(2_000, tracks, TUNING)
    track_kernels.shift(tracks, np.array([5]), np.array([[30.0, -20.0]]))
    np.testing.assert_allclose(tracks.past_px[0, 5], REST_PX[5] + (30.0, -20.0))
    x, y = np.rint(REST_PX[5] + (30.0, -20.0)).astype(int)
    assert find_nearest(int(x), int(y), True, 1.0, tracks) == 5

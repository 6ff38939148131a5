"""Slices are short while the gel moves, and come as one in nothing but noise; nothing is lost."""

import numpy as np
import pytest

from neurotouch_hid.messages import EVENT_DTYPE, EventPacket, Frame
from neurotouch_hid.source.slice_pacer import (
    CALM_US,
    DENSE_PER_US,
    DOUBT_US,
    LONGEST_US,
    MOST_EVENTS,
    MOST_PER_US,
    MOVED_US,
    MOVING_US,
    SlicePacer,
)

SLICE_US = 4_000
N_CALM = CALM_US // SLICE_US
N_DOUBT = DOUBT_US // SLICE_US
N_JOINED = LONGEST_US // SLICE_US


def make(k, n=360, gap=0, frames=(), slice_us=SLICE_US):
    events = np.zeros(n, EVENT_DTYPE)
    events["t"] = k * slice_us + np.arange(n) * slice_us // max(n, 1)
    events["x"] = k % 346
    return EventPacket(k * slice_us, (k + 1) * slice_us, events, frames, gap)


def idle_lull(slice_us=SLICE_US):
    """A lull whose next slices wait: the line has been idle for as long as it takes."""
    lull = SlicePacer()
    lull.is_idle = True
    n_first = (DOUBT_US + CALM_US) // slice_us
    for k in range(n_first):
        assert lull.take(make(k, slice_us=slice_us))
    return lull, n_first


def test_a_line_that_is_not_idle_gets_every_slice():
    lull = SlicePacer()
    for k in range(200):
        (packet,) = lull.take(sent := make(k, 0))
        assert packet is sent


@pytest.mark.parametrize("level", [0, 150, 300])
def test_an_idle_line_gets_noise_seldom_and_all_of_it(level):
    rng = np.random.default_rng(1)
    lull = SlicePacer()
    lull.is_idle = True
    sent = [
        make(k, rng.poisson(level), frames=(Frame(None, k, k),) if k % 10 == 0 else ())
        for k in range(2_500)
    ]
    got = [packet for each in sent for packet in lull.take(each)]
    got += lull.flush()
    assert len(got) < 1.2 * len(sent) / N_JOINED + N_DOUBT + 2 * N_CALM
    assert max(packet.t_end_us - packet.t_begin_us for packet in got) == LONGEST_US
    ends = [0, *(packet.t_end_us for packet in got)]
    assert [packet.t_begin_us for packet in got] == ends[:-1]
    for packet in got:
        t = packet.events["t"]
        assert ((t >= packet.t_begin_us) & (t < packet.t_end_us)).all()
    for side in (sent, got):
        events = np.concatenate([packet.events for packet in side])
        frames = [frame for packet in side for frame in packet.frames]
        side[:] = [*(events[name].tolist() for name in events.dtype.names), frames]
    assert sent == got


@pytest.mark.parametrize(
    ("slice_us", "most"), [(SLICE_US, MOST_EVENTS), (1_000, MOST_PER_US * 1_000)]
)
@pytest.mark.parametrize("level", [1_000, 3_000, 9_000])
def test_what_comes_together_is_no_more_than_the_line_takes_in_time(level, slice_us, most):
    lull, first = idle_lull(slice_us)
    sizes = []
    for k in range(first, first + 1_000):  # which it gets used to
        sizes += [len(packet.events) for packet in lull.take(make(k, level, slice_us=slice_us))]
    assert max(sizes) <= max(level, most)
    assert sizes[-1] == min(max(most // level, 1), N_JOINED) * level


def test_the_head_of_a_slice_may_come_if_the_slice_will_not_wait():
    lull = SlicePacer()
    assert not lull.takes_partials  # nobody has said yet that he can use one
    lull.is_idle = False
    assert lull.takes_partials
    lull, n_calm = idle_lull()
    assert lull.takes_partials  # calm, but not for long enough
    for k in range(n_calm, n_calm + 3 * N_JOINED):
        lull.take(make(k))
        assert not lull.takes_partials
    lull.is_idle = False
    assert not lull.takes_partials  # of those that wait
    lull.take(make(k + 1))
    assert lull.takes_partials


def test_after_a_lull_ends_heads_come_before_the_line_knows():
    lull, n_calm = idle_lull()
    lull.take(make(n_calm))
    assert lull.take(make(n_calm + 1, 2_000))  # with the one that waited
    assert not lull.takes_partials
    assert lull.take(make(n_calm + 2, 2_000))
    assert lull.takes_partials


def test_too_full_a_slice_does_not_wait_and_its_head_may_come():
    lull = SlicePacer()
    lull.is_idle = True
    for k in range(3 * N_CALM):
        assert lull.take(make(k, MOST_EVENTS // 2 + 1))
        assert lull.takes_partials


def test_what_stands_out_ends_the_lull_at_once_and_for_a_while():
    lull, k = idle_lull()
    assert lull.take(make(k)) == lull.take(make(k + 1)) == ()
    (packet,) = lull.take(make(k + 2, 500))
    assert (packet.t_begin_us, packet.t_end_us) == (k * SLICE_US, (k + 3) * SLICE_US)
    assert len(packet.events) == 2 * 360 + 500
    for j in range(k + 3, k + 3 + N_CALM):
        (packet,) = lull.take(make(j))
    assert lull.take(make(k + 3 + N_CALM)) == ()


def test_a_line_that_wakes_gets_what_waits_with_the_next_slice():
    lull, k = idle_lull()
    assert lull.take(make(k)) == ()
    lull.is_idle = False
    (packet,) = lull.take(make(k + 1))
    assert (packet.t_begin_us, packet.t_end_us) == (k * SLICE_US, (k + 2) * SLICE_US)


@pytest.mark.parametrize("hole", [0, 1_000])
def test_a_gap_stands_before_what_came_after_it(hole):
    lull, k = idle_lull()
    assert lull.take(make(k)) == ()
    before, after = lull.take(make(k + 1 + hole, gap=7))
    assert (before.t_end_us, before.gap) == ((k + 1) * SLICE_US, 0)
    assert (after.t_begin_us, after.gap) == ((k + 1 + hole) * SLICE_US, 7)


def test_a_new_lamp_is_got_used_to():
    lull, k = idle_lull()
    n_got = [len(lull.take(make(j, 600))) for j in range(k, k + 1_000)]
    assert sum(n_got[:25]) == 25
    assert sum(n_got[-400:]) <= 400 // (MOST_EVENTS // 600) + 1


PARTS = SLICE_US // MOVING_US
N_STILL = MOVED_US // SLICE_US


def take_parts(pacer, k, n_parts):
    """What comes of slice ``k`` in parts, with so many events in each."""
    given = [make(PARTS * k + j, n, slice_us=MOVING_US) for j, n in enumerate(n_parts)]
    got = [packet for part in given for packet in pacer.take(part)]
    return [(p.t_begin_us - k * SLICE_US, p.t_end_us - k * SLICE_US, len(p.events)) for p in got]


def learn_noise():
    """A pacer that knows the noise, 90 events a part, and whose pipeline plays."""
    pacer = SlicePacer(SLICE_US)
    pacer.is_idle = True
    for k in range(2 * N_STILL):
        take_parts(pacer, k, [90] * PARTS)
    pacer.is_idle = False
    take_parts(pacer, 2 * N_STILL, [90] * PARTS)
    return pacer, 2 * N_STILL + 1


def test_parts_come_at_once_while_the_gel_moves_and_together_when_it_rests():
    pacer, k = learn_noise()
    assert take_parts(pacer, k, [90] * PARTS) == [(0, SLICE_US, 360)]
    assert not pacer.wants_parts
    assert take_parts(pacer, k + 1, [90, 90, 90, 300]) == [(0, SLICE_US, 570)]
    assert pacer.wants_parts
    each = [(j * MOVING_US, (j + 1) * MOVING_US, 90) for j in range(PARTS)]
    for j in range(N_STILL + 1):
        assert take_parts(pacer, k + 2 + j, [90] * PARTS) == each, j
    assert not pacer.wants_parts
    assert take_parts(pacer, k + 3 + N_STILL, [90] * PARTS) == [(0, SLICE_US, 360)]


def test_a_motion_that_the_pipeline_finds_late_is_not_learned_as_noise():
    pacer, k = learn_noise()
    pacer.is_idle = True
    for j in range(N_DOUBT):  # of a push that is no gesture yet
        take_parts(pacer, k + j, [300] * PARTS)
    pacer.is_idle = False
    for j in range(N_DOUBT, N_DOUBT + N_STILL + 1):
        take_parts(pacer, k + j, [90] * PARTS)
    assert not pacer.wants_parts
    take_parts(pacer, k + j + 1, [120] * PARTS)  # and of a slow one
    assert pacer.wants_parts


def test_a_motion_is_seen_before_the_pipeline_was_idle_for_long():
    rng = np.random.default_rng(1)
    pacer = SlicePacer(SLICE_US)
    pacer.is_idle = True
    for k in range(10):
        take_parts(pacer, k, rng.poisson(90, PARTS))
    pacer.is_idle = False
    take_parts(pacer, k + 1, [120] * PARTS)
    assert pacer.wants_parts


def test_light_that_flickers_does_not_keep_slices_short():
    pacer = SlicePacer(SLICE_US)
    pacer.is_idle = True
    for k in range(1_000):
        take_parts(pacer, k, [50 if k % 5 else 400] * PARTS)  # every 20 ms
    assert not pacer.wants_parts


def test_whole_slices_wake_a_pacer_of_parts_as_well():
    pacer, k = learn_noise()
    assert len(pacer.take(make(k, 600))) == 1
    assert pacer.wants_parts


def test_until_the_noise_is_known_nothing_moves():
    pacer = SlicePacer(SLICE_US)
    assert take_parts(pacer, 0, [900] * PARTS) == [(0, SLICE_US, 3600)]
    assert not pacer.wants_parts


def test_a_lamp_that_stays_does_not_keep_slices_short():
    pacer, k = learn_noise()
    pacer.is_idle = True
    for j in range(1_000):
        take_parts(pacer, k + j, [200] * PARTS)
    assert not pacer.wants_parts


@pytest.mark.parametrize("is_idle", [True, False])
def test_very_many_events_come_in_parts_though_nothing_moves(is_idle):
    few, many = DENSE_PER_US * MOVING_US - 100, DENSE_PER_US * MOVING_US + 100
    pacer = SlicePacer(SLICE_US)
    pacer.is_idle = is_idle
    k = 2 * N_DOUBT
    for j in range(k):  # light that flickers: this is noise
        take_parts(pacer, j, [many] * PARTS)
    each = [(j * MOVING_US, (j + 1) * MOVING_US, many) for j in range(PARTS)]
    assert take_parts(pacer, k, [many] * PARTS) == each
    assert not pacer.is_calm
    take_parts(pacer, k + 1, [few] * PARTS)
    assert not pacer.wants_parts
    assert take_parts(pacer, k + 2, [few] * PARTS) == [(0, SLICE_US, PARTS * few)]


def test_a_part_after_a_gap_does_not_wait():
    pacer, k = learn_noise()
    first, last = make(PARTS * k, 90, slice_us=MOVING_US), make(PARTS * k + 2, 90, 5, (), MOVING_US)
    assert pacer.take(first) == ()
    before, after = pacer.take(last)
    assert (before.t_end_us, before.gap) == (first.t_end_us, 0)
    assert (after.t_begin_us, after.gap) == (last.t_begin_us, 5)

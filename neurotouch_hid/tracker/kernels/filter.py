"""Compiled loops of the event filter and of the checks between events."""

import math

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.kernels.order_statistics import select
from neurotouch_hid.process.kernel_cache import kernel
from neurotouch_hid.tracker.kernels.lost_markers import update_lost_markers
from neurotouch_hid.tracker.kernels.nearest import PAIR, assign, find_event
from neurotouch_hid.tracker.kernels.slow_motion import (
    add_steps,
    follow_steps,
    forget_steps,
    is_due,
    needs_steps,
)
from neurotouch_hid.tracker.kernels.tracks import SECOND, Tracks, Tuning, aim, go_on, predict

BLOCK = 512  # events whose markers are found before the events move these markers
MIN_TRUST = 0.05  # a marker that seems to be at rest still follows its events, slowly
LEAST_HZ = 1e-3  # events of a marker; fewer are none
LEAST_LIT = 1e-3  # of the events of a polarity that light has made, for none would be left
NOISE_FALL_S = 0.1
NOISE_RISE_S = 5.0  # slow, so that only a long motion of the whole gel is taken for noise
SLOW_PX_S = 60.0  # the direction of a slower marker, and the sides of its events, are uncertain
SIDED = 8.0  # events of both polarities that tell the direction as surely as the velocity does
MOST_LEAD = 1.25  # of ``lead_px``: how long the lead may be that events themselves show
EVENTS_PER_PX = 40.0  # of a marker of usual contrast
HASTE_S = 0.005  # a quick hand changes its speed by as much as the speed itself in this time
FEW = 6  # events of a marker; a motion by a whole pixel makes more
STILL_US = 8_000  # longest time between two checks


# Fused multiply-add, where the processor has it, is a tenth faster.
@kernel(error_model="numpy", fastmath={"contract"})
def filter_events(
    events: NDArray[np.void], start: int, until_us: int, tracks: Tracks, tuning: Tuning
) -> int:
    """Updates the marker nearest to each event before ``until_us``, one event at a time.

    A linear Kalman filter with constant velocity [NT, "Marker Tracking"]. With isotropic noise the
    two axes share one 2 x 2 covariance, so that an update needs a single division.

    Args:
        events: (m,) EVENT_DTYPE.
        start: the first event.
        until_us: the end of the stretch.
        tracks: updated.
        tuning: of the filter.

    Returns:
        The index of the first event at or after ``until_us``.
    """
    state, n_new, r_px2 = tracks.state, tracks.n_new, tracks.r_px2
    pairs = np.empty(BLOCK, PAIR)
    forget, quiet_s2 = 1.0 / tuning.memory_s, tuning.quiet_s * tuning.quiet_s
    tail = 1.0 / (tuning.spread_px * tuning.spread_px)
    stop = find_event(events, start, until_us)
    counts_steps, lag = tracks.common[0].counts_steps, tracks.common[0].event_lag
    while start < stop:
        end = min(start + BLOCK, stop)
        n = assign(events, start, end, tuning.gate_px, tuning.search_all, tracks.targets, pairs)
        start = end
        if counts_steps:
            add_steps(events, pairs, n, tracks, tuning)
        for k in range(n):
            # Unsigned: an index that may be negative would cost a test for each use.
            e, i = events[np.uint64(pairs[k].event)], np.uint64(pairs[k].marker)
            s = state[i]
            sign = 1.0 if e.p else -1.0
            elapsed = max((e.t - s.t_us) * SECOND, 0.0)
            dt = min(elapsed, tuning.memory_s)
            keep = 1.0 - dt * forget
            step = 0.5 * dt * (1.0 + keep)
            # A marker without events does not move, and a single event is probably noise. So
            # uncertainty grows less, not more, when a marker has been quiet.
            dt = elapsed * quiet_s2 / (quiet_s2 + elapsed * elapsed)
            b = s.cov_xv + dt * s.var_v
            a = s.var_x + dt * (s.cov_xv + b) + tuning.q_x * dt
            c = s.var_v + tuning.q_v * dt
            px, py = s.x + s.vx * step, s.y + s.vy * step
            ahead = sign - lag
            dx, dy = e.x - px - ahead * s.lead_x, e.y - py - ahead * s.lead_y
            # Heavy-tailed noise: an event far from the marker is more probably noise.
            far = (dx * dx + dy * dy) * tail
            inverse = 1.0 / (a + r_px2[i, np.uint64(e.p)] * (1.0 + far * far))
            k1, k2 = a * inverse, b * inverse
            s.x, s.y = px + k1 * dx, py + k1 * dy
            s.vx, s.vy = s.vx * keep + k2 * dx, s.vy * keep + k2 * dy
            s.var_x, s.cov_xv, s.var_v = a - k1 * a, b - k1 * b, c - k2 * b
            s.t_us = e.t
            s.ahead_x, s.ahead_y = s.ahead_x + sign * dx, s.ahead_y + sign * dy
            s.excess += sign
            n_new[i] += 1
    return int(stop)


@kernel(inline="always")
def _last_check_us(tracks: Tracks) -> int:
    return int(tracks.past_us[(tracks.common[0].n_checks - 1) % len(tracks.past_us)])


@kernel
def _may_wait(t_us: int, tracks: Tracks) -> bool:
    """Returns True if the last check is recent and no marker can have moved by a pixel since."""
    last_us = _last_check_us(tracks)
    if last_us < 0 or t_us - last_us >= STILL_US:
        return False
    most = 0
    for i in range(len(tracks.n_new)):
        most = max(most, tracks.n_new[i])
    return most <= FEW


@kernel(error_model="numpy")
def weigh(t_us: int, tracks: Tracks, tuning: Tuning) -> None:
    """Updates the rates of the markers, the variance of their events and the lead of the events.

    A marker at rest receives noise at a certain rate. A higher rate of it and its neighbours is
    motion, but for what one polarity has more: a marker that moves brightens as many pixels as it
    darkens, while the shadow of a hand does one of both. The larger the share of motion in the
    events of a polarity, the smaller is ``r_px2``.

    A single marker has less than one event of noise in ``rate_s``, so the quietest quarter of the
    markers seem to have a quarter of the noise. Where no frame takes back what this moves, the
    noise is that of the quietest quarter of the neighbourhoods.
    """
    state, rate, n_new = tracks.state, tracks.rate_hz, tracks.n_new
    n, last_us = len(state), _last_check_us(tracks)
    dt = SECOND * (t_us - last_us if last_us >= 0 else tuning.check_us)
    share = -math.expm1(-dt / tuning.rate_s)
    for i in range(n):
        rate[i] += share * (n_new[i] / dt - rate[i])
        state[i].excess_hz += share * (state[i].excess / dt - state[i].excess_hz)
    mean_hz, mean_excess_hz, n_used = np.empty(n), np.empty(n), np.empty(n)
    for i in range(n):
        total, excess, used = rate[i], state[i].excess_hz, 1
        for k in range(8):
            j = tracks.neighbours[i, k]
            if j >= 0:
                total += rate[j]
                excess += state[j].excess_hz
                used += 1
        mean_hz[i], mean_excess_hz[i], n_used[i] = total / used, excess / used, used
    # A quarter of the gel is usually at rest.
    quiet = select(mean_hz if tracks.common[0].counts_steps else rate, n // 4)
    noise = tracks.common[0].noise_hz
    rise_s = min(NOISE_RISE_S, dt * (tracks.common[0].n_checks + 1))  # fast at first
    noise += (quiet - noise) * dt / (NOISE_FALL_S if quiet < noise else rise_s)
    tracks.common[0].noise_hz = noise
    spread_hz = tuning.n_sigma * math.sqrt(noise / (2.0 * tuning.rate_s))
    for i in range(n):
        # The mean of several rates has a smaller spread.
        spread = spread_hz / math.sqrt(n_used[i])
        total, excess = mean_hz[i], mean_excess_hz[i]
        light = max(abs(excess) - noise - spread, 0.0)  # noise may be of one polarity
        motion = total - noise - spread - light
        trust = max(motion / (motion + noise) if motion > 0.0 else 0.0, MIN_TRUST)
        lit = trust * max((total - light) / max(total + light, LEAST_HZ), LEAST_LIT)
        is_on = excess > 0.0
        tracks.r_px2[i, 0] = tuning.r_px2 / (trust if is_on else lit)
        tracks.r_px2[i, 1] = tuning.r_px2 / (lit if is_on else trust)
    _lead(t_us, dt, tracks, tuning)
    n_new[:] = 0


@kernel(error_model="numpy")
def _lead(t_us: int, dt: float, tracks: Tracks, tuning: Tuning) -> None:
    """Updates the lead: a bright marker brightens pixels ahead of it and darkens those behind.

    After a sudden turn the velocity still points the old way. Then ON events seem to be far behind
    and OFF events far ahead, their errors cancel, and the track would stay where it is. So the
    events tell the direction as well: from the middle of the OFF to the middle of the ON events.
    Light that flickers makes events of one polarity at a time, which tell nothing.

    A marker whose events lie on two sides moves, the faster the more there are, and a hand changes
    the speed of a fast marker by more.
    """
    state = tracks.state
    n = len(state)
    v, per_speed = np.empty((2, n)), np.empty(n)
    for i in range(n):
        keep = 1.0 - min(max((t_us - state[i].t_us) * SECOND / tuning.memory_s, 0.0), 1.0)
        v[0, i], v[1, i] = state[i].vx * keep, state[i].vy * keep
    for i in range(n):  # a loop of its own, so that the processor takes eight at once
        square = v[0, i] * v[0, i] + v[1, i] * v[1, i] + SLOW_PX_S * SLOW_PX_S
        per_speed[i] = tuning.lead_px / math.sqrt(square)
    for i in range(n):
        s, count = state[i], tracks.n_new[i]
        x, y = v[0, i] * per_speed[i], v[1, i] * per_speed[i]
        sided = count - abs(s.excess)
        if sided > 0.0:
            share = sided / (sided + SIDED)
            x += share * (s.lead_x + s.ahead_x / count - x)
            y += share * (s.lead_y + s.ahead_y / count - y)
            longer = math.sqrt(x * x + y * y) / (MOST_LEAD * tuning.lead_px)
            x, y = x / max(longer, 1.0), y / max(longer, 1.0)
            speed = sided / (dt * EVENTS_PER_PX)
            s.var_v += dt / HASTE_S * speed * speed * (x * x + y * y)
        s.lead_x, s.lead_y = x, y
        s.ahead_x = s.ahead_y = s.excess = 0.0


@kernel
def check(t_us: int, tracks: Tracks, tuning: Tuning) -> None:
    """Records all positions at ``t_us`` and updates what is known between events.

    Neighbours are checked every second time: they take half of the time, and that is often enough.
    Without events each frame checks them.
    """
    common, last_us = tracks.common[0], _last_check_us(tracks)
    slot = common.n_checks % len(tracks.past_us)
    position = tracks.past_px[slot]
    predict(float(t_us), tuning.memory_s, tracks, position)
    if common.counts_steps and last_us >= 0:
        before = common.followed % len(tracks.past_us)
        followed_us = tracks.past_us[before]
        if is_due(t_us, followed_us, tracks):
            dt = SECOND * (t_us - followed_us)
            follow_steps(dt, tracks.past_px[before], position, tracks, tuning)
            common.followed = common.n_checks
    if needs_steps(t_us, tracks):
        if not common.counts_steps:
            common.counts_steps, common.followed = True, common.n_checks
    elif common.counts_steps:
        forget_steps(tracks)
    if common.n_checks % 2 == 0 and not common.frames_alone:
        update_lost_markers(t_us, position, tracks, tuning)
    weigh(t_us, tracks, tuning)
    aim(float(t_us + tuning.check_us), tracks, tuning)
    tracks.past_us[slot] = t_us
    common.n_checks += 1


@kernel
def filter_slice(
    tracks: Tracks,
    tuning: Tuning,
    events: NDArray[np.void],
    start: int,
    until_us: int,
    position_px: NDArray[np.float32],
    valid: NDArray[np.bool_],
) -> int:
    """Filters the events before ``until_us`` and writes where the markers are then.

    All tracks are checked at multiples of ``check_us``, whatever the length of the slices.

    Args:
        tracks: updated.
        tuning: of the filter.
        events: (m,) EVENT_DTYPE.
        start: the first event.
        until_us: the end of the slice, or of an exposure in it.
        position_px: (n, 2) float32 px, written.
        valid: (n,) bool, written: False for lost markers, whose position is a guess.

    Returns:
        The index of the first event at or after ``until_us``.
    """
    common = tracks.common[0]
    while common.next_check_us <= until_us:
        start = filter_events(events, start, common.next_check_us, tracks, tuning)
        if not _may_wait(common.next_check_us, tracks):
            check(common.next_check_us, tracks, tuning)
        common.next_check_us += tuning.check_us
    start = filter_events(events, start, until_us, tracks, tuning)
    now_px = np.empty(position_px.shape)
    if common.frames_alone:
        go_on(float(until_us), tuning.memory_s, tracks, now_px)
    else:
        predict(float(until_us), tuning.memory_s, tracks, now_px)
    for i in range(len(valid)):
        position_px[i, 0], position_px[i, 1] = now_px[i, 0], now_px[i, 1]
        valid[i] = not tracks.lost[i]
    return int(start)

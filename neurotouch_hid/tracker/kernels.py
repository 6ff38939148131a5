"""The compiled loops of the tracker: the event filter and what is checked between events."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX
from neurotouch_hid.tracker.neighbours.kernels import collide, expect, strays

X, Y, VX, VY, A, B, C, T, LEAD_X, LEAD_Y = range(10)
ROW = 16  # numbers in a row of state: two cache lines
TILE_PX = 4  # every tile lists the markers that its events may belong to
SHIFT = np.uint64(2)  # log2(TILE_PX)
TILE_COLUMNS = -(-SENSOR_WIDTH_PX // TILE_PX)
TILE_ROWS = -(-SENSOR_HEIGHT_PX // TILE_PX)
TILE_CAPACITY = 32  # markers within reach of a tile: as many as 3 px apart
REACH_PX = 6.0  # the largest gate, 4 px, and what a marker at 750 px/s moves between two checks
SEAT_PX = 0.5  # a marker is listed anew when it has moved so far
MIN_TRUST = 0.05  # a marker that seems to be at rest still follows, slowly
NOISE_FALL_S, NOISE_RISE_S = (
    0.1,
    5.0,
)  # motion passes for noise only if the whole gel moves for long
SLOW_PX_S = 60.0  # direction and sides of a slower marker are not known for sure
SECOND = 1e-6  # in µs


class Tracks(NamedTuple):
    """All that is known about n markers.

    Attributes:
        state: (n, 16) float64, two cache lines each. Columns: position X, Y (px), velocity VX, VY
            (px/s), the covariance A = var(position) (px²), B = cov(position, velocity) (px²/s),
            C = var(velocity) (px²/s²), the same for x and y, the moment T (µs) of all these, and
            LEAD_X, LEAD_Y (px): how far ahead of its centre a marker makes ON events, and behind
            it OFF events.
        near: (tiles, k) uint16, the markers that were seated within ``REACH_PX`` of a tile, along
            x and along y.
        n_near: (tiles,) int16, their number.
        n_new: (n,) int64, events of each marker since the last check.
        rate_hz: (n,) float64, events of each marker per second, lately.
        r_px2: (n,) float64, variance of an event about its marker's centre now.
        noise_hz: (1,) float64, rate of a marker that does not move.
        seat_px: (n, 2) float64, where each marker was when it was seated; NaN before.
        lost: (n,) bool, the position is a guess.
        rest_px: (n, 2) float64, positions while the gel is undeformed.
        neighbours: (n, 8) intp, -1 where there is none.
        past_px: (n, k, 2) float64, ring of the positions at the last k checks.
        past_us: (k,) int64, the moments of these checks, -1 where there is none.
        clock: (3,) int64: moment of the next check (µs), checks done, markers seated anew.
    """

    state: NDArray[np.float64]
    near: NDArray[np.uint16]
    n_near: NDArray[np.int16]
    n_new: NDArray[np.int64]
    rate_hz: NDArray[np.float64]
    r_px2: NDArray[np.float64]
    noise_hz: NDArray[np.float64]
    seat_px: NDArray[np.float64]
    lost: NDArray[np.bool_]
    rest_px: NDArray[np.float64]
    neighbours: NDArray[np.intp]
    past_px: NDArray[np.float64]
    past_us: NDArray[np.int64]
    clock: NDArray[np.int64]


class Tuning(NamedTuple):
    """Constants of the filter and the check; ``TrackerConfig`` says what they are and why."""

    gate_px: float
    r_px2: float
    spread_px: float
    q_x: float
    q_v: float
    memory_s: float
    quiet_s: float
    check_us: int
    max_stray_px: float
    max_stray_ratio: float
    rate_s: float
    n_sigma: float
    lead_px: float


@njit(cache=True, nogil=True)
def _tiles_near(x: float, y: float) -> tuple[int, int, int, int]:
    """The tiles within reach of a place: first and last row (excluded), the same for columns."""
    top, bottom = math.floor((y - REACH_PX) / TILE_PX), math.floor((y + REACH_PX) / TILE_PX)
    left, right = math.floor((x - REACH_PX) / TILE_PX), math.floor((x + REACH_PX) / TILE_PX)
    return (
        max(top, 0),
        min(bottom + 1, TILE_ROWS),
        max(left, 0),
        min(right + 1, TILE_COLUMNS),
    )


@njit(cache=True, nogil=True)
def seat(tracks: Tracks) -> None:
    """Keep the lists of the tiles true after markers have moved."""
    # The arrays are taken out of the tuple: handing it on for each marker would cost 50 ns.
    state, seat_px, near, n_near = tracks.state, tracks.seat_px, tracks.near, tracks.n_near
    for i in range(len(state)):
        x, y = state[i, X], state[i, Y]
        old_x, old_y = seat_px[i, X], seat_px[i, Y]
        if abs(x - old_x) <= SEAT_PX and abs(y - old_y) <= SEAT_PX:
            continue
        if not math.isnan(old_x):
            top, bottom, left, right = _tiles_near(old_x, old_y)
            for row in range(top, bottom):
                for tile in range(row * TILE_COLUMNS + left, row * TILE_COLUMNS + right):
                    _strike(i, tile, near, n_near)
        top, bottom, left, right = _tiles_near(x, y)
        for row in range(top, bottom):
            for tile in range(row * TILE_COLUMNS + left, row * TILE_COLUMNS + right):
                _enter(i, tile, near, n_near)
        seat_px[i, X], seat_px[i, Y] = x, y


@njit(cache=True, nogil=True)
def _strike(i: int, tile: int, near: NDArray[np.uint16], n_near: NDArray[np.int16]) -> None:
    last = n_near[tile] - 1
    for k in range(last + 1):
        if near[tile, k] == i:
            near[tile, k] = near[tile, last]
            n_near[tile] = last
            return


@njit(cache=True, nogil=True)
def _enter(i: int, tile: int, near: NDArray[np.uint16], n_near: NDArray[np.int16]) -> None:
    if n_near[tile] < near.shape[1]:
        near[tile, n_near[tile]] = i
        n_near[tile] += 1


@njit(cache=True, nogil=True, inline="always")
def nearest(x: int, y: int, sign: float, gate_px2: float, tracks: Tracks) -> int:
    """The marker nearest to pixel (x, y) among those nearer than the gate, or -1."""
    # Unsigned: an index that may be negative would cost a test for each use.
    tile = (np.uint64(y) >> SHIFT) * np.uint64(TILE_COLUMNS) + (np.uint64(x) >> SHIFT)
    best, best_px2 = -1, gate_px2
    for k in range(tracks.n_near[tile]):
        i = tracks.near[tile, k]
        dx = x - tracks.state[i, X] - sign * tracks.state[i, LEAD_X]
        dy = y - tracks.state[i, Y] - sign * tracks.state[i, LEAD_Y]
        px2 = dx * dx + dy * dy
        closer = px2 < best_px2
        best = i if closer else best
        best_px2 = px2 if closer else best_px2
    return best


@njit(cache=True, nogil=True)
def filter_events(
    events: NDArray[np.void], start: int, until_us: int, tracks: Tracks, tuning: Tuning
) -> int:
    """Give each event before ``until_us`` to the nearest marker in the gate, one by one.

    A linear Kalman filter with constant velocity [NT, "Marker Tracking"]. With isotropic noise the
    two axes share one 2 x 2 covariance, so that an update needs a single division.

    Returns:
        The index of the first event at or after ``until_us``.
    """
    n = len(events)
    state, n_new, r_px2 = tracks.state, tracks.n_new, tracks.r_px2
    gate_px2 = tuning.gate_px * tuning.gate_px
    forget, quiet_s2 = 1.0 / tuning.memory_s, tuning.quiet_s * tuning.quiet_s
    tail = 1.0 / (tuning.spread_px * tuning.spread_px)
    while start < n and events[start].t < until_us:
        e = events[start]
        start += 1
        x, y = int(e.x), int(e.y)
        sign = 1.0 if e.p else -1.0
        i = nearest(x, y, sign, gate_px2, tracks)
        if i < 0:
            continue
        s = state[np.uint64(i)]
        elapsed = max((e.t - s[T]) * SECOND, 0.0)
        dt = min(elapsed, tuning.memory_s)
        keep = 1.0 - dt * forget
        step = 0.5 * dt * (1.0 + keep)
        # What makes no events does not move, and a lone event is likely noise: uncertainty grows
        # less, not more, when a marker has been quiet.
        dt = elapsed * quiet_s2 / (quiet_s2 + elapsed * elapsed)
        b = s[B] + dt * s[C]
        a = s[A] + dt * (s[B] + b) + tuning.q_x * dt
        c = s[C] + tuning.q_v * dt
        px, py = s[X] + s[VX] * step, s[Y] + s[VY] * step
        dx, dy = x - px - sign * s[LEAD_X], y - py - sign * s[LEAD_Y]
        # Heavy-tailed noise: an event far from the marker is more likely to be nobody's.
        far = (dx * dx + dy * dy) * tail
        inverse = 1.0 / (a + r_px2[np.uint64(i)] * (1.0 + far * far))
        k1, k2 = a * inverse, b * inverse
        s[X], s[Y] = px + k1 * dx, py + k1 * dy
        s[VX], s[VY] = s[VX] * keep + k2 * dx, s[VY] * keep + k2 * dy
        s[A], s[B], s[C] = a - k1 * a, b - k1 * b, c - k2 * b
        s[T] = e.t
        n_new[np.uint64(i)] += 1
    return start


@njit(cache=True, nogil=True)
def predict(t_us: float, memory_s: float, tracks: Tracks, out_px: NDArray[np.float64]) -> None:
    """Where every marker is at ``t_us``; since its last event its velocity has been fading."""
    for i in range(len(tracks.state)):
        s = tracks.state[i]
        dt = min(max((t_us - s[T]) * SECOND, 0.0), memory_s)
        step = dt * (1.0 - 0.5 * dt / memory_s)
        out_px[i, 0] = s[X] + s[VX] * step
        out_px[i, 1] = s[Y] + s[VY] * step


@njit(cache=True, nogil=True)
def place(
    markers: NDArray[np.intp],
    at_px: NDArray[np.float64],
    variance_px2: float,
    t_us: float,
    tracks: Tracks,
) -> None:
    """Put ``markers`` (k,), at rest, where they are known to be: (k, 2) px."""
    for k in range(len(markers)):
        s = tracks.state[markers[k]]
        s[X], s[Y], s[VX], s[VY], s[T] = at_px[k, 0], at_px[k, 1], 0.0, 0.0, t_us
        s[A], s[B], s[C] = variance_px2, 0.0, 100.0
    seat(tracks)


@njit(cache=True, nogil=True)
def shift(markers: NDArray[np.intp], by_px: NDArray[np.float64], tracks: Tracks) -> None:
    """Move ``markers`` (k,) by ``by_px`` (k, 2), now and in the past that is remembered."""
    for k in range(len(markers)):
        i = markers[k]
        for axis in range(2):
            tracks.state[i, X + axis] += by_px[k, axis]
            tracks.past_px[i, :, axis] += by_px[k, axis]
    seat(tracks)


@njit(cache=True, nogil=True)
def weigh(t_us: int, tracks: Tracks, tuning: Tuning) -> None:
    """How far the events of each marker are to be believed, and on which side they lie.

    A marker at rest receives noise at a certain rate. What comes to it and its neighbours beyond
    that is motion: ``r_px2`` is the smaller, the larger the share of motion in the events. A bright
    marker that moves brightens the pixels ahead of it and darkens those behind it.
    """
    state, rate, n_new = tracks.state, tracks.rate_hz, tracks.n_new
    n, dt = len(state), tuning.check_us * SECOND
    share = dt / tuning.rate_s
    for i in range(n):
        rate[i] += share * (n_new[i] / dt - rate[i])
        n_new[i] = 0
    quiet = np.partition(rate, n // 4)[n // 4]  # a quarter of the gel is at rest, now or soon
    noise = tracks.noise_hz[0]
    rise_s = min(NOISE_RISE_S, dt * (tracks.clock[1] + 1))  # fast at first
    noise += (quiet - noise) * dt / (NOISE_FALL_S if quiet < noise else rise_s)
    tracks.noise_hz[0] = noise
    for i in range(n):
        total, used = rate[i], 1
        for k in range(8):
            j = tracks.neighbours[i, k]
            if j >= 0:
                total += rate[j]
                used += 1
        sigma = math.sqrt(noise / (2.0 * tuning.rate_s * used))  # of the mean of such rates
        motion = max(total / used - noise - tuning.n_sigma * sigma, 0.0)
        trust = motion / (motion + noise) if motion > 0.0 else 0.0
        tracks.r_px2[i] = tuning.r_px2 / max(trust, MIN_TRUST)
        keep = 1.0 - min(max((t_us - state[i, T]) * SECOND / tuning.memory_s, 0.0), 1.0)
        vx, vy = state[i, VX] * keep, state[i, VY] * keep
        per_speed = tuning.lead_px / math.sqrt(vx * vx + vy * vy + SLOW_PX_S * SLOW_PX_S)
        state[i, LEAD_X], state[i, LEAD_Y] = vx * per_speed, vy * per_speed


@njit(cache=True, nogil=True)
def check_neighbours(
    t_us: int, position_px: NDArray[np.float64], tracks: Tracks, tuning: Tuning
) -> None:
    """Seat anew what is not where its neighbours say: ``position_px`` (n, 2) too is put right."""
    n = len(position_px)
    expected, spread, stray = np.empty((n, 2)), np.empty(n), np.empty(n, np.bool_)
    expect(position_px, ~tracks.lost, tracks.rest_px, tracks.neighbours, expected, spread)
    strays(position_px, expected, spread, tuning.max_stray_px, tuning.max_stray_ratio, stray)
    collide(position_px, expected, tracks.neighbours, stray)
    astray = np.flatnonzero(stray & np.isfinite(expected[:, 0]))
    for i in astray:
        position_px[i] = expected[i]
        tracks.lost[i] = True
    place(astray, position_px[astray], 4.0, float(t_us), tracks)
    tracks.clock[2] += len(astray)


@njit(cache=True, nogil=True)
def check(t_us: int, tracks: Tracks, tuning: Tuning) -> None:
    """Note all positions at ``t_us``, keep the lists true, weigh; look at the neighbours at times.

    The neighbours take half of the time and serve as well every second time.
    """
    slot = tracks.clock[1] % len(tracks.past_us)
    position = tracks.past_px[:, slot]
    predict(float(t_us), tuning.memory_s, tracks, position)
    if tracks.clock[1] % 2 == 0:
        check_neighbours(t_us, position, tracks, tuning)
    seat(tracks)
    weigh(t_us, tracks, tuning)
    tracks.past_us[slot] = t_us
    tracks.clock[1] += 1


@njit(cache=True, nogil=True)
def advance(
    events: NDArray[np.void], start: int, until_us: int, tracks: Tracks, tuning: Tuning
) -> int:
    """Filter the events before ``until_us`` and check all tracks every ``check_us``.

    Checks happen at multiples of ``check_us``, however the stream is cut into slices.

    Returns:
        The index of the first event at or after ``until_us``.
    """
    clock = tracks.clock
    while clock[0] <= until_us:
        start = filter_events(events, start, clock[0], tracks, tuning)
        check(clock[0], tracks, tuning)
        clock[0] += tuning.check_us
    return int(filter_events(events, start, until_us, tracks, tuning))

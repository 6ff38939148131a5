"""What is known about the markers, and the compiled loops that move them."""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from neurotouch_hid.tracker.kernels.nearest import OFF_X, OFF_Y, ON_X, ON_Y, list_markers

X, Y, VX, VY, A, B, C, T, LEAD_X, LEAD_Y = range(10)
ROW = 16  # numbers in a row of state: two cache lines
SECOND = 1e-6  # in µs


class Tracks(NamedTuple):
    """All that is known about n markers.

    Attributes:
        state: (n, 16) float64, two cache lines each. Columns: position X, Y (px), velocity VX, VY
            (px/s), the covariance A = var(position) (px²), B = cov(position, velocity) (px²/s),
            C = var(velocity) (px²/s²), the same for x and y, the moment T (µs) of all these, and
            LEAD_X, LEAD_Y (px): how far ahead of its centre a marker makes ON events, and behind
            it OFF events.
        aim_px: (n, 4) float64, where ON (x, y) and OFF events (x, y) of each marker are expected
            up to the next check: about where it will be then, for tracks lag a little.
        near: (k, tiles) uint16, the markers that the events of a tile may belong to.
        n_near: (tiles,) uint8, their number.
        listed: (n, 4) int64, the tiles in which each marker is listed, see ``list_markers``.
        n_new: (n,) int64, events of each marker since the last check.
        rate_hz: (n,) float64, events of each marker per second, lately.
        r_px2: (n,) float64, variance of an event about its marker's centre now.
        noise_hz: (1,) float64, rate of a marker that does not move.
        lost: (n,) bool, the position is a guess.
        rest_px: (n, 2) float64, positions while the gel is undeformed.
        neighbours: (n, 8) intp, -1 where there is none.
        past_px: (k, n, 2) float64, ring of the positions at the last k checks.
        past_us: (k,) int64, the moments of these checks, -1 where there is none.
        clock: (3,) int64: moment of the next check (µs), checks done, markers seated anew.
        frame_us: (1,) int64, the end of the last frame that showed the markers.
    """

    state: NDArray[np.float64]
    aim_px: NDArray[np.float64]
    near: NDArray[np.uint16]
    n_near: NDArray[np.uint8]
    listed: NDArray[np.int64]
    n_new: NDArray[np.int64]
    rate_hz: NDArray[np.float64]
    r_px2: NDArray[np.float64]
    noise_hz: NDArray[np.float64]
    lost: NDArray[np.bool_]
    rest_px: NDArray[np.float64]
    neighbours: NDArray[np.intp]
    past_px: NDArray[np.float64]
    past_us: NDArray[np.int64]
    clock: NDArray[np.int64]
    frame_us: NDArray[np.int64]


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
    search_all: bool


@njit(cache=True, nogil=True, inline="always")
def _fade(elapsed_us: float, memory_s: float) -> float:
    """For how long (s) a marker has moved on since its last event: its velocity has been fading."""
    dt = min(max(elapsed_us * SECOND, 0.0), memory_s)
    return dt * (1.0 - 0.5 * dt / memory_s)


@njit(cache=True, nogil=True)
def predict(t_us: float, memory_s: float, tracks: Tracks, out_px: NDArray[np.float64]) -> None:
    """Where every marker is at ``t_us``."""
    for i in range(len(tracks.state)):
        s = tracks.state[i]
        step = _fade(t_us - s[T], memory_s)
        out_px[i, 0] = s[X] + s[VX] * step
        out_px[i, 1] = s[Y] + s[VY] * step


@njit(cache=True, nogil=True, inline="always")
def _aim_at(x: float, y: float, i: int, tracks: Tracks) -> None:
    s, aim_px = tracks.state[i], tracks.aim_px
    aim_px[i, ON_X], aim_px[i, ON_Y] = x + s[LEAD_X], y + s[LEAD_Y]
    aim_px[i, OFF_X], aim_px[i, OFF_Y] = x - s[LEAD_X], y - s[LEAD_Y]


@njit(cache=True, nogil=True)
def aim(t_us: float, tracks: Tracks, tuning: Tuning) -> None:
    """Expect the events of all markers where these will be at ``t_us``."""
    for i in range(len(tracks.state)):
        s = tracks.state[i]
        step = _fade(t_us - s[T], tuning.memory_s)
        _aim_at(s[X] + s[VX] * step, s[Y] + s[VY] * step, i, tracks)
    list_markers(tracks.aim_px, tracks.near, tracks.n_near, tracks.listed)


@njit(cache=True, nogil=True)
def place(
    markers: NDArray[np.intp],
    at_px: NDArray[np.float64],
    variance_px2: float,
    t_us: float,
    tracks: Tracks,
    tuning: Tuning,
) -> None:
    """Put ``markers`` (k,), at rest, where they are known to be: (k, 2) px.

    Their past moves along: a frame that tells where they lay then is not to move them once more.
    """
    for k in range(len(markers)):
        i = markers[k]
        s = tracks.state[i]
        step = _fade(t_us - s[T], tuning.memory_s)
        dx, dy = at_px[k, 0] - s[X] - s[VX] * step, at_px[k, 1] - s[Y] - s[VY] * step
        for slot in range(len(tracks.past_px)):
            tracks.past_px[slot, i, 0] += dx
            tracks.past_px[slot, i, 1] += dy
        s[X], s[Y], s[VX], s[VY], s[T] = at_px[k, 0], at_px[k, 1], 0.0, 0.0, t_us
        s[A], s[B], s[C] = variance_px2, 0.0, 100.0
        _aim_at(s[X], s[Y], i, tracks)
    list_markers(tracks.aim_px, tracks.near, tracks.n_near, tracks.listed)


@njit(cache=True, nogil=True)
def shift(markers: NDArray[np.intp], by_px: NDArray[np.float64], tracks: Tracks) -> None:
    """Move ``markers`` (k,) by ``by_px`` (k, 2), now and in the past that is remembered."""
    all_px = np.zeros((len(tracks.state), 2))
    for k in range(len(markers)):
        i = markers[k]
        dx, dy = by_px[k, 0], by_px[k, 1]
        s, aim_px = tracks.state[i], tracks.aim_px[i]
        s[X], s[Y] = s[X] + dx, s[Y] + dy
        aim_px[ON_X], aim_px[ON_Y] = aim_px[ON_X] + dx, aim_px[ON_Y] + dy
        aim_px[OFF_X], aim_px[OFF_Y] = aim_px[OFF_X] + dx, aim_px[OFF_Y] + dy
        all_px[i, 0], all_px[i, 1] = dx, dy
    by = all_px.ravel()
    for slot in range(len(tracks.past_px)):
        past_px = tracks.past_px[slot].ravel()
        for k in range(len(by)):  # eight at once
            past_px[k] += by[k]
    list_markers(tracks.aim_px, tracks.near, tracks.n_near, tracks.listed)

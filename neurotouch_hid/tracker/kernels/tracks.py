"""The state of the markers, and the compiled loops that move them."""

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.process.kernel_cache import kernel
from neurotouch_hid.tracker.kernels.nearest import Targets, list_markers

SECOND = 1e-6  # in µs

MARKER: Final = np.dtype(
    [
        ("x", "f8"),
        ("y", "f8"),
        ("vx", "f8"),
        ("vy", "f8"),
        ("var_x", "f8"),
        ("cov_xv", "f8"),
        ("var_v", "f8"),
        ("t_us", "f8"),
        ("lead_x", "f8"),
        ("lead_y", "f8"),
        ("n_missed", "i8"),
        ("ahead_x", "f8"),
        ("ahead_y", "f8"),
        ("excess", "f8"),
        ("excess_hz", "f8"),
        ("padding", "f8"),
    ]
)
"""The filter's state of one marker, in two cache lines.

- ``x``, ``y``: position, px; ``vx``, ``vy``: velocity, px/s.
- ``var_x`` (px²), ``cov_xv`` (px²/s) and ``var_v`` (px²/s²): variance of the position, covariance
  of position and velocity, variance of the velocity. Both axes share them.
- ``t_us``: the time of all these, µs.
- ``lead_x``, ``lead_y``: a moving marker makes ON events this far ahead of its centre, px, and OFF
  events this far behind it.
- ``n_missed``: sharp frames in a row that did not show it.
- ``ahead_x``, ``ahead_y``: over the events since the last check, the sum of how far ON events were
  ahead of where they were expected, and OFF events behind, px.
- ``excess``: how many more of these events were ON than OFF.
- ``excess_hz``: the recent mean of that per second.
"""

COMMON: Final = np.dtype(
    [
        ("next_check_us", "i8"),
        ("n_checks", "i8"),
        ("n_repairs", "i8"),
        ("last_frame_us", "i8"),
        ("placed_us", "i8"),
        ("frame_gap_us", "i8"),
        ("followed", "i8"),
        ("noise_hz", "f8"),
        ("rest_noise_hz", "f8"),
        ("frames_alone", "?"),
        ("counts_steps", "?"),
        ("event_lag", "f8"),
        ("learnt_px", "f8"),
        ("learnt_steps", "f8"),
    ],
    align=True,
)
"""The filter's state of all markers together.

- ``next_check_us``: the time of the next check, µs.
- ``n_checks``: checks so far.
- ``n_repairs``: how often a marker was moved to the place that its neighbours gave.
- ``last_frame_us``: the end of the last frame that showed the markers, µs.
- ``placed_us``: when the markers were first placed, µs.
- ``frame_gap_us``: the time between the last two frames that showed the markers.
- ``followed``: the number of the check in which steps have moved slow markers last.
- ``noise_hz``: events per second of a marker that does not move.
- ``rest_noise_hz``: the same when a frame last showed the gel at rest. A long motion of the whole
  gel is taken for noise.
- ``frames_alone``: no events come; each frame moves the tracks from where the last one left them.
- ``counts_steps``: the steps of the pixels move slow markers, see ``needs_steps``.
- ``event_lag``: how far all events are behind their marker, as a share of the lead.
- ``learnt_px``, ``learnt_steps``: motion of markers without frames, and the steps that it took.
"""


class Tracks(NamedTuple):
    """The state of n markers.

    Attributes:
        state: (n,) ``MARKER``.
        targets: where events are expected up to the next check: where each marker will be then,
            because tracks lag a little.
        n_new: (n,) int64, number of events of each marker since the last check.
        rate_hz: (n,) float64, recent events of each marker per second.
        r_px2: (n, 2) float64, present variance of an OFF and of an ON event about its marker's
            centre.
        lost: (n,) bool, True where the position is a guess.
        rest_px: (n, 2) float64, positions of the undeformed gel.
        neighbours: (n, 8) intp, -1 where there is none.
        steps: (n, 2) float64, without frames the sum of the directions of the events of each marker
            that have not moved it yet: from it to an ON event, from an OFF event to it.
        steps_s: (n, 2) float64, the ``steps`` per second that have moved it last.
        long_steps_s: (n, 2) float64, the same over a longer time.
        moved_px_s: (n, 2) float64 px/s, the recent mean velocity of each marker.
        past_px: (k, n, 2) float64, ring of the positions at the last k checks.
        past_us: (k,) int64, the times of these checks, -1 where there is none.
        common: (1,) ``COMMON``.
    """

    state: NDArray[np.void]
    targets: Targets
    n_new: NDArray[np.int64]
    rate_hz: NDArray[np.float64]
    r_px2: NDArray[np.float64]
    lost: NDArray[np.bool_]
    rest_px: NDArray[np.float64]
    neighbours: NDArray[np.intp]
    steps: NDArray[np.float64]
    steps_s: NDArray[np.float64]
    long_steps_s: NDArray[np.float64]
    moved_px_s: NDArray[np.float64]
    past_px: NDArray[np.float64]
    past_us: NDArray[np.int64]
    common: NDArray[np.void]


class Tuning(NamedTuple):
    """Constants of the filter and the check; ``TrackerConfig`` explains them."""

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


@kernel(inline="always")
def _fade(elapsed_us: float, memory_s: float) -> float:
    """Returns the time for which a marker has moved on since its last event, s; velocity fades."""
    dt = min(max(elapsed_us * SECOND, 0.0), memory_s)
    return dt * (1.0 - 0.5 * dt / memory_s)


@kernel
def predict(t_us: float, memory_s: float, tracks: Tracks, out_px: NDArray[np.float64]) -> None:
    """Writes where every marker is at ``t_us``, (n, 2) float64 px."""
    for i in range(len(tracks.state)):
        s = tracks.state[i]
        step = _fade(t_us - s.t_us, memory_s)
        out_px[i, 0] = s.x + s.vx * step
        out_px[i, 1] = s.y + s.vy * step


@kernel
def go_on(t_us: float, memory_s: float, tracks: Tracks, out_px: NDArray[np.float64]) -> None:
    """Writes where every marker is at ``t_us`` after frames alone, (n, 2) float64 px.

    A gel that comes back stops at rest, but its velocity is that between two frames, when it was
    faster. So it slows down in proportion to the way that is left, and never goes beyond rest.
    """
    for i in range(len(tracks.state)):
        s, rest_px = tracks.state[i], tracks.rest_px[i]
        step = _fade(t_us - s.t_us, memory_s)
        x, y = s.x - rest_px[0], s.y - rest_px[1]
        back = -step * (s.vx * x + s.vy * y)
        if back > 0.0:
            back /= x * x + y * y  # the share of the way that it would go at its velocity
            step *= -math.expm1(-back) / back
        out_px[i, 0], out_px[i, 1] = s.x + s.vx * step, s.y + s.vy * step


@kernel(inline="always")
def _aim_at(x: float, y: float, i: int, tracks: Tracks) -> None:
    s, aim_px = tracks.state[i], tracks.targets.aim_px[i]
    on, off = 1.0 - tracks.common[0].event_lag, -1.0 - tracks.common[0].event_lag
    aim_px[0, 0], aim_px[0, 1] = x + off * s.lead_x, y + off * s.lead_y
    aim_px[1, 0], aim_px[1, 1] = x + on * s.lead_x, y + on * s.lead_y


@kernel
def aim(t_us: float, tracks: Tracks, tuning: Tuning) -> None:
    """Updates where events are expected: where the markers will be at ``t_us``."""
    for i in range(len(tracks.state)):
        s = tracks.state[i]
        step = _fade(t_us - s.t_us, tuning.memory_s)
        _aim_at(s.x + s.vx * step, s.y + s.vy * step, i, tracks)
    list_markers(tracks.targets)


@kernel
def place(
    markers: NDArray[np.intp],
    at_px: NDArray[np.float64],
    variance_px2: float,
    t_us: float,
    tracks: Tracks,
    tuning: Tuning,
) -> None:
    """Places markers, without velocity, where they are known to be.

    Their past moves as well, so that a late frame does not correct them twice.

    Args:
        markers: (k,) intp.
        at_px: (k, 2) float64 px.
        variance_px2: of these positions.
        t_us: their time.
        tracks: updated.
        tuning: of the filter.
    """
    for k in range(len(markers)):
        i = markers[k]
        s = tracks.state[i]
        step = _fade(t_us - s.t_us, tuning.memory_s)
        dx, dy = at_px[k, 0] - s.x - s.vx * step, at_px[k, 1] - s.y - s.vy * step
        for slot in range(len(tracks.past_px)):
            tracks.past_px[slot, i, 0] += dx
            tracks.past_px[slot, i, 1] += dy
        s.x, s.y, s.vx, s.vy, s.t_us = at_px[k, 0], at_px[k, 1], 0.0, 0.0, t_us
        s.var_x, s.cov_xv, s.var_v = variance_px2, 0.0, 100.0
        _aim_at(s.x, s.y, i, tracks)
    list_markers(tracks.targets)


@kernel
def note_frame(end_us: int, tracks: Tracks) -> None:
    """Notes that a frame has shown the markers, whose exposure ended at ``end_us``."""
    common = tracks.common[0]
    common.frame_gap_us = end_us - max(common.last_frame_us, common.placed_us)
    common.last_frame_us = end_us


@kernel
def shift(tracks: Tracks, markers: NDArray[np.intp], by_px: NDArray[np.float64]) -> None:
    """Moves ``markers`` (k,) by ``by_px`` (k, 2) float64, now and in the recorded past."""
    all_px = np.zeros((len(tracks.state), 2))
    for k in range(len(markers)):
        i = markers[k]
        dx, dy = by_px[k, 0], by_px[k, 1]
        s, aim_px = tracks.state[i], tracks.targets.aim_px[i]
        s.x, s.y = s.x + dx, s.y + dy
        for polarity in range(2):
            aim_px[polarity, 0] += dx
            aim_px[polarity, 1] += dy
        all_px[i, 0], all_px[i, 1] = dx, dy
    by = all_px.ravel()
    for slot in range(len(tracks.past_px)):
        past_px = tracks.past_px[slot].ravel()
        for k in range(len(by)):  # eight at once
            past_px[k] += by[k]
    list_markers(tracks.targets)

"""Compiled loops that follow slow markers by the polarity of their events.

A pixel tells the logarithm of its light: each event is a step by its threshold. A marker that moves
brightens the pixels ahead of it and darkens those behind it, by as many steps as its edge is high.
So each ON event tells that the marker has moved towards it, each OFF event that it has moved away,
all by the same small distance. Noise comes from all sides, in both polarities, and cancels. Where
events are tells less of a slow marker: they cannot be told from noise.
"""

import math

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.process.kernel_cache import kernel
from neurotouch_hid.tracker.kernels.neighbours import expect
from neurotouch_hid.tracker.kernels.tracks import Tracks, Tuning

RARE_US = 60_000  # between frames; at 25 frames/s each one comes sooner
NOISY_HZ = 80.0  # events of a marker at rest; as many as it makes by a motion of 2 px/s
REACH = 0.92  # of the gate; the edge of a marker is nearer to its middle
MIDDLE_PX = 1.0  # events nearer to the middle tell the direction less surely
STEPS_PER_PX = 78.0  # of a marker of usual contrast: simulated, white on black, thresholds of 0.2
SLOW_PX_S = 15.0  # faster markers are followed by where their events are
ALONE = 0.5  # of the motion of its neighbours, by which a marker may differ: a hot pixel does
LONG_S = 0.2  # of steps, to tell this: in it even the slowest push makes several
LEAST_PX_S = 20.0  # the places of the events follow such a marker well ...
MOST_PX_S = 60.0  # ... and pixels are not yet too slow to count its steps
USUAL_PX = 20.0  # what is known before, in px of motion
MOST_PX = 5_000.0  # of motion that is remembered


@kernel
def needs_steps(t_us: int, tracks: Tracks) -> bool:
    """Returns True if frames show the markers seldom or no longer, or noise hides slow motion."""
    common = tracks.common[0]
    since_us = t_us - max(common.last_frame_us, common.placed_us)
    is_rare = max(since_us, common.frame_gap_us) >= RARE_US
    is_needed: bool = is_rare or common.rest_noise_hz >= NOISY_HZ
    return is_needed


@kernel
def add_steps(
    events: NDArray[np.void], pairs: NDArray[np.void], n: int, tracks: Tracks, tuning: Tuning
) -> None:
    """Adds the directions of the first ``n`` pairs of events and markers to ``tracks.steps``."""
    aim_px, steps = tracks.targets.aim_px, tracks.steps
    reach_px2 = (REACH * tuning.gate_px) ** 2
    for k in range(n):
        e, i = events[np.uint64(pairs[k].event)], np.uint64(pairs[k].marker)
        dx = e.x - 0.5 * (aim_px[i, 0, 0] + aim_px[i, 1, 0])
        dy = e.y - 0.5 * (aim_px[i, 0, 1] + aim_px[i, 1, 1])
        px2 = dx * dx + dy * dy
        if px2 < reach_px2:
            share = (1.0 if e.p else -1.0) / max(math.sqrt(px2), MIDDLE_PX)
            steps[i, 0] += share * dx
            steps[i, 1] += share * dy


@kernel(error_model="numpy")
def follow_steps(
    dt: float,
    before_px: NDArray[np.float64],
    now_px: NDArray[np.float64],
    tracks: Tracks,
    tuning: Tuning,
) -> None:
    """Moves slow markers as the steps of their pixels tell; forgets these steps.

    A marker and its neighbours move alike, so their median limits what noise does to one.

    Args:
        dt: time since the last check, s.
        before_px: (n, 2) float64 px, the positions then.
        now_px: (n, 2) float64 px, the positions now; updated.
        tracks: updated.
        tuning: of the filter.
    """
    common, steps, steps_s = tracks.common[0], tracks.steps, tracks.steps_s
    n, moved_s, long_steps_s = len(steps), tracks.moved_px_s, tracks.long_steps_s
    share, long_share = -math.expm1(-dt / tuning.rate_s), -math.expm1(-dt / LONG_S)
    for i in range(n):
        for axis in range(2):
            steps_s[i, axis] += share * (steps[i, axis] / dt - steps_s[i, axis])
            long_steps_s[i, axis] += long_share * (steps[i, axis] / dt - long_steps_s[i, axis])
            moved_px = now_px[i, axis] - before_px[i, axis]
            moved_s[i, axis] += share * (moved_px / dt - moved_s[i, axis])
            steps[i, axis] = 0.0
    _learn(dt, tracks)
    px = (USUAL_PX + common.learnt_px) / (STEPS_PER_PX * USUAL_PX + common.learnt_steps)
    around_s, spread, nothing = np.empty((n, 2)), np.empty(n), np.zeros((n, 2))
    long_around_s = np.empty((n, 2))
    expect(steps_s, ~tracks.lost, nothing, tracks.neighbours, around_s, spread)
    expect(long_steps_s, ~tracks.lost, nothing, tracks.neighbours, long_around_s, spread)
    for i in range(n):
        x, y = around_s[i, 0], around_s[i, 1]
        if not math.isfinite(x):
            continue
        trust = _trust(long_steps_s[i], long_around_s[i])
        x, y = x + trust * (steps_s[i, 0] - x), y + trust * (steps_s[i, 1] - y)
        x, y = px * x, px * y
        slow_s = dt / (1.0 + (x * x + y * y) / (SLOW_PX_S * SLOW_PX_S))
        s = tracks.state[i]
        s.x, s.y = s.x + slow_s * x, s.y + slow_s * y
        now_px[i, 0] += slow_s * x
        now_px[i, 1] += slow_s * y


@kernel(inline="always")
def _trust(own_s: NDArray[np.float64], around_s: NDArray[np.float64]) -> float:
    """Returns the share of its own difference from its neighbours that a marker may follow.

    Args:
        own_s: (2,) float64, the steps of the marker per second, over a long time.
        around_s: (2,) float64, those of its neighbours.
    """
    x, y = own_s[0] - around_s[0], own_s[1] - around_s[1]
    own = math.sqrt(x * x + y * y)
    most = ALONE * math.sqrt(around_s[0] * around_s[0] + around_s[1] * around_s[1])
    return most / own if own > most else 1.0


@kernel
def forget_steps(tracks: Tracks) -> None:
    """Forgets the steps and speeds, because frames come often again, or events are missing."""
    tracks.steps[:] = 0.0
    tracks.steps_s[:] = 0.0
    tracks.long_steps_s[:] = 0.0
    tracks.moved_px_s[:] = 0.0
    tracks.common[0].counts_steps = False


@kernel
def _learn(dt: float, tracks: Tracks) -> None:
    """Learns from markers that both ways follow how many steps a pixel of motion takes."""
    common, steps_s, moved_s = tracks.common[0], tracks.steps_s, tracks.moved_px_s
    for i in range(len(steps_s)):
        x, y = moved_s[i, 0], moved_s[i, 1]
        px_s = math.sqrt(x * x + y * y)
        if LEAST_PX_S < px_s < MOST_PX_S and not tracks.lost[i]:
            common.learnt_px += dt * px_s
            common.learnt_steps += dt * (x * steps_s[i, 0] + y * steps_s[i, 1]) / px_s
    if common.learnt_px > MOST_PX:
        common.learnt_px *= 0.5
        common.learnt_steps *= 0.5

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
OFTEN_US = 20_000  # as long as steps are averaged; a slow marker goes by 0.3 px in it
SELDOM_US = 100_000  # less than the past that is remembered
FEW_STEPS = 8.0  # of a marker; it has moved by a tenth of a pixel
SHOWN = 0.5  # of the motion that places of events show; a slow marker makes half of the usual steps


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


@kernel
def is_due(t_us: int, followed_us: int, tracks: Tracks) -> bool:
    """Returns True if steps have shown since ``followed_us`` that a marker moves, or long ago."""
    elapsed_us = t_us - followed_us
    if elapsed_us < OFTEN_US:
        return False
    n_many, steps = 0, tracks.steps.ravel()
    for k in range(len(steps)):  # eight at once
        n_many += abs(steps[k]) >= FEW_STEPS
    return n_many > 0 or elapsed_us >= SELDOM_US


@kernel(error_model="numpy")
def follow_steps(
    dt: float,
    before_px: NDArray[np.float64],
    now_px: NDArray[np.float64],
    tracks: Tracks,
    tuning: Tuning,
) -> None:
    """Moves slow markers as the steps of their pixels tell; takes these steps away.

    A marker and its neighbours move alike, so their median limits what noise does to one.

    Where a quick motion slows down, its last steps tell again what places of events have shown. In
    steady light these places stop short by as much. In light that flickers they do not, so there
    a share of what they have shown is taken away.

    Args:
        dt: time since the last call, s.
        before_px: (n, 2) float64 px, the positions then.
        now_px: (n, 2) float64 px, the positions now; updated.
        tracks: updated.
        tuning: of the filter.
    """
    common, steps_s, long_steps_s = tracks.common[0], tracks.steps_s, tracks.long_steps_s
    moved_s, shown = tracks.moved_px_s, SHOWN if common.event_lag > 0.0 else 0.0
    n, usable, nothing = len(steps_s), ~tracks.lost, np.zeros(now_px.shape)
    around_s, long_around_s, spread = np.empty((n, 2)), np.empty((n, 2)), np.empty(n)
    _average(dt, before_px.ravel(), now_px.ravel(), tracks, tuning)
    _learn(dt, tracks)
    px = (USUAL_PX + common.learnt_px) / (STEPS_PER_PX * USUAL_PX + common.learnt_steps)
    expect(steps_s, usable, nothing, tracks.neighbours, around_s, spread)
    expect(long_steps_s, usable, nothing, tracks.neighbours, long_around_s, spread)
    moves_px = around_s
    for i in range(n):  # a loop of its own and without branches: four markers at once
        x, y = around_s[i, 0], around_s[i, 1]
        long_x, long_y = long_around_s[i, 0], long_around_s[i, 1]
        own_x, own_y = long_steps_s[i, 0] - long_x, long_steps_s[i, 1] - long_y
        own2 = own_x * own_x + own_y * own_y + 1e-9
        trust = min(ALONE * math.sqrt((long_x * long_x + long_y * long_y) / own2), 1.0)
        x, y = px * (x + trust * (steps_s[i, 0] - x)), px * (y + trust * (steps_s[i, 1] - y))
        slow_s = dt / (1.0 + (x * x + y * y) / (SLOW_PX_S * SLOW_PX_S))
        moves_px[i, 0] = slow_s * (x - shown * moved_s[i, 0])
        moves_px[i, 1] = slow_s * (y - shown * moved_s[i, 1])
    for i in range(n):
        x, y = moves_px[i, 0], moves_px[i, 1]
        if math.isfinite(x):
            s = tracks.state[i]
            s.x, s.y = s.x + x, s.y + y
            now_px[i, 0] += x
            now_px[i, 1] += y


@kernel(error_model="numpy")
def _average(
    dt: float,
    before_px: NDArray[np.float64],
    now_px: NDArray[np.float64],
    tracks: Tracks,
    tuning: Tuning,
) -> None:
    """Takes a share of the steps, so that none is lost or counts twice, and updates the means.

    All in one row, so that the processor takes four at once.
    """
    steps, steps_s = tracks.steps.ravel(), tracks.steps_s.ravel()
    long_steps_s, moved_s, per_s = tracks.long_steps_s.ravel(), tracks.moved_px_s.ravel(), 1.0 / dt
    share, long_share = -math.expm1(-dt / tuning.rate_s), -math.expm1(-dt / LONG_S)
    for k in range(len(steps)):
        steps_s[k] = share * per_s * steps[k]
        long_steps_s[k] += long_share * (steps_s[k] - long_steps_s[k])
        steps[k] *= 1.0 - share
    for k in range(len(steps)):
        moved_s[k] += share * (per_s * (now_px[k] - before_px[k]) - moved_s[k])


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

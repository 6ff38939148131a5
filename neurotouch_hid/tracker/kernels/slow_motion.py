"""Compiled loops that follow slow markers by the polarity of their events.

A pixel counts the logarithm of its light: each event is one step of its threshold. A marker that
moves brightens the pixels ahead of it and darkens those behind it, by as many steps as its edge is
deep. So each ON event tells that the marker has moved towards it, each OFF event that it has moved
away, by the same small distance. Noise is on all sides and of both polarities, and cancels.
"""

import math

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.process.kernel_cache import kernel
from neurotouch_hid.tracker.kernels.neighbours import expect
from neurotouch_hid.tracker.kernels.tracks import SECOND, Tracks, Tuning, shift

REACH = 0.92  # of the gate; the edge of a marker is nearer to its middle
MIDDLE_PX = 1.0  # events nearer to the middle tell the direction less surely
PX_PER_EVENT = 1.0 / 78.0  # of a marker of usual contrast
SLOW_PX_S = 15.0  # faster markers are followed by where their events are
ALONE = 0.5  # of the motion of its neighbours, by which a marker may differ from them


@kernel
def add_flow(events: NDArray[np.void], pairs: NDArray[np.void], n: int, tracks: Tracks, tuning: Tuning) -> None:
    aim_px, flow = tracks.targets.aim_px, tracks.flow
    reach_px2 = (REACH * tuning.gate_px) ** 2
    for k in range(n):
        e, i = events[np.uint64(pairs[k].event)], np.uint64(pairs[k].marker)
        dx = e.x - 0.5 * (aim_px[i, 0, 0] + aim_px[i, 1, 0])
        dy = e.y - 0.5 * (aim_px[i, 0, 1] + aim_px[i, 1, 1])
        px2 = dx * dx + dy * dy
        if px2 < reach_px2:
            share = (1.0 if e.p else -1.0) / max(math.sqrt(px2), MIDDLE_PX)
            flow[i, 0] += share * dx
            flow[i, 1] += share * dy


@kernel(error_model="numpy")
def follow_flow(dt: float, tracks: Tracks, tuning: Tuning) -> None:
    n = len(tracks.state)
    flow, speed = tracks.flow, tracks.flow_px_s
    share = -math.expm1(-dt / tuning.rate_s)
    for i in range(n):
        for axis in range(2):
            now = flow[i, axis] * PX_PER_EVENT / dt
            speed[i, axis] += share * (now - speed[i, axis])
            flow[i, axis] = 0.0
    around, spread, nothing = np.empty((n, 2)), np.empty(n), np.zeros((n, 2))
    expect(speed, ~tracks.lost, nothing, tracks.neighbours, around, spread)
    by_px = np.zeros((n, 2))
    for i in range(n):
        mx, my = around[i]
        if not math.isfinite(mx):
            continue
        ox, oy = speed[i, 0] - mx, speed[i, 1] - my
        most = ALONE * math.sqrt(mx * mx + my * my) + 1e-9
        longer = max(math.sqrt(ox * ox + oy * oy) / most, 1.0)
        x, y = mx + ox / longer, my + oy / longer
        w = 1.0 / (1.0 + (x * x + y * y) / (SLOW_PX_S * SLOW_PX_S))
        by_px[i, 0], by_px[i, 1] = w * dt * x, w * dt * y
    for i in range(n):
        s = tracks.state[i]
        s.x += by_px[i, 0]
        s.y += by_px[i, 1]

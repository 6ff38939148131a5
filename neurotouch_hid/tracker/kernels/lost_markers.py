"""Compiled loop that decides from the neighbours which markers are lost, and found again.

Frames can do so too, see ``correction``.
"""

import math

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.process.kernel_cache import kernel
from neurotouch_hid.tracker.kernels.neighbours import (
    expect,
    find_collisions,
    find_strays,
    find_tears,
)
from neurotouch_hid.tracker.kernels.tracks import Tracks, Tuning, place

SEEN_HZ = 100.0  # two events within ``rate_us`` above the noise: a lost marker makes events again
SETTLED_PX = 1.5  # a lost marker so near to its expected place, among agreeing neighbours, is found
FRAMELESS_US = 500_000  # without a frame for this time, events have to find lost markers


@kernel
def update_lost_markers(
    t_us: int, position_px: NDArray[np.float64], tracks: Tracks, tuning: Tuning
) -> None:
    """Marks markers as lost that contradict their neighbours, and moves them between these.

    While there are no frames, a lost marker counts as found again as soon as its own events move it
    with its neighbours: nothing else finds it, and lost neighbours need its position.

    Args:
        t_us: now.
        position_px: (n, 2) float64, the positions now; those of lost markers are written.
        tracks: updated.
        tuning: of the filter.
    """
    n = len(position_px)
    expected, spread, stray = np.empty((n, 2)), np.empty(n), np.empty(n, np.bool_)
    rest_px, usable = tracks.rest_px, ~tracks.lost
    expect(position_px, usable, rest_px, tracks.neighbours, expected, spread)
    find_strays(position_px, expected, spread, tuning.max_stray_px, tuning.max_stray_ratio, stray)
    find_collisions(position_px, expected, tracks.neighbours, stray)
    find_tears(position_px, usable, rest_px, tracks.neighbours, tuning.max_stray_px, stray)
    astray = np.flatnonzero(stray & np.isfinite(expected[:, 0]))
    if len(astray):
        place(astray, expected[astray], 4.0, float(t_us), tracks, tuning)
        for i in astray:
            position_px[i] = expected[i]
            tracks.lost[i] = True
        tracks.common[0].n_repairs += len(astray)
    if t_us - tracks.common[0].last_frame_us < FRAMELESS_US:
        return
    noise = tracks.common[0].noise_hz
    least_hz = noise + tuning.n_sigma * math.sqrt(noise / (2.0 * tuning.rate_s)) + SEEN_HZ
    for k in range(n):
        if tracks.lost[k] and not stray[k] and tracks.rate_hz[k] > least_hz:
            off_px = max(
                abs(position_px[k, 0] - expected[k, 0]), abs(position_px[k, 1] - expected[k, 1])
            )
            tracks.lost[k] = not (off_px < SETTLED_PX and spread[k] < SETTLED_PX)  # NaN: lost

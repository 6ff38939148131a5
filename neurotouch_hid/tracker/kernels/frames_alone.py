"""Compiled loops that follow the markers from frame to frame where no events come between."""

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.process.kernel_cache import kernel
from neurotouch_hid.tracker.kernels.areas import find_usual_area
from neurotouch_hid.tracker.kernels.correction import GATE_PX, MAX_AREA_RATIO, MAX_MISSED
from neurotouch_hid.tracker.kernels.matching import match_points
from neurotouch_hid.tracker.kernels.neighbours import (
    expect,
    find_collisions,
    find_strays,
    find_tears,
)
from neurotouch_hid.tracker.kernels.tracks import SECOND, Tracks, Tuning, note_frame

LONGEST_US = 50_000  # a velocity that is older says nothing
ROUNDS = 6  # from a gel that is still to the middle of the fastest fingertip
SMOOTH_PX = 2.0  # neighbours differ by less in how far they are from their expected places ...
SMOOTH_RATIO = 2.0  # ... or by no more than so many spreads of these
COMMON_SHARE = 0.3  # of a change of velocity, from the neighbours; half would let ripples grow
STILL_PX = 1.0  # neighbours that go less far from frame to frame tell where a hidden marker is
RETURN_SHARE = 0.3  # of the way to where its neighbours say that a hidden marker is

LONE_PX = 0.3  # a marker goes no farther from where its neighbours do ...
LONE_RATIO = 2.0  # ... than this and so many spreads of them
SPECK_SHARE = 0.3  # of the usual area; a smaller blob is a speck beside a marker that is hidden
LEAST_SHARE = 3  # of three markers one is seen, or the picture or all tracks are wrong
NO_BLOB: Final = -1


@kernel
def _match_free(
    target_px: NDArray[np.float64],
    open_: NDArray[np.bool_],
    points_px: NDArray[np.float64],
    free: NDArray[np.bool_],
    blob: NDArray[np.int32],
) -> int:
    """Gives open markers the free blobs nearest to their targets; returns how many.

    Args:
        target_px: (n, 2) float64 px; NaN where no place is known.
        open_: (n,) bool, the markers without a blob.
        points_px: (m, 2) float64 px, the centroids of the blobs.
        free: (m,) bool, updated: the blobs without a marker.
        blob: (n,) int32, updated.
    """
    wanted = np.flatnonzero(open_ & np.isfinite(target_px[:, 0]))
    left = np.flatnonzero(free)
    match = np.empty(len(wanted), np.int32)
    if not len(wanted) or not len(left):
        return 0
    n = match_points(target_px[wanted], points_px[left], GATE_PX, match)
    for k in range(len(wanted)):
        if match[k] >= 0:
            blob[wanted[k]] = left[match[k]]
            free[left[match[k]]] = False
    return int(n)


@kernel
def pair_blobs(
    expected_px: NDArray[np.float64],
    points_px: NDArray[np.float64],
    begin: NDArray[np.int32],
    rest_px: NDArray[np.float64],
    neighbours: NDArray[np.intp],
    tuning: Tuning,
    blob: NDArray[np.int32],
    place_px: NDArray[np.float64],
) -> None:
    """Writes the blob and the place of each marker in a frame.

    Each marker gets the blob nearest to its expected place, where both agree. The others follow
    ring by ring: a marker is off its expected place as far as its neighbours are, because a hand
    that changes its speed takes them along. A marker loses a blob that would tear the gel, or
    that contradicts where its neighbours have gone from rest.

    Args:
        expected_px: (n, 2) float64 px, where each marker would be at its last velocity.
        points_px: (m, 2) float64 px, the centroids of the blobs.
        begin: (m + 1,) int32, where the pixels of each blob begin.
        rest_px: (n, 2) float64 px, the markers at rest.
        neighbours: (n, 8) intp, -1 where there is none.
        tuning: of the neighbour check.
        blob: (n,) int32, written; -1 where none is certain.
        place_px: (n, 2) float64 px, written: the blob, or the place that the neighbours give.
    """
    n = len(expected_px)
    most = MAX_AREA_RATIO * find_usual_area(begin, n)
    free = np.empty(len(points_px), np.bool_)
    for j in range(len(free)):
        free[j] = begin[j + 1] - begin[j] <= most  # a larger one contains two markers
    blob[:] = NO_BLOB
    seen, stray = np.zeros(n, np.bool_), np.empty(n, np.bool_)
    near_px, spread_px = expected_px.copy(), np.empty(n)
    for turn in range(ROUNDS):
        n_new = _match_free(near_px, ~seen, points_px, free, blob)
        for i in range(n):
            seen[i] = blob[i] >= 0
            place_px[i] = points_px[blob[i]] if seen[i] else expected_px[i]
        expect(place_px, seen, expected_px, neighbours, near_px, spread_px)
        find_strays(place_px, near_px, spread_px, SMOOTH_PX, SMOOTH_RATIO, stray)
        for i in range(n):
            if seen[i] and stray[i]:
                free[blob[i]], blob[i], seen[i] = True, NO_BLOB, False
                place_px[i] = near_px[i]
        if turn and not n_new:
            break
    for i in range(n):
        if not seen[i] and near_px[i, 0] == near_px[i, 0]:
            place_px[i] = near_px[i]
    # Where the neighbours have gone from rest tells who a marker is.
    for _ in range(2):
        expect(place_px, seen, rest_px, neighbours, near_px, spread_px)
        find_strays(
            place_px, near_px, spread_px, tuning.max_stray_px, tuning.max_stray_ratio, stray
        )
        find_collisions(place_px, near_px, neighbours, stray)
        find_tears(place_px, seen, rest_px, neighbours, tuning.max_stray_px, stray)
        n_stray = 0
        for i in range(n):
            if stray[i] and near_px[i, 0] == near_px[i, 0]:
                n_stray += 1
                if seen[i]:
                    free[blob[i]], blob[i], seen[i] = True, NO_BLOB, False
                place_px[i] = near_px[i]
        if not n_stray or not _match_free(near_px, ~seen, points_px, free, blob):
            break
        for i in range(n):
            if blob[i] >= 0 and not seen[i]:
                seen[i] = True
                place_px[i] = points_px[blob[i]]


@kernel
def _clip_lone(
    expected_px: NDArray[np.float64],
    blob: NDArray[np.int32],
    tracks: Tracks,
    place_px: NDArray[np.float64],
) -> None:
    """Pulls each blob that goes its own way in a slow gel towards where its neighbours have gone.

    A finger is wider than the pitch, so no dot goes far alone. Specks that touch a blob, and noise
    at its edge, move one blob.

    Args:
        expected_px: (n, 2) float64 px, where each marker would be at its last velocity.
        blob: (n,) int32, -1 where a marker has none.
        tracks: before the frame.
        place_px: (n, 2) float64 px, updated.
    """
    n = len(place_px)
    near_px, spread_px = np.empty((n, 2)), np.empty(n)
    expect(place_px, blob >= 0, expected_px, tracks.neighbours, near_px, spread_px)
    for i in range(n):
        s = tracks.state[i]
        # Written so that NaN, where too few neighbours are seen, is not slow.
        is_slow = math.hypot(near_px[i, 0] - s.x, near_px[i, 1] - s.y) < STILL_PX
        if blob[i] < 0 or not is_slow:
            continue
        x, y = place_px[i, 0] - near_px[i, 0], place_px[i, 1] - near_px[i, 1]
        share = (LONE_PX + LONE_RATIO * spread_px[i]) / max(math.hypot(x, y), 1e-9)
        if share < 1.0:
            place_px[i, 0], place_px[i, 1] = near_px[i, 0] + share * x, near_px[i, 1] + share * y


@kernel
def _leave_specks(
    blob: NDArray[np.int32],
    begin: NDArray[np.int32],
    tracks: Tracks,
    place_px: NDArray[np.float64],
) -> None:
    """Moves markers of which only a speck is seen to where their neighbours have gone from rest.

    Where a marker runs together with the bright border of the gel, a speck beside it passes for it,
    a pixel off, and looks like a finger at the rim. The neighbours tell more while they have hardly
    left their places at rest; a faint marker stays right then, too.

    Args:
        blob: (n,) int32, -1 where a marker has none.
        begin: (m + 1,) int32, where the pixels of each blob begin.
        tracks: before the frame.
        place_px: (n, 2) float64 px, updated.
    """
    n, rest_px = len(place_px), tracks.rest_px
    least = SPECK_SHARE * find_usual_area(begin, n)
    whole, n_specks = np.empty(n, np.bool_), 0
    for i in range(n):
        whole[i] = blob[i] >= 0 and begin[blob[i] + 1] - begin[blob[i]] >= least
        n_specks += blob[i] >= 0 and not whole[i]
    if not n_specks:
        return
    near_px, spread_px = np.empty((n, 2)), np.empty(n)
    expect(place_px, whole, rest_px, tracks.neighbours, near_px, spread_px)
    for i in range(n):
        x, y = near_px[i, 0] - rest_px[i, 0], near_px[i, 1] - rest_px[i, 1]
        if blob[i] >= 0 and not whole[i] and math.hypot(x, y) < STILL_PX:
            place_px[i, 0], place_px[i, 1] = near_px[i, 0], near_px[i, 1]


@kernel
def _calm(elapsed_s: float, blob: NDArray[np.int32], tracks: Tracks) -> None:
    """Gives markers of a slow gel the velocity of their neighbours, and places hidden ones there.

    A velocity comes from two blobs, so it is noisier than either. What is expected between two
    frames would be off by half as much again as a blob, and a marker without blobs would drift away
    from a gel at rest. Where neighbours are fast, they differ by more than that noise.

    Args:
        elapsed_s: time since the last frame.
        blob: (n,) int32, -1 where a marker has none.
        tracks: updated.
    """
    state, rest_px = tracks.state, tracks.rest_px
    n = len(state)
    calm = np.empty((n, 2))
    for i in range(n):
        x, y, vx, vy, used = 0.0, 0.0, 0.0, 0.0, 0
        calm[i, 0], calm[i, 1] = state[i].vx, state[i].vy
        for k in range(8):
            j = tracks.neighbours[i, k]
            if j >= 0 and blob[j] >= 0:
                s = state[j]
                x, y, used = x + s.x - rest_px[j, 0], y + s.y - rest_px[j, 1], used + 1
                vx, vy = vx + s.vx, vy + s.vy
        way_px = elapsed_s * math.sqrt(vx * vx + vy * vy) / max(used, 1)
        if not used or way_px >= STILL_PX:
            continue
        s = state[i]
        if blob[i] >= 0:
            if elapsed_s * math.hypot(s.vx - vx / used, s.vy - vy / used) < STILL_PX:
                calm[i, 0], calm[i, 1] = (vx + s.vx) / (used + 1), (vy + s.vy) / (used + 1)
        else:
            calm[i, 0], calm[i, 1] = vx / used, vy / used
            s.x += RETURN_SHARE * (rest_px[i, 0] + x / used - s.x)
            s.y += RETURN_SHARE * (rest_px[i, 1] + y / used - s.y)
    for i in range(n):
        state[i].vx, state[i].vy = calm[i, 0], calm[i, 1]


@kernel
def follow(
    middle_us: int,
    end_us: int,
    points_px: NDArray[np.float64],
    begin: NDArray[np.int32],
    tracks: Tracks,
    tuning: Tuning,
) -> int:
    """Moves all tracks to the blobs of a frame and measures their velocities.

    Args:
        middle_us: the middle of the exposure: the time of the tracks from now on.
        end_us: its end.
        points_px: see ``pair_blobs``, as ``begin``.
        begin: where the pixels of each blob begin.
        tracks: changed, if the frame shows the gel.
        tuning: of the neighbour check.

    Returns:
        The number of markers that have a blob; 0 if the frame shows no gel.
    """
    state, n = tracks.state, len(tracks.state)
    if len(points_px) < n // LEAST_SHARE:
        return 0
    expected_px, place_px, change_px = np.empty((n, 2)), np.empty((n, 2)), np.empty((n, 2))
    for i in range(n):
        s = state[i]
        elapsed_us = middle_us - s.t_us
        step = elapsed_us * SECOND if 0.0 < elapsed_us <= LONGEST_US else 0.0
        expected_px[i, 0], expected_px[i, 1] = s.x + s.vx * step, s.y + s.vy * step
    blob = np.empty(n, np.int32)
    pair_blobs(
        expected_px, points_px, begin, tracks.rest_px, tracks.neighbours, tuning, blob, place_px
    )
    _clip_lone(expected_px, blob, tracks, place_px)
    _leave_specks(blob, begin, tracks, place_px)
    n_seen = 0
    for i in range(n):
        n_seen += blob[i] >= 0
        change_px[i] = place_px[i] - expected_px[i]
    if n_seen < n // LEAST_SHARE:
        return 0
    longest_us = 0.0
    for i in range(n):
        s = state[i]
        elapsed_us = middle_us - s.t_us
        longest_us = max(longest_us, elapsed_us)
        if elapsed_us > LONGEST_US:
            s.vx = s.vy = 0.0
        elif elapsed_us > 0.0:
            x, y, used = 0.0, 0.0, 0
            for k in range(8):
                j = tracks.neighbours[i, k]
                if j >= 0 and blob[j] >= 0:
                    x, y, used = x + change_px[j, 0], y + change_px[j, 1], used + 1
            own, common = (1.0 - COMMON_SHARE, COMMON_SHARE / used) if used else (1.0, 0.0)
            s.vx += (own * change_px[i, 0] + common * x) / (elapsed_us * SECOND)
            s.vy += (own * change_px[i, 1] + common * y) / (elapsed_us * SECOND)
        s.x, s.y, s.t_us = place_px[i, 0], place_px[i, 1], float(middle_us)
        s.n_missed = 0 if blob[i] >= 0 else s.n_missed + 1
        tracks.lost[i] = s.n_missed >= MAX_MISSED
    _calm(longest_us * SECOND, blob, tracks)
    note_frame(end_us, tracks)
    return n_seen

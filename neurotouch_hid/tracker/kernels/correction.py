"""Compiled loops that find how far tracks are off the blobs of a frame."""

import math

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.kernels.order_statistics import median
from neurotouch_hid.process.kernel_cache import kernel
from neurotouch_hid.tracker.kernels.filter import STILL_US
from neurotouch_hid.tracker.kernels.matching import match_points
from neurotouch_hid.tracker.kernels.neighbours import expect, find_strays
from neurotouch_hid.tracker.kernels.tracks import Tracks, Tuning, note_frame

GATE_PX = 3.5  # a third of the pitch, so another marker's blob is farther away
MAX_BLUR_PX = 2.0  # smeared markers merge with their neighbours
MAX_AREA_RATIO = 1.8  # to the median area; a larger blob contains two markers
MAX_MISSED = 3  # sharp frames without a blob before a marker counts as lost
MOST_AHEAD_US = 20_000  # a frame at rest may be newer than the last check: it is in the next slice
MIN_MATCHED = 60  # a third of the markers; with fewer, the picture or all tracks are wrong


@kernel
def recall(t_us: int, tracks: Tracks, out_px: NDArray[np.float64]) -> bool:
    """Writes all positions at a past time to (n, 2) px; False if the ring does not reach back."""
    past_us, n_checks = tracks.past_us, tracks.common[0].n_checks
    before = after = (n_checks - 1) % len(past_us)
    for back in range(len(past_us)):
        before = (n_checks - 1 - back) % len(past_us)
        if past_us[before] <= t_us:
            break
        after = before
    elapsed_us, span_us = t_us - past_us[before], past_us[after] - past_us[before]
    most_us = STILL_US if span_us else MOST_AHEAD_US
    if past_us[before] < 0 or elapsed_us < 0 or elapsed_us > most_us:
        return False
    part = elapsed_us / span_us if span_us else 0.0  # 0 if the time is after the last check
    for i in range(len(out_px)):
        for axis in range(2):
            one, other = tracks.past_px[before, i, axis], tracks.past_px[after, i, axis]
            out_px[i, axis] = one * (1.0 - part) + other * part
    return True


@kernel
def assign_blobs(
    then_px: NDArray[np.float64],
    sharp: NDArray[np.bool_],
    points_px: NDArray[np.float64],
    begin: NDArray[np.int32],
    tracks: Tracks,
    tuning: Tuning,
    blob: NDArray[np.int32],
) -> None:
    """Writes the blob of each track.

    First each track gets the nearest blob, if it is also the nearest track of that blob. Pairs
    whose place contradicts their neighbours are undone. Then lost markers get the blob nearest to
    the place that their neighbours give.

    Args:
        then_px: (n, 2) float64 px, the tracks in the middle of the exposure.
        sharp: (n,) bool, True for markers too slow to be smeared.
        points_px: (m, 2) float64 px, the centroids of the blobs.
        begin: (m + 1,) int32, where the pixels of each blob begin.
        tracks: the state of the markers; ``n_missed`` is updated.
        tuning: of the neighbour check.
        blob: (n,) int32, written; negative where none is certain.
    """
    n, m = len(then_px), len(points_px)
    area = np.empty(m, np.float64)
    for j in range(m):
        area[j] = begin[j + 1] - begin[j]
    merged = area > MAX_AREA_RATIO * median(area)
    match_points(then_px, points_px, GATE_PX, blob)
    lost = np.empty(n, np.bool_)
    for i in range(n):
        tracks.state[i].n_missed += sharp[i] and blob[i] == -1
        lost[i] = tracks.lost[i] or tracks.state[i].n_missed > 0
        if not sharp[i] or (blob[i] >= 0 and merged[blob[i]]):
            blob[i] = -1
    position_px, expected_px, spread_px = np.empty((n, 2)), np.empty((n, 2)), np.empty(n)
    stray, seen, free = np.empty(n, np.bool_), np.empty(n, np.bool_), np.empty(m, np.bool_)
    for _ in range(3):
        for i in range(n):
            seen[i] = blob[i] >= 0
            position_px[i] = points_px[blob[i]] if seen[i] else then_px[i]
        expect(position_px, seen, tracks.rest_px, tracks.neighbours, expected_px, spread_px)
        find_strays(
            position_px, expected_px, spread_px, tuning.max_stray_px, tuning.max_stray_ratio, stray
        )
        free[:] = ~merged
        for i in range(n):
            if stray[i]:
                blob[i] = min(blob[i], -1)
                lost[i] = True
            if blob[i] >= 0:
                free[blob[i]] = False
        open_ = np.flatnonzero((blob < 0) & lost & sharp & np.isfinite(expected_px[:, 0]))
        left, match = np.flatnonzero(free), np.empty(len(open_), np.int32)
        if not len(open_) or not match_points(expected_px[open_], points_px[left], GATE_PX, match):
            break
        for k in range(len(open_)):
            if match[k] >= 0:
                blob[open_[k]] = left[match[k]]


@kernel
def correct(
    tracks: Tracks,
    tuning: Tuning,
    begin_us: int,
    middle_us: int,
    end_us: int,
    points_px: NDArray[np.float64],
    begin: NDArray[np.int32],
) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Finds which tracks the blobs of a frame move, and by how much; the caller moves them.

    Compiled into this, the move would take six times as long.

    Args:
        tracks: changed.
        tuning: of the tracks.
        begin_us: the start of the exposure.
        middle_us: its middle; the blobs show where the markers were then.
        end_us: its end.
        points_px: see ``assign_blobs``, as ``begin``.
        begin: where the pixels of each blob begin.

    Returns:
        The markers (k,) intp and how far they are off, (k, 2) float64 px; none if the frame does
        not fit the tracks.
    """
    n = len(tracks.state)
    nobody, nowhere = np.empty(0, np.intp), np.empty((0, 2))
    begin_px, then_px, end_px = np.empty((n, 2)), np.empty((n, 2)), np.empty((n, 2))
    if not (
        len(points_px) >= MIN_MATCHED
        and recall(begin_us, tracks, begin_px)
        and recall(middle_us, tracks, then_px)
        and recall(end_us, tracks, end_px)
    ):
        return nobody, nowhere
    sharp, blob = np.empty(n, np.bool_), np.empty(n, np.int32)
    for i in range(n):
        dx, dy = end_px[i, 0] - begin_px[i, 0], end_px[i, 1] - begin_px[i, 1]
        sharp[i] = math.sqrt(dx * dx + dy * dy) <= MAX_BLUR_PX
    assign_blobs(then_px, sharp, points_px, begin, tracks, tuning, blob)
    seen = np.flatnonzero(blob >= 0)
    if len(seen) < MIN_MATCHED:
        return nobody, nowhere
    by_px = np.empty((len(seen), 2))
    for k in range(len(seen)):
        i = seen[k]
        by_px[k] = points_px[blob[i]] - then_px[i]
        tracks.state[i].n_missed = 0
        tracks.lost[i] = False
    note_frame(end_us, tracks)
    for i in range(n):
        if tracks.state[i].n_missed >= MAX_MISSED:
            tracks.lost[i] = True
    return seen, by_px


@kernel
def compare(
    tracks: Tracks,
    t_us: int,
    position_px: NDArray[np.float32],
    most_px: float,
    by_px: NDArray[np.float64],
    astray: NDArray[np.bool_],
) -> int:
    """Finds which tracks were elsewhere at a past time; those that were not count as found.

    Args:
        tracks: ``lost`` is updated.
        t_us: the time.
        position_px: (n, 2) float32 px, where the markers were then.
        most_px: a track that was farther off is astray.
        by_px: (n, 2) float64 px, written: how far off each track was; 0 if it is astray.
        astray: (n,) bool, written.

    Returns:
        How many are astray; -1 if the ring does not reach back, and then nothing has a meaning.
    """
    if not recall(t_us, tracks, by_px):
        return -1
    n_astray = 0
    for i in range(len(by_px)):
        dx, dy = position_px[i, 0] - by_px[i, 0], position_px[i, 1] - by_px[i, 1]
        astray[i] = math.hypot(dx, dy) > most_px
        n_astray += astray[i]
        if not astray[i] and tracks.state[i].n_missed < MAX_MISSED:
            tracks.lost[i] = False
        by_px[i, 0], by_px[i, 1] = (0.0, 0.0) if astray[i] else (dx, dy)
    return n_astray

"""The compiled loops that move tracks to the blobs of a frame."""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from neurotouch_hid.tracker.kernels.filter import STILL_US
from neurotouch_hid.tracker.kernels.matching import match_points
from neurotouch_hid.tracker.kernels.neighbours import expect, strays
from neurotouch_hid.tracker.kernels.tracks import Tracks, Tuning

GATE_PX = 3.5  # a third of the pitch: no other marker's blob
MAX_BLUR_PX = 2.0  # smeared markers merge with their neighbours
MAX_AREA_RATIO = 1.8  # to the median: two markers in one blob
MAX_MISSED = 3  # sharp frames without a blob before a marker counts as lost
MIN_MATCHED = 60  # a third; with fewer the picture or all tracks are wrong


@njit(cache=True, nogil=True)
def recall(t_us: int, tracks: Tracks, out_px: NDArray[np.float64]) -> bool:
    """Writes all positions at a past moment to out (n, 2); False if the ring does not reach it."""
    past_us, n_checks = tracks.past_us, tracks.common[0].n_checks
    before = after = (n_checks - 1) % len(past_us)
    for back in range(len(past_us)):
        before = (n_checks - 1 - back) % len(past_us)
        if past_us[before] <= t_us:
            break
        after = before
    elapsed_us, span_us = t_us - past_us[before], past_us[after] - past_us[before]
    if past_us[before] < 0 or elapsed_us < 0 or elapsed_us > STILL_US:
        return False
    part = elapsed_us / span_us if span_us else 0.0  # the moment is after the last check
    for i in range(len(out_px)):
        for axis in range(2):
            one, other = tracks.past_px[before, i, axis], tracks.past_px[after, i, axis]
            out_px[i, axis] = one * (1.0 - part) + other * part
    return True


@njit(cache=True, nogil=True)
def assign_blobs(
    then_px: NDArray[np.float64],
    sharp: NDArray[np.bool_],
    points_px: NDArray[np.float64],
    begin: NDArray[np.int32],
    missed: NDArray[np.intp],
    tracks: Tracks,
    tuning: Tuning,
    blob: NDArray[np.int32],
) -> None:
    """The blob of each track.

    First each to the nearest, if both agree. Pairs whose place does not fit their neighbours
    are undone; then lost markers look around the place the neighbours give them.

    Args:
        then_px: (n, 2) float64, where the tracks were.
        sharp: (n,) bool, too slow then to be smeared.
        points_px: (m, 2) float64, the centroids of the blobs.
        begin: (m + 1,) int32, where the pixels of each blob begin.
        missed: (n,) intp, sharp frames in a row without a blob; counted on.
        tracks: what is known about the markers.
        tuning: of the neighbour check.
        blob: (n,) int32, filled in; negative where none is certain.
    """
    n, m = len(then_px), len(points_px)
    area = np.empty(m, np.float64)
    for j in range(m):
        area[j] = begin[j + 1] - begin[j]
    merged = area > MAX_AREA_RATIO * np.median(area)
    match_points(then_px, points_px, GATE_PX, blob)
    lost = np.empty(n, np.bool_)
    for i in range(n):
        missed[i] += sharp[i] and blob[i] == -1
        lost[i] = tracks.lost[i] or missed[i] > 0
        if not sharp[i] or (blob[i] >= 0 and merged[blob[i]]):
            blob[i] = -1
    position_px, expected_px, spread_px = np.empty((n, 2)), np.empty((n, 2)), np.empty(n)
    stray, seen, free = np.empty(n, np.bool_), np.empty(n, np.bool_), np.empty(m, np.bool_)
    for _ in range(3):
        for i in range(n):
            seen[i] = blob[i] >= 0
            position_px[i] = points_px[blob[i]] if seen[i] else then_px[i]
        expect(position_px, seen, tracks.rest_px, tracks.neighbours, expected_px, spread_px)
        strays(
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


@njit(cache=True, nogil=True)
def correct(
    begin_us: int,
    t_us: int,
    end_us: int,
    points_px: NDArray[np.float64],
    begin: NDArray[np.int32],
    missed: NDArray[np.intp],
    tracks: Tracks,
    tuning: Tuning,
) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Find which tracks the blobs of a frame move, and by how much; the caller moves them.

    Compiled into this, the move would take six times as long.

    Args:
        begin_us: the begin of the exposure.
        t_us: its middle, which is when the blobs lay there.
        end_us: its end.
        points_px: see ``assign_blobs``, as ``begin`` and ``missed``.
        begin: where the pixels of each blob begin.
        missed: frames in a row in which a marker was not seen.
        tracks: changed.
        tuning: of the tracks.

    Returns:
        The markers (k,) and how far they are off (k, 2) px; none if the frame tells nothing.
    """
    n = len(tracks.state)
    nobody, nowhere = np.empty(0, np.intp), np.empty((0, 2))
    begin_px, then_px, end_px = np.empty((n, 2)), np.empty((n, 2)), np.empty((n, 2))
    if not (
        len(points_px) >= MIN_MATCHED
        and recall(begin_us, tracks, begin_px)
        and recall(t_us, tracks, then_px)
        and recall(end_us, tracks, end_px)
    ):
        return nobody, nowhere
    sharp, blob = np.empty(n, np.bool_), np.empty(n, np.int32)
    for i in range(n):
        dx, dy = end_px[i, 0] - begin_px[i, 0], end_px[i, 1] - begin_px[i, 1]
        sharp[i] = math.sqrt(dx * dx + dy * dy) <= MAX_BLUR_PX
    assign_blobs(then_px, sharp, points_px, begin, missed, tracks, tuning, blob)
    seen = np.flatnonzero(blob >= 0)
    if len(seen) < MIN_MATCHED:
        return nobody, nowhere
    by_px = np.empty((len(seen), 2))
    for k in range(len(seen)):
        i = seen[k]
        by_px[k] = points_px[blob[i]] - then_px[i]
        missed[i] = 0
        tracks.lost[i] = False
    tracks.common[0].last_frame_us = end_us
    for i in range(n):
        if missed[i] >= MAX_MISSED:
            tracks.lost[i] = True
    return seen, by_px


@njit(cache=True, nogil=True)
def median_size(v: NDArray[np.float64]) -> float:
    """The median length of vectors (n, 2)."""
    return float(np.median(np.sqrt(v[:, 0] ** 2 + v[:, 1] ** 2)))


@njit(cache=True, nogil=True)
def drift(
    off_px: NDArray[np.float64],
    share: float,
    touched_share: float,
    touch_px: float,
    most_px: float,
    rest_px: NDArray[np.float64],
) -> None:
    """Move rest positions by a share of what they are off.

    Args:
        off_px: (n, 2) float64, what they are off. The median of all is common to the whole gel.
        share: of what is common, and of what a marker is off beyond that ...
        touched_share: ... but of this the smaller share ...
        touch_px: ... where it is longer than this ...
        most_px: ... and none where it is longer than this.
        rest_px: (n, 2) float64, changed.
    """
    x, y = float(np.median(off_px[:, 0])), float(np.median(off_px[:, 1]))
    for i in range(len(off_px)):
        dx, dy = off_px[i, 0] - x, off_px[i, 1] - y
        size_px = math.sqrt(dx * dx + dy * dy)
        part = 0.0 if size_px > most_px else share if size_px <= touch_px else touched_share
        rest_px[i, 0] += share * x + part * dx
        rest_px[i, 1] += share * y + part * dy

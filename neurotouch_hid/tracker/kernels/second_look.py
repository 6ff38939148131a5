"""Compiled loops that tell markers apart again after a motion too quick for one look at a frame.

Between two frames dots may go farther than half of the pitch from where they were expected. So
other motions are tried, and the frame says which of them gives each dot its marker:

- the last motion and the last certain displacement, smaller or larger: while fingers stay, the gel
  keeps its shape;
- a finger that brings a marker to a dot that was left over.
"""

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.process.kernel_cache import kernel
from neurotouch_hid.tracker.kernels.frames_alone import pair_blobs
from neurotouch_hid.tracker.kernels.tracks import Tuning
from neurotouch_hid.tracker.kernels.unexplained import TAKEN_PX, count_unexplained

MOTIONS: Final = np.array([0.0, 0.5, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0])
"""Tried sizes of the last motion."""
STEP_PX = 5.0  # between two tried sizes of a displacement, where it is largest
MOST_PX = 50.0  # the largest displacement that is tried; the paper's hands reach 45 px
LEAST_PX = 2.0  # a smaller displacement has no clear shape
WAY_PX = 22.0  # no finger goes farther between two frames: 500 mm/s at 60 frames/s
FINGER_PX = 16.0  # radius of a fingertip's contact patch, as the picture shows it
MOST_DOTS = 3  # that were left over, from which a finger is tried
SAME_MARKERS = 3  # two looks that differ in no more markers are one
CLEAR = 2  # a look leaves fewer markers and dots over by this than any that differs


@kernel
def _list_fingers(
    points_px: NDArray[np.float64], now_px: NDArray[np.float64], seen: NDArray[np.bool_]
) -> NDArray[np.int64]:
    """Returns the pairs of a marker and a dot that no marker has, (k, 2) int64."""
    n, m = len(now_px), len(points_px)
    pairs, k, n_dots = np.empty((MOST_DOTS * n, 2), np.int64), 0, 0
    for j in range(m):
        is_free = True
        for i in range(n):
            dx, dy = points_px[j, 0] - now_px[i, 0], points_px[j, 1] - now_px[i, 1]
            is_free = is_free and not (seen[i] and dx * dx + dy * dy <= TAKEN_PX * TAKEN_PX)
        if not is_free or n_dots == MOST_DOTS:
            continue
        n_dots += 1
        for i in range(n):
            dx, dy = points_px[j, 0] - now_px[i, 0], points_px[j, 1] - now_px[i, 1]
            if TAKEN_PX * TAKEN_PX < dx * dx + dy * dy <= WAY_PX * WAY_PX:
                pairs[k, 0], pairs[k, 1] = i, j
                k += 1
    return pairs[:k]


@kernel
def _drag(
    from_px: NDArray[np.float64],
    rest_px: NDArray[np.float64],
    marker: int,
    to_px: NDArray[np.float64],
    expected_px: NDArray[np.float64],
) -> None:
    """Writes where a finger on a marker would bring all markers, (n, 2) float64 px.

    Around the finger the gel follows as an elastic half space does [Mindlin].
    """
    x, y = to_px[0] - from_px[marker, 0], to_px[1] - from_px[marker, 1]
    for i in range(len(from_px)):
        away = math.hypot(rest_px[i, 0] - rest_px[marker, 0], rest_px[i, 1] - rest_px[marker, 1])
        share = 1.0 if away <= FINGER_PX else 2.0 / math.pi * math.asin(FINGER_PX / away)
        expected_px[i, 0], expected_px[i, 1] = from_px[i, 0] + share * x, from_px[i, 1] + share * y


@kernel
def look_again(
    points_px: NDArray[np.float64],
    begin: NDArray[np.int32],
    before_px: NDArray[np.float64],
    way_px: NDArray[np.float64],
    certain_px: NDArray[np.float64],
    now_px: NDArray[np.float64],
    seen_now: NDArray[np.bool_],
    rest_px: NDArray[np.float64],
    neighbours: NDArray[np.intp],
    absent: NDArray[np.bool_],
    inner: NDArray[np.bool_],
    tuning: Tuning,
    blob: NDArray[np.int32],
    place_px: NDArray[np.float64],
) -> tuple[int, int, int, bool]:
    """Writes the blob and the place of each marker by the look that explains the frame best.

    Args:
        points_px: (m, 2) float64 px, the centroids of the blobs.
        begin: (m + 1,) int32, where the pixels of each blob begin.
        before_px: (n, 2) float64 px, the markers in the last frame, or in the last certain one.
        way_px: (n, 2) float64 px, how far each would go at its last velocity.
        certain_px: (n, 2) float64 px, the markers in the last frame that was certain.
        now_px: (n, 2) float64 px, the markers in this frame by the first look.
        seen_now: (n,) bool, the markers that have a blob by the first look.
        rest_px: (n, 2) float64 px, the markers at rest.
        neighbours: (n, 8) intp, -1 where there is none.
        absent: (n,) bool, markers that are not seen at rest either.
        inner: (n,) bool, markers that are not at the rim of the gel.
        tuning: of the neighbour check.
        blob: (n,) int32, written; -1 where none is certain.
        place_px: (n, 2) float64 px, written.

    Returns:
        The number of markers and the number of dots that this look does not explain, see
        ``count_unexplained``; the number of markers without a dot; False if another look, with
        other dots, is as good.
    """
    n, n_motions = len(rest_px), len(MOTIONS)
    largest_px = LEAST_PX
    for i in range(n):
        x, y = certain_px[i, 0] - rest_px[i, 0], certain_px[i, 1] - rest_px[i, 1]
        largest_px = max(largest_px, math.hypot(x, y))
    n_sizes = int(MOST_PX / STEP_PX) + 1 if largest_px > LEAST_PX else 1
    pairs = _list_fingers(points_px, now_px, seen_now)
    n_looks = n_motions + n_sizes + len(pairs)
    blobs, scores = np.empty((n_looks, n), np.int32), np.empty(n_looks, np.int64)
    expected_px, looked_px, seen = np.empty((n, 2)), np.empty((n, 2)), np.empty(n, np.bool_)
    best, least, n_markers, n_dots, n_hidden = 0, 3 * n + len(points_px), 0, 0, 0
    for look in range(n_looks):
        if look >= n_motions + n_sizes:
            marker, dot = pairs[look - n_motions - n_sizes]
            _drag(before_px, rest_px, marker, points_px[dot], expected_px)
        elif look >= n_motions:
            size = (look - n_motions) * STEP_PX / largest_px
            for i in range(n):
                for axis in range(2):
                    certain = certain_px[i, axis] - rest_px[i, axis]
                    expected_px[i, axis] = rest_px[i, axis] + size * certain
        else:
            for i in range(n):
                for axis in range(2):
                    expected_px[i, axis] = before_px[i, axis] + MOTIONS[look] * way_px[i, axis]
        pair_blobs(
            expected_px, points_px, begin, rest_px, neighbours, tuning, blobs[look], looked_px
        )
        n_unseen = 0
        for i in range(n):
            seen[i] = blobs[look, i] >= 0
            n_unseen += not (seen[i] or absent[i])
        vanished, strangers = count_unexplained(points_px, begin, looked_px, seen, absent, inner)
        # Also those that others may hide: a wrong motion squeezes markers together.
        scores[look] = vanished + strangers + n_unseen
        if scores[look] < least:
            best, least, n_hidden = look, scores[look], n_unseen
            n_markers, n_dots = vanished, strangers
            place_px[:] = looked_px
    is_unique = True
    for look in range(n_looks):
        n_other = 0
        for i in range(n):
            one, other = blobs[best, i], blobs[look, i]
            n_other += one >= 0 and other >= 0 and one != other
        is_rival = scores[look] < least + CLEAR
        is_unique = is_unique and not (is_rival and n_other > SAME_MARKERS)
    blob[:] = blobs[best]
    return n_markers, n_dots, n_hidden, is_unique

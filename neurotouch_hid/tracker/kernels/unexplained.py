"""Counts what contradicts that each track follows its own marker, in a picture of a still gel.

Where tracks follow their neighbours, some dots amid the gel belong to no track, and some tracks
have no dot though nothing hides it. Dots that a hand squeezes together run into each other: then
tracks lose their dots, but no dot is left over.
"""

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.process.kernel_cache import kernel
from neurotouch_hid.tracker.kernels.areas import find_usual_area
from neurotouch_hid.tracker.kernels.correction import MAX_AREA_RATIO
from neurotouch_hid.tracker.kernels.matching import find_rows, sort_by_row

LEAST_AREA_RATIO = 0.35  # to the usual area; a smaller blob is a speck
TAKEN_PX = 2.0  # a track is up to so far off its own dot, where it trusts its neighbours more
MERGED_PX = 4.5  # dots of 4 px, blurred, run together where they are nearer


@kernel
def count_unexplained(
    points_px: NDArray[np.float64],
    begin: NDArray[np.int32],
    place_px: NDArray[np.float64],
    seen: NDArray[np.bool_],
    absent: NDArray[np.bool_],
    inner: NDArray[np.bool_],
) -> tuple[int, int]:
    """Returns how many markers and how many dots are unexplained.

    Args:
        points_px: (m, 2) float64 px, the centroids of the blobs.
        begin: (m + 1,) int32, where the pixels of each blob begin.
        place_px: (n, 2) float64 px, the tracks; those with a dot are at its centroid.
        seen: (n,) bool, the tracks with a dot.
        absent: (n,) bool, markers that are not seen at rest either.
        inner: (n,) bool, markers that are not at the rim of the gel.

    Returns:
        The number of markers without a dot that no dot nearby hides, and the number of clear dots
        amid the gel that no track has.
    """
    n, m = len(place_px), len(points_px)
    usual = find_usual_area(begin, n)
    most, least = MAX_AREA_RATIO * usual, LEAST_AREA_RATIO * usual
    n_markers, n_dots = 0, 0
    for i in range(n):
        if seen[i] or absent[i]:
            continue
        near_px2 = np.inf
        for k in range(n):
            if seen[k]:
                dx, dy = place_px[k, 0] - place_px[i, 0], place_px[k, 1] - place_px[i, 1]
                near_px2 = min(near_px2, dx * dx + dy * dy)
        for j in range(m):
            if begin[j + 1] - begin[j] > most:
                dx, dy = points_px[j, 0] - place_px[i, 0], points_px[j, 1] - place_px[i, 1]
                near_px2 = min(near_px2, dx * dx + dy * dy)
        n_markers += near_px2 > MERGED_PX * MERGED_PX
    by_row, row_begin, top = sort_by_row(place_px)
    for j in range(m):
        if not least <= begin[j + 1] - begin[j] <= most:
            continue
        x, y = points_px[j, 0], points_px[j, 1]
        first, last = find_rows(y - TAKEN_PX - top, y + TAKEN_PX - top, row_begin)
        nearest, near_px2 = 0, np.inf
        for k in range(first, last):
            i = by_row[k]
            dx, dy = x - place_px[i, 0], y - place_px[i, 1]
            px2 = dx * dx + dy * dy
            if px2 < near_px2 or (px2 == near_px2 and seen[i]):
                nearest, near_px2 = i, px2
        if near_px2 <= TAKEN_PX * TAKEN_PX:
            n_dots += inner[nearest] and not seen[nearest]
            continue
        for i in range(n):
            dx, dy = x - place_px[i, 0], y - place_px[i, 1]
            if dx * dx + dy * dy < near_px2:
                nearest, near_px2 = i, dx * dx + dy * dy
        n_dots += inner[nearest]
    return n_markers, n_dots

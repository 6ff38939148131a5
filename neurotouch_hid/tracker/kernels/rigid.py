"""Compiled loops that measure how the rig has moved: what moves rigidly is the rig, not a touch."""

import math

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.kernels.order_statistics import median, select
from neurotouch_hid.process.kernel_cache import kernel
from neurotouch_hid.tracker.kernels.matching import (
    match_points,
    measure_largest,
    measure_sizes,
)

N_ROUNDS = 5  # of the robust fit
LEAST_SCALE_PX = 0.15  # errors of markers that are not touched
MOST_LEFT = 0.5  # of a rig's motion may be left; the light part of a touch is not that rigid
TURN_RATIO = 1.5  # a turn moves no marker farther than so many times the median of all
N_RECENTRE = 4  # steps towards the middle of the gel; each halves what is left, or better


@kernel
def recentre(
    points_px: NDArray[np.float64], centre_px: NDArray[np.float64], reach_px: float
) -> tuple[float, float]:
    """Returns how far the disc of markers has moved from its centre, x and y in px.

    The mean of all blobs on the gel is its middle: a shift of a whole pitch shows at the rim.

    Args:
        points_px: (m, 2) float64 px, the centroids of the blobs.
        centre_px: (2,) float64 px, where the middle of the markers was.
        reach_px: no marker is farther from it.
    """
    x, y = centre_px[0], centre_px[1]
    for _ in range(N_RECENTRE):
        sum_x, sum_y, n = 0.0, 0.0, 0
        for j in range(len(points_px)):
            dx, dy = points_px[j, 0] - x, points_px[j, 1] - y
            if dx * dx + dy * dy <= reach_px * reach_px:
                sum_x, sum_y, n = sum_x + dx, sum_y + dy, n + 1
        if n:
            x, y = x + sum_x / n, y + sum_y / n
    return x - centre_px[0], y - centre_px[1]


@kernel
def _fit_motion(
    before_px: NDArray[np.float64], now_px: NDArray[np.float64], match: NDArray[np.int32]
) -> tuple[float, float, float, float]:
    """Returns the shift, turn and scale that most markers share.

    A robust least squares, so that markers which a finger moves count little.

    Returns:
        Cosine and sine of the turn, each times the scale; the shift of the origin, x and y in px.
    """
    seen = np.flatnonzero(match >= 0)
    m = len(seen)
    c, s, x, y = 1.0, 0.0, 0.0, 0.0
    if m < 3:
        return c, s, x, y
    ax, ay, bx, by = np.empty(m), np.empty(m), np.empty(m), np.empty(m)
    for k in range(m):
        i = seen[k]
        ax[k], ay[k] = before_px[i, 0], before_px[i, 1]
        bx[k], by[k] = now_px[match[i], 0], now_px[match[i], 1]
    x, y = median(bx - ax), median(by - ay)
    off2, weight = np.empty(m), np.empty(m)
    for _ in range(N_ROUNDS):
        for k in range(m):
            dx, dy = bx[k] - c * ax[k] + s * ay[k] - x, by[k] - s * ax[k] - c * ay[k] - y
            off2[k] = dx * dx + dy * dy
        limit2 = max(4.0 * select(off2, m // 2), LEAST_SCALE_PX * LEAST_SCALE_PX)
        total = mx = my = px = py = 0.0
        for k in range(m):
            w = 1.0 / (1.0 + off2[k] / limit2)
            weight[k] = w * w
            total += weight[k]
            mx, my = mx + weight[k] * ax[k], my + weight[k] * ay[k]
            px, py = px + weight[k] * bx[k], py + weight[k] * by[k]
        mx, my, px, py = mx / total, my / total, px / total, py / total
        along = across = inertia = 0.0
        for k in range(m):
            ux, uy, vx, vy = ax[k] - mx, ay[k] - my, bx[k] - px, by[k] - py
            along += weight[k] * (ux * vx + uy * vy)
            across += weight[k] * (ux * vy - uy * vx)
            inertia += weight[k] * (ux * ux + uy * uy)
        if inertia <= 0.0:
            break
        c, s = along / inertia, across / inertia
        x, y = px - c * mx + s * my, py - s * mx - c * my
    return c, s, x, y


@kernel
def move_with_rig(
    before_px: NDArray[np.float64],
    now_px: NDArray[np.float64],
    match: NDArray[np.int32],
    out_px: NDArray[np.float64],
) -> None:
    """Writes where markers are that moved with the rig only: shift, turn and scale.

    Args:
        before_px: (n, 2) float64 px, columns x, y.
        now_px: (m, 2) float64 px.
        match: (n,) int32, the index in ``now_px`` of each marker; negative if it is not seen.
        out_px: (n, 2) float64 px, written; as before with fewer than three markers.
    """
    c, s, x, y = _fit_motion(before_px, now_px, match)
    for i in range(len(before_px)):
        out_px[i, 0] = c * before_px[i, 0] - s * before_px[i, 1] + x
        out_px[i, 1] = s * before_px[i, 0] + c * before_px[i, 1] + y


@kernel
def follow_rig(
    before_px: NDArray[np.float64],
    now_px: NDArray[np.float64],
    match: NDArray[np.int32],
    out_px: NDArray[np.float64],
) -> float:
    """Writes the same as ``move_with_rig``, which describes the arguments.

    Returns:
        The median distance by which the rig has moved the markers that are seen, px.
    """
    move_with_rig(before_px, now_px, match, out_px)
    off2, m = np.empty(len(before_px)), 0
    for i in range(len(before_px)):
        if match[i] >= 0:
            dx, dy = out_px[i, 0] - before_px[i, 0], out_px[i, 1] - before_px[i, 1]
            off2[m] = dx * dx + dy * dy
            m += 1
    return math.sqrt(select(off2[:m], m // 2)) if m else 0.0


@kernel
def creep(
    before_px: NDArray[np.float64],
    now_px: NDArray[np.float64],
    match: NDArray[np.int32],
    share: float,
    drawn_px: NDArray[np.float64],
) -> tuple[NDArray[np.float64], float]:
    """Returns places, (n, 2) float64 px, that follow a share of the way that the rig has moved.

    Args:
        before_px: see ``move_with_rig``, as the next two.
        now_px: where the markers are now.
        match: which of these belongs to each marker.
        share: of the way.
        drawn_px: (n, 2) float64 px, earlier places.

    Returns:
        The places; how far the farthest is from its earlier one, along x or y, px.
    """
    out_px = np.empty_like(before_px)
    move_with_rig(before_px, now_px, match, out_px)
    far_px = 0.0
    for i in range(len(out_px)):
        for axis in range(2):
            out_px[i, axis] = before_px[i, axis] + share * (out_px[i, axis] - before_px[i, axis])
            far_px = max(far_px, abs(out_px[i, axis] - drawn_px[i, axis]))
    return out_px, far_px


@kernel
def find_moved(
    place_px: NDArray[np.float64],
    centre_px: NDArray[np.float64],
    reach_px: float,
    points_px: NDArray[np.float64],
    gate_px: float,
    n_left_out: int,
    limit_px: float,
    least_found: float,
    n_unmoved: int,
    match: NDArray[np.int32],
) -> tuple[bool, NDArray[np.float64]]:
    """Finds out whether only the rig has moved.

    Args:
        place_px: (n, 2) float64 px, where the markers were.
        centre_px: (2,) float64 px, their middle.
        reach_px: no marker is farther from it.
        points_px: (m, 2) float64 px, the centroids of the blobs.
        gate_px: distance limit of a marker and its blob.
        n_left_out: markers that may be elsewhere.
        limit_px: for all others, how far a rig may leave them elsewhere.
        least_found: so many markers must be seen near their new places.
        n_unmoved: markers that are near their old places.
        match: (n,) int32, the blobs of these, see ``match_points``.

    Returns:
        False if the gel is touched or not seen; where the markers are if the rig has moved, (n, 2)
        float64 px.
    """
    moved_px, other = np.empty_like(place_px), np.empty(len(place_px), np.int32)
    x, y = recentre(points_px, centre_px, reach_px)
    shifted_px = place_px + np.array((x, y))
    n_seen = match_points(shifted_px, points_px, gate_px, other)
    # Specks beside the dots pull the middle of all blobs, but then it fits fewer markers.
    if n_seen < n_unmoved:
        x, y, n_seen = 0.0, 0.0, n_unmoved
        shifted_px[:], other[:] = place_px, match
    if not n_seen:
        return False, moved_px
    size_px = measure_sizes(shifted_px, points_px, other, n_seen)
    median_px = select(size_px, n_seen // 2)
    left_px = MOST_LEFT * math.sqrt(x * x + y * y + median_px * median_px)
    largest_px = select(size_px, max(n_seen - 1 - n_left_out, 0))
    if largest_px > TURN_RATIO * median_px + min(limit_px, left_px):
        return False, moved_px  # some markers are far off and most are not
    move_with_rig(shifted_px, points_px, other, moved_px)
    n_found, left_px = measure_largest(moved_px, points_px, gate_px, n_left_out, other)
    rig_px = median_size(moved_px - place_px)
    return n_found >= least_found and left_px <= min(limit_px, MOST_LEFT * rig_px), moved_px


@kernel
def median_size(v: NDArray[np.float64]) -> float:
    """Returns the median length of vectors (n, 2) float64."""
    return float(median(np.sqrt(v[:, 0] ** 2 + v[:, 1] ** 2)))

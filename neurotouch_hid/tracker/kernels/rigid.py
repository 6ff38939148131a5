"""Compiled loops that measure how the rig has moved: what moves rigidly is the rig, not a touch."""

import math

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.process.kernel_cache import kernel
from neurotouch_hid.tracker.kernels.matching import select

N_ROUNDS = 5  # of the robust fit
LEAST_SCALE_PX = 0.15  # errors of markers that are not touched
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
def follow_rig(
    before_px: NDArray[np.float64],
    now_px: NDArray[np.float64],
    match: NDArray[np.int32],
    out_px: NDArray[np.float64],
) -> float:
    """Writes where markers are that moved with the rig only: shift, turn and scale.

    A robust least squares, so that markers which a finger moves count little.

    Args:
        before_px: (n, 2) float64 px, columns x, y.
        now_px: (m, 2) float64 px.
        match: (n,) int32, the index in ``now_px`` of each marker; negative if it is not seen.
        out_px: (n, 2) float64 px, written.

    Returns:
        The median distance by which the rig has moved the markers that are seen, px.
    """
    n = len(before_px)
    seen = np.flatnonzero(match >= 0)
    m = len(seen)
    if m < 3:
        out_px[:] = before_px
        return 0.0
    ax, ay, bx, by = np.empty(m), np.empty(m), np.empty(m), np.empty(m)
    for k in range(m):
        i = seen[k]
        ax[k], ay[k] = before_px[i, 0], before_px[i, 1]
        bx[k], by[k] = now_px[match[i], 0], now_px[match[i], 1]
    c, s = 1.0, 0.0
    x, y = float(np.median(bx - ax)), float(np.median(by - ay))
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
    for i in range(n):
        out_px[i, 0] = c * before_px[i, 0] - s * before_px[i, 1] + x
        out_px[i, 1] = s * before_px[i, 0] + c * before_px[i, 1] + y
    for k in range(m):
        i = seen[k]
        off2[k] = (out_px[i, 0] - ax[k]) ** 2 + (out_px[i, 1] - ay[k]) ** 2
    return math.sqrt(select(off2, m // 2))

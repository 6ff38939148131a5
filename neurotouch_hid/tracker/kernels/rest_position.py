"""Compiled loops that move the rest position of the markers with the rig."""

import math

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.kernels.order_statistics import median
from neurotouch_hid.process.kernel_cache import kernel
from neurotouch_hid.tracker.kernels.rigid import follow_rig, median_size

MAX_DRIFT_PX = 1.0  # a marker farther off its rest position is being pushed, or the rig was bumped
MAX_OWN_PX = 1.0  # markers whose own errors are larger are others than those before
RIG_PX = 0.35  # a rig that has moved farther may swing
TOUCH_PX = 0.2  # a marker farther off than the rest of the gel is touched softly
MEAN_ANCHORS = 16  # the rest position begins as the mean of so many frames
NOISE_SIZES = 2.5  # medians of its size; random errors in a plane exceed it one time in 75


@kernel
def follow_rest(
    measured_px: NDArray[np.float64],
    n_mean: int,
    rig_share: float,
    creep_share: float,
    drift_share: float,
    touch_share: float,
    everyone: NDArray[np.int32],
    rest_px: NDArray[np.float64],
) -> int:
    """Moves the rest position with the rig: at once if it has moved far, else by a share.

    A rig that has just moved far still swings, so its place is then the mean of some frames. They
    also show each dot through other pixels, so its own place is learnt again: at first as the mean
    of the frames so far, then slowly.

    Args:
        measured_px: (n, 2) float64 px, the markers of a frame that shows the gel at rest.
        n_mean: frames in the mean that the rest position is.
        rig_share: of the way of a rig that may swing.
        creep_share: of the way of one that creeps or turns.
        drift_share: of what is left, which all markers share, and of their own errors.
        touch_share: of own errors that may be a soft touch.
        everyone: (n,) int32, 0 to n - 1.
        rest_px: (n, 2) float64 px, updated.

    Returns:
        The new ``n_mean``; 0 if these are other markers, which the caller takes as they are.
    """
    moved_px = np.empty_like(rest_px)
    far_px = follow_rig(rest_px, measured_px, everyone, moved_px)
    if far_px > MAX_DRIFT_PX:
        rest_px[:], n_mean = moved_px, 1
    else:
        share = rig_share if far_px > RIG_PX else creep_share
        if n_mean < MEAN_ANCHORS:
            share = max(share, 1.0 / (n_mean + 1))
        rest_px += share * (moved_px - rest_px)
    off_px = measured_px - rest_px
    if median_size(off_px) > MAX_OWN_PX:
        return 0
    if n_mean < MEAN_ANCHORS:
        n_mean += 1
        _average(off_px, n_mean, rest_px)
    drift(off_px, drift_share, touch_share, TOUCH_PX, MAX_DRIFT_PX, rest_px)
    return n_mean


@kernel
def _average(off_px: NDArray[np.float64], n_mean: int, rest_px: NDArray[np.float64]) -> None:
    """Takes each marker's own error into the mean that its place at rest is at first.

    A picture that is noisy or out of focus moves all markers, a soft touch only some.
    """
    n = len(off_px)
    x, y = median(off_px[:, 0].copy()), median(off_px[:, 1].copy())
    size_px = np.empty(n)
    for i in range(n):
        size_px[i] = math.hypot(off_px[i, 0] - x, off_px[i, 1] - y)
    most_px = max(TOUCH_PX, NOISE_SIZES * median(size_px))
    for i in range(n):
        if size_px[i] <= most_px:
            rest_px[i, 0] += (off_px[i, 0] - x) / n_mean
            rest_px[i, 1] += (off_px[i, 1] - y) / n_mean


@kernel
def drift(
    off_px: NDArray[np.float64],
    share: float,
    touched_share: float,
    touch_px: float,
    most_px: float,
    rest_px: NDArray[np.float64],
) -> None:
    """Moves rest positions by a share of their errors.

    The median error is common to the whole gel; the rest is each marker's own error.

    Args:
        off_px: (n, 2) float64 px, the errors.
        share: of the common error, and of an own error up to ``touch_px``.
        touched_share: the smaller share of an own error above ``touch_px``.
        touch_px: own errors above this are probably a soft touch.
        most_px: own errors above this are not corrected.
        rest_px: (n, 2) float64 px, updated.
    """
    x, y = median(off_px[:, 0].copy()), median(off_px[:, 1].copy())
    for i in range(len(off_px)):
        dx, dy = off_px[i, 0] - x, off_px[i, 1] - y
        size_px = math.sqrt(dx * dx + dy * dy)
        part = 0.0 if size_px > most_px else share if size_px <= touch_px else touched_share
        rest_px[i, 0] += share * x + part * dx
        rest_px[i, 1] += share * y + part * dy

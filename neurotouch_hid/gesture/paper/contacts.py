"""Finds the contacts: homography outliers, then local maxima of the displacement."""

import cv2
import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.gesture.paper.kernels.neighbourhoods import find_peaks

_MIN_POINTS = 4  # a homography has eight degrees of freedom
_NO_POINTS = np.zeros((0, 2))


def find_outliers(
    rest_px: NDArray[np.float64],
    position_px: NDArray[np.float64],
    threshold_px: float,
) -> NDArray[np.bool_]:
    """Returns the markers that leave the global pattern: S(t_k) [NT, "Contact Point Detection"].

    OpenCV's RANSAC starts from a fixed seed, so equal markers give equal results, bit for bit.

    Args:
        rest_px: (n, 2) float64 px, columns x, y.
        position_px: (n, 2) float64 px, the same markers now.
        threshold_px: reprojThreshold, > 0 (OpenCV replaces 0 by 3 px).

    Returns:
        (n,) bool; all False if no homography is found.
    """
    if len(rest_px) < _MIN_POINTS:
        return np.zeros(len(rest_px), np.bool_)
    matrix, inlier = cv2.findHomography(rest_px, position_px, cv2.RANSAC, threshold_px)
    if matrix is None:
        return np.zeros(len(rest_px), np.bool_)
    outlier: NDArray[np.bool_] = inlier.ravel() == 0
    return outlier


def find_contacts(
    rest_px: NDArray[np.float64],
    position_px: NDArray[np.float64],
    *,
    threshold_ratio: float,
    threshold_floor_px: float,
    radius_px: float,
    min_neighbours: int,
) -> NDArray[np.float64]:
    """Returns the contacts: outliers whose displacement no outlier around them exceeds.

    Differs: the reprojection threshold a·mean|v| has a floor. Near rest it would shrink below the
    tracker's noise, and noise would make outliers.
    Open in the paper: whether a marker counts as its own neighbour for N_min; it does here, as the
    definition of N(i, t_k) has it.

    Args:
        rest_px: (n, 2) float64 px, columns x, y; measured markers only.
        position_px: (n, 2) float64 px, the same markers now.
        threshold_ratio: a.
        threshold_floor_px: least reprojection threshold, px.
        radius_px: r.
        min_neighbours: N_min.

    Returns:
        (k, 2) float64 px, columns x, y, the strongest displacement first.
    """
    if not len(rest_px):
        return _NO_POINTS
    magnitude = np.linalg.norm(position_px - rest_px, axis=1)
    threshold = max(threshold_ratio * float(magnitude.mean()), threshold_floor_px)
    outlier = find_outliers(rest_px, position_px, threshold)
    peak = np.flatnonzero(find_peaks(position_px, magnitude, outlier, radius_px, min_neighbours))
    return position_px[peak[np.argsort(-magnitude[peak], kind="stable")]]

"""Where the fingers are: homography outliers, then local maxima of the displacement."""

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.gesture.kernels import find_homography_outliers, find_peaks

_CONFIDENCE, _MAX_ROUNDS = 0.995, 2000  # OpenCV's defaults, which the paper does not change
_NO_POINTS = np.zeros((0, 2))


def find_outliers(
    rest_px: NDArray[np.float64],
    position_px: NDArray[np.float64],
    threshold_px: float,
) -> NDArray[np.bool_]:
    """Markers that leave the global pattern: S(t_k) [NT, "Contact Point Detection"].

    Args:
        rest_px: (n, 2) float64 px, columns x, y, n >= 1.
        position_px: (n, 2) float64 px, the same markers now.
        threshold_px: reprojThreshold, > 0.

    Returns:
        (n,) bool; equal markers give equal answers, bit for bit.
    """
    centre = rest_px.mean(axis=0)
    scale = 1 / max(float(np.abs(rest_px - centre).max()), 1.0)
    outlier: NDArray[np.bool_] = find_homography_outliers(
        (rest_px - centre) * scale,
        (position_px - centre) * scale,
        threshold_px * scale,
        _CONFIDENCE,
        _MAX_ROUNDS,
    )
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
    """Contact points: outliers whose displacement no outlier around them exceeds.

    Differs: the reprojection threshold a·mean|v| has a floor. Near rest it shrinks below the
    tracker's noise, and then the noise makes the outliers.
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

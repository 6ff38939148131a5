"""Compiled loops over the neighbourhoods of markers: their maxima, members and means."""

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.process.kernel_cache import kernel


@kernel
def find_peaks(
    position_px: NDArray[np.float64],
    magnitude_px: NDArray[np.float64],
    candidate: NDArray[np.bool_],
    radius_px: float,
    min_neighbours: int,
) -> NDArray[np.bool_]:
    """Returns the candidates that no candidate within the radius exceeds.

    [NT, "Contact Point Detection"].

    Args:
        position_px: (n, 2) float64 px, columns x, y.
        magnitude_px: (n,) float64 px, length of each marker's displacement.
        candidate: (n,) bool, the subsample S(t_k).
        radius_px: r; the neighbourhood is closed (distance <= r).
        min_neighbours: N_min, the marker itself included as in the definition of N(i, t_k).

    Returns:
        (n,) bool, True for the markers of I_max(t_k).
    """
    n = len(magnitude_px)
    peak = np.zeros(n, np.bool_)
    limit = radius_px * radius_px
    for i in range(n):
        if not candidate[i]:
            continue
        count = 0
        highest = True
        for j in range(n):
            if not candidate[j]:
                continue
            dx = position_px[i, 0] - position_px[j, 0]
            dy = position_px[i, 1] - position_px[j, 1]
            if dx * dx + dy * dy <= limit:
                count += 1
                if magnitude_px[j] > magnitude_px[i]:
                    highest = False
                    break
        peak[i] = highest and count >= min_neighbours
    return peak


@kernel
def find_near(
    position_px: NDArray[np.float64], points_px: NDArray[np.float64], radius_px: float
) -> NDArray[np.bool_]:
    """Returns the markers nearer than the radius to any of the points: A(t_k).

    Args:
        position_px: (n, 2) float64 px, columns x, y.
        points_px: (k, 2) float64 px, columns x, y.
        radius_px: r; the neighbourhood is open (distance < r).

    Returns:
        (n,) bool.
    """
    near = np.zeros(len(position_px), np.bool_)
    limit = radius_px * radius_px
    for i in range(len(position_px)):
        for k in range(len(points_px)):
            dx = position_px[i, 0] - points_px[k, 0]
            dy = position_px[i, 1] - points_px[k, 1]
            if dx * dx + dy * dy < limit:
                near[i] = True
                break
    return near


@kernel
def smooth_displacement(
    rest_px: NDArray[np.float64], displacement_px: NDArray[np.float64], radius_px: float
) -> NDArray[np.float64]:
    """Returns the mean displacement of all markers within a radius of each marker, with itself.

    Args:
        rest_px: (n, 2) float64 px, columns x, y.
        displacement_px: (n, 2) float64 px.
        radius_px: the neighbourhood is closed (distance <= radius).

    Returns:
        (n, 2) float64 px.
    """
    n = len(rest_px)
    mean = np.zeros((n, 2))
    limit = radius_px * radius_px
    for i in range(n):
        count = 0
        for j in range(n):
            dx = rest_px[i, 0] - rest_px[j, 0]
            dy = rest_px[i, 1] - rest_px[j, 1]
            if dx * dx + dy * dy <= limit:
                mean[i, 0] += displacement_px[j, 0]
                mean[i, 1] += displacement_px[j, 1]
                count += 1
        mean[i] /= count
    return mean

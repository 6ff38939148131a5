"""Compiled loops of the gesture stage: local maxima, neighbourhoods, similarity."""

import numpy as np
from numba import njit
from numpy.typing import NDArray


@njit(cache=True, nogil=True)
def find_peaks(
    position_px: NDArray[np.float64],
    magnitude_px: NDArray[np.float64],
    candidate: NDArray[np.bool_],
    radius_px: float,
    min_neighbours: int,
) -> NDArray[np.bool_]:
    """Candidates that no candidate within the radius exceeds [NT, "Contact Point Detection"].

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


@njit(cache=True, nogil=True)
def find_near(
    position_px: NDArray[np.float64], points_px: NDArray[np.float64], radius_px: float
) -> NDArray[np.bool_]:
    """Markers nearer than the radius to any of the points: A(t_k).

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


@njit(cache=True, nogil=True)
def smooth_displacement(
    rest_px: NDArray[np.float64], displacement_px: NDArray[np.float64], radius_px: float
) -> NDArray[np.float64]:
    """Mean displacement of all markers within a radius of each marker, itself included.

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


@njit(cache=True, nogil=True)
def find_homography_outliers(
    source: NDArray[np.float64],
    target: NDArray[np.float64],
    threshold: float,
    confidence: float,
    max_rounds: int,
) -> NDArray[np.bool_]:
    """Points that the homography agreed on by the most points misses by more than a threshold.

    RANSAC: four random points, one homography, count the points it misses; the number of rounds
    shrinks as the share of inliers grows. The winner is fitted once more, to all its inliers. The
    random numbers start from the same seed in every call. OpenCV's findHomography does the same in
    0.6 to 0.9 ms for 177 points, most of it in its refinement; this takes a tenth of that.

    Args:
        source: (n, 2) float64, of the order of 1 around the origin.
        target: (n, 2) float64, where each point went.
        threshold: greatest distance of an inlier, same unit as the points.
        confidence: wanted probability that one round drew inliers only, 0..1.
        max_rounds: upper limit of rounds.

    Returns:
        (n,) bool; all True where no four points gave a homography.
    """
    n = len(source)
    outlier = np.ones(n, np.bool_)
    trial = np.ones(n, np.bool_)
    drawn = np.zeros(4, np.intp)
    h = np.zeros(8)
    state = np.uint64(1)
    fewest, rounds, done = n - 3, max_rounds, 0
    while done < rounds and n >= 4:
        done += 1
        state = _draw_four(state, n, drawn)
        if not _keep_orientation(source, target, drawn):
            continue
        if not _fit_homography(source, target, drawn, h):
            continue
        missed = _mark_missed(source, target, h, threshold, trial)
        if missed < fewest:
            fewest = missed
            outlier, trial = trial, outlier
            pure = (1.0 - missed / n) ** 4
            if pure >= 1.0:
                break
            rounds = min(rounds, int(np.ceil(np.log(1.0 - confidence) / np.log(1.0 - pure))))
    if fewest < n - 3 and _fit_homography(source, target, np.flatnonzero(~outlier), h):
        _mark_missed(source, target, h, threshold, outlier)
    return outlier


@njit(cache=True, nogil=True)
def _draw_four(state: np.uint64, n: int, drawn: NDArray[np.intp]) -> np.uint64:
    """Fills drawn with four different numbers below n; a 64-bit linear congruential generator."""
    k = 0
    while k < 4:
        state = state * np.uint64(6364136223846793005) + np.uint64(1442695040888963407)
        drawn[k] = (state >> np.uint64(33)) % np.uint64(n)
        fresh = True
        for m in range(k):
            fresh = fresh and drawn[m] != drawn[k]
        if fresh:
            k += 1
    return state


@njit(cache=True, nogil=True)
def _keep_orientation(
    source: NDArray[np.float64], target: NDArray[np.float64], drawn: NDArray[np.intp]
) -> bool:
    """True if no three of the four points lie on a line and no triangle is turned over."""
    for skip in range(4):
        a, b, c = drawn[(skip + 1) % 4], drawn[(skip + 2) % 4], drawn[(skip + 3) % 4]
        before = _double_area(source, a, b, c)
        after = _double_area(target, a, b, c)
        if before * after <= 0.0 or min(abs(before), abs(after)) < 1e-6:
            return False
    return True


@njit(cache=True, nogil=True)
def _double_area(points: NDArray[np.float64], a: int, b: int, c: int) -> float:
    ux, uy = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
    vx, vy = points[c, 0] - points[a, 0], points[c, 1] - points[a, 1]
    return float(ux * vy - uy * vx)


@njit(cache=True, nogil=True)
def _mark_missed(
    source: NDArray[np.float64],
    target: NDArray[np.float64],
    h: NDArray[np.float64],
    threshold: float,
    missed: NDArray[np.bool_],
) -> int:
    """Fills missed with the points a homography puts too far off; returns their number."""
    count = 0
    for i in range(len(source)):
        x, y = source[i, 0], source[i, 1]
        w = h[6] * x + h[7] * y + 1.0
        missed[i] = True
        if w > 0.0:
            dx = (h[0] * x + h[1] * y + h[2]) / w - target[i, 0]
            dy = (h[3] * x + h[4] * y + h[5]) / w - target[i, 1]
            missed[i] = dx * dx + dy * dy > threshold * threshold
        count += missed[i]
    return count


@njit(cache=True, nogil=True)
def _fit_homography(
    source: NDArray[np.float64],
    target: NDArray[np.float64],
    used: NDArray[np.intp],
    h: NDArray[np.float64],
) -> bool:
    """Fills h with the row-major homography (h33 = 1) of four or more point pairs.

    Least squares of the linear equations; False if they are singular.
    """
    m = np.zeros((8, 9))
    row = np.zeros(9)
    for i in used:
        x, y = source[i, 0], source[i, 1]
        for axis in range(2):
            goal = target[i, axis]
            row[:] = 0.0
            row[3 * axis], row[3 * axis + 1], row[3 * axis + 2] = x, y, 1.0
            row[6], row[7], row[8] = -goal * x, -goal * y, goal
            for j in range(8):
                if row[j] != 0.0:
                    for k in range(9):
                        m[j, k] += row[j] * row[k]
    return bool(_solve(m, h))


@njit(cache=True, nogil=True)
def _solve(m: NDArray[np.float64], h: NDArray[np.float64]) -> bool:
    """Gauss elimination of the (8, 9) system m, which it spoils; False if it is singular."""
    for column in range(8):
        pivot = column + np.argmax(np.abs(m[column:, column]))
        if abs(m[pivot, column]) < 1e-12:
            return False
        for k in range(column, 9):
            m[column, k], m[pivot, k] = m[pivot, k], m[column, k]
        for row in range(column + 1, 8):
            factor = m[row, column] / m[column, column]
            for k in range(column, 9):
                m[row, k] -= factor * m[column, k]
    for row in range(7, -1, -1):
        total = m[row, 8]
        for k in range(row + 1, 8):
            total -= m[row, k] * h[k]
        h[row] = total / m[row, row]
    return True

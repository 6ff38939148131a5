"""Slow plain twins of the kernels of the gesture stage."""

import itertools
import math

import numpy as np


def find_peaks(position, magnitude, candidate, radius, min_neighbours):
    subset = [i for i in range(len(magnitude)) if candidate[i]]
    peaks = []
    for i in range(len(magnitude)):
        around = [j for j in subset if math.dist(position[i], position[j]) <= radius]
        highest = all(magnitude[i] >= magnitude[j] for j in around)
        peaks.append(i in subset and highest and len(around) >= min_neighbours)
    return peaks


def find_near(position, points, radius):
    return [any(math.dist(p, q) < radius for q in points) for p in position]


def find_homography_outliers(source, target, threshold, confidence, max_rounds):
    n = len(source)
    best, rounds, done, state = None, max_rounds, 0, 1
    while n >= 4 and done < rounds:
        done += 1
        drawn = []
        while len(drawn) < 4:
            state = (state * 6364136223846793005 + 1442695040888963407) % 2**64
            number = (state >> 33) % n
            # a repeated number is drawn again
            if number not in drawn:
                drawn.append(number)
        if _degenerate(source, target, drawn):
            continue
        h = _fit(source, target, drawn)
        missed = _missed(source, target, h, threshold)
        if sum(missed) < (n - 3 if best is None else sum(best)):
            best = missed
            pure = (1 - sum(missed) / n) ** 4
            if pure == 1:
                break
            rounds = min(rounds, math.ceil(math.log(1 - confidence) / math.log(1 - pure)))
    if best is None:
        return [True] * n
    inliers = [i for i in range(n) if not best[i]]
    return _missed(source, target, _fit(source, target, inliers), threshold)


def _degenerate(source, target, drawn):
    for triple in itertools.combinations(drawn, 3):
        before, after = (
            np.linalg.det(np.c_[p[list(triple)], np.ones(3)]) for p in (source, target)
        )
        if before * after <= 0 or min(abs(before), abs(after)) < 1e-6:
            return True
    return False


def _fit(source, target, used):
    rows, goals = [], []
    for i in used:
        (x, y), (u, v) = source[i], target[i]
        rows += [[x, y, 1, 0, 0, 0, -u * x, -u * y], [0, 0, 0, x, y, 1, -v * x, -v * y]]
        goals += [u, v]
    h = np.linalg.lstsq(np.array(rows), np.array(goals), rcond=None)[0]
    return np.append(h, 1.0).reshape(3, 3)


def _missed(source, target, h, threshold):
    result = []
    for p, q in zip(source, target, strict=True):
        x, y, w = h @ (*p, 1.0)
        result.append(bool(w <= 0 or math.dist((x / w, y / w), q) > threshold))
    return result


def smooth_displacement(rest, displacement, radius):
    means = []
    for p in rest:
        near = [v for q, v in zip(rest, displacement, strict=True) if math.dist(p, q) <= radius]
        means.append([math.fsum(v[axis] for v in near) / len(near) for axis in (0, 1)])
    return means

"""Slow plain twins of the kernels of the gesture stage."""

import math


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


def smooth_displacement(rest, displacement, radius):
    means = []
    for p in rest:
        near = [v for q, v in zip(rest, displacement, strict=True) if math.dist(p, q) <= radius]
        means.append([math.fsum(v[axis] for v in near) / len(near) for axis in (0, 1)])
    return means


def displace(rest, position, valid):
    """The motion of each marker, None where it is not known."""
    steps = []
    for p, q, seen in zip(position, rest, valid, strict=True):
        known = seen and all(math.isfinite(v) for v in p)
        steps.append([p[0] - q[0], p[1] - q[1]] if known else None)
    return steps

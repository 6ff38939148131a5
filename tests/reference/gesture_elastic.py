"""Slow plain twins of the kernels of the elastic fit, in numpy's linear algebra."""

import math

import numpy as np

NU, CLAMP = 0.49, 31.0


def window(x, y):
    return max(1 - (x * x + y * y) / CLAMP**2, 1e-3) ** 0.375


def respond(x, y, cx, cy, a):
    """2 x 3: columns drag x, drag y, turn."""
    dx, dy = x - cx, y - cy
    r, phi = math.hypot(dx, dy), math.atan2(dy, dx)
    if r <= a:
        return np.array([[1.0, 0.0, -dy], [0.0, 1.0, dx]])
    k = 2 / (math.pi * (2 - NU))
    b = a / r * math.sqrt(1 - (a / r) ** 2)
    across = k * NU * b * math.sin(2 * phi)
    straight = k * (2 - NU) * math.asin(a / r)
    bend = k * NU * b * math.cos(2 * phi)
    ring = 2 / math.pi * (r * math.asin(a / r) - a * math.sqrt(1 - (a / r) ** 2))
    edge = window(cx + a * math.cos(phi), cy + a * math.sin(phi))
    return (
        np.array(
            [
                [straight + bend, across, -ring * math.sin(phi)],
                [across, straight - bend, ring * math.cos(phi)],
            ]
        )
        * window(x, y)
        / edge
    )


def couple(centres, radii):
    k = len(centres)
    matrix = np.zeros((3 * k, 3 * k))
    for i, (c, a) in enumerate(zip(centres, radii, strict=True)):
        arms = 0.6 * a * np.array([[0, 0], [1, 0], [-1, 0], [0, 1], [0, -1]])
        for j in range(k):
            u = np.array([respond(*(c + o), *centres[j], radii[j]) for o in arms])
            block = matrix[3 * i : 3 * i + 3, 3 * j : 3 * j + 3]
            block[:2] = u.mean(axis=0)
            curl = arms[:, :1] * u[:, 1] - arms[:, 1:] * u[:, 0]
            block[2] = curl.sum(axis=0) / (4 * (0.6 * a) ** 2)
    return matrix


def columns(points, centres, radii):
    """(n, 2, 3 k): how each marker moves with each finger's own motion."""
    k = len(centres)
    inverse = np.linalg.inv(couple(centres, radii))
    rows = []
    for p in points:
        inside = [j for j in range(k) if math.dist(p, centres[j]) <= radii[j]]
        alone = np.concatenate([respond(*p, *centres[j], radii[j]) for j in range(k)], axis=1)
        if inside:
            row = np.zeros((2, 3 * k))
            j = inside[-1]
            row[:, 3 * j : 3 * j + 3] = alone[:, 3 * j : 3 * j + 3]
        else:
            row = alone @ inverse
        rows.append(row)
    return np.array(rows)


def bend(points, centres, radii, turns):
    """(n, 2): a patch turned by a finite angle shrinks towards its centre by 1 - cos."""
    out = []
    for p in points:
        inside = [j for j in range(len(centres)) if math.dist(p, centres[j]) <= radii[j]]
        total = np.zeros(2)
        for j in inside[-1:] or range(len(centres)):
            spin = respond(*p, *centres[j], radii[j])[:, 2]
            total += (math.sqrt(1 - turns[j] ** 2) - 1) * np.array([spin[1], -spin[0]])
        out.append(total)
    return np.array(out)


def gains(points, sites, radius, residual, weight):
    out = []
    for s in sites:
        atom = np.concatenate([respond(*p, *s, radius) for p in points])
        p = atom.T @ (residual * weight[:, None]).ravel()
        gram = atom.T @ atom
        out.append(float(p @ np.linalg.solve(gram, p)))
    return np.array(out)

"""Slow plain twins of the kernels of the elastic fit, in numpy's linear algebra."""

import cmath
import math

import numpy as np

NU, RIM = 0.49, 31.0
HEIGHT, REACH, VIEW, NEAR, STEP = 20.0, 18.0, 100.0, 9.0, 0.8


def window(x, y):
    return max(1 - (x * x + y * y) / RIM**2, 1e-3) ** 0.375


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


def build_compliance(centres, radii):
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
    inverse = np.linalg.inv(build_compliance(centres, radii))
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


def presses(points, centres, radii):
    """(n, 2, k): motion of each marker by each press: what sinks grows and flows aside."""
    rows = []
    for x, y in points:
        row = []
        for (cx, cy), a in zip(centres, radii, strict=True):
            r2 = (x - cx) ** 2 + (y - cy) ** 2
            depth = 1 - 0.5 * r2 / a**2 if r2 < a**2 else 0.5 * (a**2 / r2) ** 0.75
            flow = a**2 / (2 * HEIGHT * (a**2 + r2))
            row.append([depth / VIEW * x + flow * (x - cx), depth / VIEW * y + flow * (y - cy)])
        rows.append(np.transpose(row))
    return np.array(rows)


def flow(points, centres, radii):
    """(n, 2): how gel that all fingers press flows aside far from them; they hold it under them."""
    out = np.zeros((len(points), 2))
    for i, p in enumerate(points):
        away = [math.dist(p, c) for c in centres]
        if all(r > a for r, a in zip(away, radii, strict=True)):
            for c, r in zip(centres, away, strict=True):
                way = (p - c) / r
                more = 1 + 10 * way @ c / (7**2 + r * r)
                out[i] += 2 * REACH * r / (REACH**2 + r * r) * more * window(*p) * way
    return out


def slopes(points, centres, radii, motions):
    """(n, 2, 3 k): how each marker moves with x, y and radius of each finger, the loads held."""
    loads = np.linalg.solve(build_compliance(centres, radii), np.ravel(motions)).reshape(-1, 3)
    out = np.zeros((len(points), 2, 3 * len(centres)))
    for i, p in enumerate(points):
        for j, ((cx, cy), a) in enumerate(zip(centres, radii, strict=True)):
            if math.dist(p, (cx, cy)) > a + NEAR:
                continue
            for q, (x, y, r) in enumerate(STEP * np.eye(3)):
                more = respond(*p, cx + x, cy + y, a + r) @ loads[j]
                less = respond(*p, cx - x, cy - y, a - r) @ loads[j]
                out[i, :, 3 * j + q] = (more - less) / (2 * STEP)
    return out


def measure_motion(centres, radii, motions):
    """Translation, rotation, scale and what speaks for each of the six types."""
    parts = [0.0] * 6
    rest, drag = [complex(*c) for c in centres], [complex(x, y) for x, y, _ in motions]
    n = len(rest)
    common = sum(drag) / n
    if n == 1:
        rotation, scale = math.asin(motions[0][2]), 1.0
        turn = abs(rotation) * 0.7 * radii[0] / 2.0
        parts[1] = abs(common)
    else:
        arm = [place - sum(rest) / n for place in rest]
        inertia = sum(abs(a) ** 2 for a in arm)
        similarity = 1 + sum(a.conjugate() * d for a, d in zip(arm, drag, strict=True)) / inertia
        rotation, scale = cmath.phase(similarity), abs(similarity)
        reach = math.sqrt(inertia / n)
        turn, parts[3 if scale > 1 else 2] = abs(rotation) * reach, abs(scale - 1) * reach
        parts[1] = max(abs(common) / 1.6 - 0.05, 0.0)
    parts[4 if rotation > 0 else 5] = turn
    return (common.real, common.imag, rotation, scale), parts


class Landing:
    """Motions since each finger, known by its name, landed."""

    def __init__(self):
        self.seen = {}

    def subtract(self, names, motions, step_us):
        seen, since = {}, []
        for name, motion in zip(names, motions, strict=True):
            total, us = self.seen.get(name, ([0.0, 0.0, 0.0], 0))
            if us < 60_000:
                total = [s + step_us * m for s, m in zip(total, motion, strict=True)]
                us += step_us
            seen[name] = total, us
            landed = [s / us for s in total]
            share = 0.8 * 0.5 / max(math.hypot(*landed[:2]), 0.5)
            since.append([m - share * s for m, s in zip(motion, landed, strict=True)])
        self.seen = seen
        return np.array(since)


def locate(centre, radius, motion, press, n=400):
    """Where the mean of a patch, weighted by its squared motion, lies now; the rms motion."""
    u = np.linspace(-1, 1, n) * radius
    x, y = (p.ravel() for p in np.meshgrid(u, u))
    x, y = x[np.hypot(x, y) <= radius], y[np.hypot(x, y) <= radius]
    dx, dy = np.add(motion[:2], press / VIEW * np.asarray(centre))
    turn = motion[2]
    weight = (dx - turn * y) ** 2 + (dy + turn * x) ** 2
    sx, sy = np.average(x, weights=weight), np.average(y, weights=weight)
    bend = math.sqrt(1 - turn**2) - 1
    moved = dx - turn * sy + bend * sx, dy + turn * sx + bend * sy
    return centre[0] + sx + moved[0], centre[1] + sy + moved[1], math.sqrt(weight.mean())


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

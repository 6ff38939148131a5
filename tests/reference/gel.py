"""Plain twins of the gel's kernels, straight from the formulas."""

import math

import numpy as np

NU = 0.47


def window(x, y):
    rho = math.hypot(x, y)
    return max(1 - (rho / 31.0) ** 2, 0.0) ** 0.37


def mindlin(x, y, a, delta):
    """Displacement (x, y) outside or inside a patch that is dragged by ``delta`` along x."""
    r, phi = math.hypot(x, y), math.atan2(y, x)
    if r <= a:
        return np.array([delta, 0.0])
    k = 2 * delta / (math.pi * (2 - NU))
    b = a / r * math.sqrt(1 - a**2 / r**2)
    along = k * ((2 - NU) * math.asin(a / r) + NU * b * math.cos(2 * phi))
    return np.array([along, k * NU * b * math.sin(2 * phi)])


def reissner_sagoci(x, y, a, omega):
    """Displacement (x, y) around a patch that turns by ``omega`` from x to y."""
    r, phi = math.hypot(x, y), math.atan2(y, x)
    if r <= a:
        u = omega * r
    else:
        u = 2 * omega / math.pi * (r * math.asin(a / r) - a * math.sqrt(1 - a**2 / r**2))
    return u * np.array([-math.sin(phi), math.cos(phi)])


def patch_field(x, y, a, dx, dy, turn):
    """Drag by (dx, dy), turned into the frame of ``mindlin``, plus the turn."""
    delta, heading = math.hypot(dx, dy), math.atan2(dy, dx)
    c, s = math.cos(heading), math.sin(heading)
    along = mindlin(c * x + s * y, -s * x + c * y, a, delta)
    drag = np.array([c * along[0] - s * along[1], s * along[0] + c * along[1]])
    return drag + reissner_sagoci(x, y, a, turn)


def patch_mean(field, centre, radius):
    """Mean motion of a patch in a field, as drag x, drag y, turn, from its centre and four arms."""
    arm = 0.6 * radius
    offsets = [(0, 0), (arm, 0), (-arm, 0), (0, arm), (0, -arm)]
    moved = [field(centre[0] + ox, centre[1] + oy) for ox, oy in offsets]
    turn = sum(ox * u[1] - oy * u[0] for (ox, oy), u in zip(offsets, moved, strict=True))
    return np.array([*np.mean(moved, axis=0), turn / (4 * arm**2)])


def step_field(centres, radii, motions):
    """The field of several patches, each of which moves as it shall on average."""

    def unit(j, axis):
        own = window(*centres[j])
        load = np.eye(3)[axis]

        def field(x, y):
            at = x - centres[j][0], y - centres[j][1]
            return window(x, y) / own * patch_field(*at, radii[j], *load)

        return field

    units = [unit(j, axis) for j in range(len(centres)) for axis in range(3)]
    patches = list(zip(centres, radii, strict=True))
    matrix = [[patch_mean(field, *patch) for field in units] for patch in patches]
    matrix = np.array(matrix).transpose(0, 2, 1).reshape(len(units), len(units))
    loads = np.linalg.solve(matrix, np.ravel(motions))
    return lambda x, y: sum(load * field(x, y) for load, field in zip(loads, units, strict=True))


def hertz_depth(r, a):
    """Depth around a press of depth 1 whose contact radius is a."""
    if r <= a:
        return 1 - r**2 / (2 * a**2)
    q = r / a
    return ((2 - q**2) * math.asin(1 / q) + math.sqrt(q**2 - 1)) / math.pi


def deform(points, centres, radii, motions, depths):
    """Markers (n, 3) after all steps: x, y and how far sunk."""
    points, centres = np.array(points, float), np.array(centres, float)
    motions = np.array(motions, float)
    steps = 1
    for dx, dy, turn in motions:
        steps = max(steps, math.ceil(math.hypot(dx, dy) / 1.5), math.ceil(abs(turn) / 0.08))
    for _ in range(steps):
        field = step_field(centres, radii, motions / steps)
        points = points + np.array([field(x, y) for x, y in points])
        centres = centres + motions[:, :2] / steps
    result = np.column_stack([points, np.zeros(len(points))])
    for centre, a, depth in zip(centres, radii, depths, strict=True):
        for point in result:
            away = point[:2] - centre
            r = math.hypot(*away)
            here = depth * window(point[0], point[1])
            point[2] += here * hertz_depth(r, a)
            point[:2] += here * 0.09 * 2 * a / (a**2 + r**2) * away
    return result


def resist_squeeze(rest, neighbours, mobility, moved):
    """Six sweeps over all pairs in order, each pair set apart by mobility."""
    moved = np.array(moved)
    pairs = [(i, j) for i in range(len(rest)) for j in neighbours[i] if j > i]
    for _ in range(6):
        for i, j in pairs:
            share = np.array([mobility[i], mobility[j]])
            gap = moved[j, :2] - moved[i, :2]
            length, least = np.linalg.norm(gap), 0.4 * np.linalg.norm(rest[j] - rest[i])
            if share.sum() > 0 and 1e-6 < length < least:
                share = share / share.sum()
                moved[i, :2] -= share[0] * (least - length) * gap / length
                moved[j, :2] += share[1] * (least - length) * gap / length
    return moved

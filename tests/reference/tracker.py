"""Slow plain twins of the kernels of the tracker."""

import math
import statistics

SECOND = 1e-6


def nearest(x, y, gate, positions):
    """The index of the nearest position nearer than the gate, or -1."""
    distance = [math.hypot(x - px, y - py) for px, py in positions]
    best = min(range(len(distance)), key=distance.__getitem__)
    return best if distance[best] < gate else -1


def filter_events(events, state, aim, r_px2, tuning):
    """Matrix Kalman filter; ``state`` rows x, y, vx, vy, a, b, c, t, lead are changed in place.

    Behind these are n_missed, and the sums of how far events are ahead.
    ``aim`` rows: where ON (x, y) and OFF (x, y) events of each marker are expected.
    """
    taken = []
    for t, x, y, on in events:
        i = nearest(x, y, tuning.gate_px, [row[:2] if on else row[2:] for row in aim])
        taken.append(i)
        if i < 0:
            continue
        px, py, vx, vy, a, b, c, since, lead_x, lead_y = state[i][:10]
        elapsed = max((t - since) * SECOND, 0.0)
        dt = min(elapsed, tuning.memory_s)
        fade = 1 - dt / tuning.memory_s
        step = dt * (1 + fade) / 2  # the mean velocity while it fades
        grow = elapsed / (1 + (elapsed / tuning.quiet_s) ** 2)
        # F P F' + Q with F = [[1, grow], [0, 1]]
        a, b, c = (
            a + 2 * grow * b + grow * grow * c + tuning.q_x * grow,
            b + grow * c,
            c + tuning.q_v * grow,
        )
        px, py = px + vx * step, py + vy * step
        sign = 1 if on else -1  # where the event would be if it came from the marker's centre
        rx, ry = x - sign * lead_x - px, y - sign * lead_y - py
        r = r_px2[i][int(on)] * (1 + ((rx * rx + ry * ry) / tuning.spread_px**2) ** 2)
        k1, k2 = a / (a + r), b / (a + r)
        state[i][:8] = [
            px + k1 * rx, py + k1 * ry, vx * fade + k2 * rx, vy * fade + k2 * ry,
            a - k1 * a, b - k1 * b, c - k2 * b, t,
        ]  # fmt: skip
        state[i][11:14] = [
            total + sign * more for total, more in zip(state[i][11:14], (rx, ry, 1.0), strict=True)
        ]
    return taken


def collide(positions, expected, neighbours, closest):
    """Of each two neighbours at one place the one that is farther from where it is expected."""

    def off(i):
        return sum(abs(p - e) for p, e in zip(positions[i], expected[i], strict=True))

    pairs = [(i, j) for i in range(len(positions)) for j in neighbours[i] if j > i]
    return {
        i if off(i) > off(j) else j
        for i, j in pairs
        if math.dist(positions[i], positions[j]) < closest
    }


def tear(positions, usable, rest, neighbours, least):
    """Markers that moved by more than ``least`` while most of their neighbours stayed behind."""
    moved = [math.dist(p, r) for p, r in zip(positions, rest, strict=True)]
    torn = set()
    for i, around in enumerate(neighbours):
        near = [j for j in around if j >= 0 and usable[j]]
        left = [j for j in near if moved[j] < 0.2 * moved[i]]
        if moved[i] > least and len(left) >= 4 and len(left) > len(near) / 2:
            torn.add(i)
    return torn


def weigh(t, motion, count, rate, noise, neighbours, n_checks, last, tuning, *, is_rare):
    """Rates, noise, variances, leads and what the velocities' variances grow by, of all markers.

    ``motion`` rows vx, vy, since, lead x, y, ahead x, y, excess and its recent mean per second;
    ``last`` is the last check, ``is_rare``: frames are. The variances are of OFF and ON events.
    """
    dt = (t - last) * SECOND
    share = 1 - math.exp(-dt / tuning.rate_s)
    rate = [(1 - share) * r + share * n / dt for r, n in zip(rate, count, strict=True)]
    more = [(1 - share) * before + share * new / dt for *_, new, before in motion]
    near = [[i, *(j for j in row if j >= 0)] for i, row in enumerate(neighbours)]
    means = [[statistics.fmean(of[j] for j in some) for some in near] for of in (rate, more)]
    quiet = sorted(means[0] if is_rare else rate)[len(rate) // 4]
    noise += (quiet - noise) * dt / (0.1 if quiet < noise else min(5.0, dt * (n_checks + 1)))
    r_px2, leads, growth = [], [], []
    for i, (vx, vy, since, *before, ahead_x, ahead_y, excess, _) in enumerate(motion):
        around, mean, one_way = near[i], means[0][i], means[1][i]
        unsure = noise + tuning.n_sigma * math.sqrt(noise / (2 * tuning.rate_s * len(around)))
        light = max(abs(one_way) - unsure, 0.0)
        moving = max(0.0, mean - unsure - light)
        usual = tuning.r_px2 / max(moving / (moving + noise), 0.05)
        lit = usual / max((mean - light) / (mean + light), 1e-3)
        r_px2.append([usual, lit] if one_way > 0 else [lit, usual])
        fade = 1 - min(max((t - since) * SECOND / tuning.memory_s, 0.0), 1.0)
        speed = math.hypot(fade * vx, fade * vy, 60.0)
        lead = [tuning.lead_px * fade * v / speed for v in (vx, vy)]
        sided = max(count[i] - abs(excess), 0)
        if sided:
            seen = [b + a / count[i] for b, a in zip(before, (ahead_x, ahead_y), strict=True)]
            lead = [(8 * v + sided * s) / (8 + sided) for v, s in zip(lead, seen, strict=True)]
            shorter = min(1.25 * tuning.lead_px / math.hypot(*lead), 1.0)
            lead = [shorter * v for v in lead]
        leads.append(lead)
        growth.append(dt / 0.005 * (sided / dt / 40 * math.hypot(*lead)) ** 2)
    return rate, noise, r_px2, leads, growth


def expect(positions, rest, neighbours, usable):
    """(expected x, y) and spread of each marker; None where too few neighbours have a say."""
    answers = []
    for i in range(len(positions)):
        around = [j for j in neighbours[i] if j >= 0 and usable[j]]
        if len(around) < 3:
            answers.append(None)
            continue
        expected, spreads = [], []
        for axis in (0, 1):
            moved = sorted(positions[j][axis] - rest[j][axis] for j in around)
            expected.append(rest[i][axis] + statistics.median(moved))
            quarter = len(moved) // 4
            spreads.append((moved[-1 - quarter] - moved[quarter]) / 2)
        answers.append((*expected, max(spreads)))
    return answers


def threshold(pixels, n_sigma, min_contrast, block):
    """Threshold and background of every block from every second row of the 3 x 3 around it."""
    h, w = pixels.shape
    answers = []
    for i in range(-(-h // block)):
        row = []
        for j in range(-(-w // block)):
            window = pixels[
                max(i - 1, 0) * block : (i + 2) * block : 2, max(j - 1, 0) * block : (j + 2) * block
            ].astype(float)
            mean, sigma = window.mean(), window.std()
            row.append((mean + max(n_sigma * sigma, min_contrast), mean - sigma / 4))
        answers.append(row)
    return answers


def find_blobs(pixels, threshold_of, background_of, min_area, max_area):
    """Sets of pixels (y, x), with centroids (x, y), by repeated merging of neighbours."""
    h, w = pixels.shape
    bright = {(y, x) for y in range(h) for x in range(w) if pixels[y, x] > threshold_of(y, x)}
    blobs = []
    while bright:
        blob = {bright.pop()}
        while True:
            grown = {
                (y + dy, x + dx) for y, x in blob for dy, dx in ((0, 1), (1, 0), (0, -1), (-1, 0))
            } & bright
            if not grown:
                break
            blob |= grown
            bright -= grown
        if min_area <= len(blob) <= max_area:
            weight = {(y, x): float(pixels[y, x]) - background_of(y, x) for y, x in blob}
            mass = sum(weight.values())
            centre = [sum(v * p[k] for p, v in weight.items()) / mass for k in (1, 0)]
            blobs.append((blob, *centre))
    return blobs


def squared_distance(point, points):
    return min((point[0] - q[0]) ** 2 + (point[1] - q[1]) ** 2 for q in points)


def chamfer(p, q):
    forward = statistics.fmean(squared_distance(point, q) for point in p)
    return forward + statistics.fmean(squared_distance(point, p) for point in q)


def match_points(targets, points, gate):
    """Index of the point of each target, -1 for none in the gate, -2 for doubt."""
    answers = []
    for i, target in enumerate(targets):
        order = sorted((math.dist(target, p), j) for j, p in enumerate(points))
        if not order or order[0][0] >= gate:
            answers.append(-1)
            continue
        distance, j = order[0]
        clear = len(order) < 2 or order[1][0] >= 2 * distance
        mutual = min(range(len(targets)), key=lambda k: math.dist(targets[k], points[j])) == i
        answers.append(j if clear and mutual else -2)
    return answers


def assign_blobs(then, sharp, points, areas, missed, lost, rest, neighbours, tuning):
    """The blob of each track or None, and how often each track was missed."""
    usual = statistics.median(areas)
    single = {j for j, area in enumerate(areas) if area <= 1.8 * usual}
    first = match_points(then, points, 3.5)
    missed = [m + (s and j == -1) for m, s, j in zip(missed, sharp, first, strict=True)]
    blob = [j if s and j in single else None for s, j in zip(sharp, first, strict=True)]
    lost = [a or m > 0 for a, m in zip(lost, missed, strict=True)]
    for _ in range(3):
        at = [t if j is None else points[j] for t, j in zip(then, blob, strict=True)]
        expected = expect(at, rest, neighbours, [j is not None for j in blob])
        for i, answer in enumerate(expected):
            if answer is None:
                continue
            x, y, spread = answer
            off = max(abs(at[i][0] - x), abs(at[i][1] - y))
            if off > tuning.max_stray_px + tuning.max_stray_ratio * spread:
                blob[i], lost[i] = None, True
        searching = [
            i
            for i, answer in enumerate(expected)
            if blob[i] is None and lost[i] and sharp[i] and answer is not None
        ]
        free = sorted(single - set(blob))
        found = match_points([expected[i][:2] for i in searching], [points[j] for j in free], 3.5)
        if not any(k >= 0 for k in found):
            break
        for i, k in zip(searching, found, strict=True):
            blob[i] = free[k] if k >= 0 else None
    return blob, missed


def drift(off, share, touched_share, touch, most, rest):
    """Rest positions that follow by shares of what is common to all and of what is not."""
    common = [statistics.median(v) for v in zip(*off, strict=True)]
    answers = []
    for v, at in zip(off, rest, strict=True):
        local = [a - c for a, c in zip(v, common, strict=True)]
        size = math.hypot(*local)
        part = share if size <= touch else touched_share if size <= most else 0.0
        answers.append(
            [r + share * c + part * d for r, c, d in zip(at, common, local, strict=True)]
        )
    return answers


def pair_blobs(expected, points, areas, rest, neighbours, tuning):
    """The blob of each marker or None, and its place, from where it is expected."""
    usual = statistics.median(sorted(areas)[-len(expected) :])
    free = {j for j, area in enumerate(areas) if area <= 1.8 * usual}
    n = len(expected)
    blob, near = [None] * n, [tuple(e) for e in expected]

    def match(near):
        wanted = [i for i in range(n) if blob[i] is None and near[i] is not None]
        left = sorted(free)
        found = match_points([near[i] for i in wanted], [points[j] for j in left], 3.5)
        for i, k in zip(wanted, found, strict=True):
            if k >= 0:
                blob[i] = left[k]
                free.discard(left[k])
        return any(k >= 0 for k in found)

    def strays(place, around, least, ratio):
        return {
            i
            for i, answer in enumerate(around)
            if answer is not None
            and max(abs(p - e) for p, e in zip(place[i], answer[:2], strict=True))
            > least + ratio * answer[2]
        }

    def undo(i):
        if blob[i] is not None:
            free.add(blob[i])
            blob[i] = None

    for turn in range(6):
        is_new = match(near)
        place = [expected[i] if blob[i] is None else points[blob[i]] for i in range(n)]
        around = expect(place, expected, neighbours, [j is not None for j in blob])
        near = [None if answer is None else answer[:2] for answer in around]
        for i in strays(place, around, 2.0, 2.0):
            if blob[i] is not None:
                undo(i)
                place[i] = near[i]
        if turn and not is_new:
            break
    place = [near[i] if blob[i] is None and near[i] is not None else place[i] for i in range(n)]
    for _ in range(2):
        seen = [j is not None for j in blob]
        around = expect(place, rest, neighbours, seen)
        near = [None if answer is None else answer[:2] for answer in around]
        wrong = strays(place, around, tuning.max_stray_px, tuning.max_stray_ratio)
        wrong |= collide(place, near, neighbours, 1.5)
        wrong |= tear(place, seen, rest, neighbours, tuning.max_stray_px)
        wrong = {i for i in wrong if near[i] is not None}
        for i in wrong:
            undo(i)
            place[i] = near[i]
        if not wrong or not match(near):
            break
        place = [place[i] if blob[i] is None else points[blob[i]] for i in range(n)]
    return blob, place

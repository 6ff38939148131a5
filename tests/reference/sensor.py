"""Plain twins of the sensor's kernels."""

import math

import numpy as np

MASK = (1 << 64) - 1


def splitmix64(counter):
    """The next number in [0, 1) and the next counter."""
    counter = (counter + 0x9E3779B97F4A7C15) & MASK
    z = counter
    z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & MASK
    z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & MASK
    return ((z ^ (z >> 31)) >> 11) * 2.0**-53, counter


def draw(knots, u, profile, profile_scale, base, light):
    """The whole picture (260, 346), every marker over every pixel."""
    y, x = np.mgrid[: base.shape[0], : base.shape[1]]
    image = base.astype(float).copy()
    white = np.maximum(light, base)
    for i in range(knots.shape[1]):
        p0, p1, p2, p3 = knots[:, i, :2]
        # Catmull-Rom through the inner two, by de Casteljau-free textbook form.
        a, b = 2 * p1, p2 - p0
        c, d = 2 * p0 - 5 * p1 + 4 * p2 - p3, 3 * p1 - p0 - 3 * p2 + p3
        px, py = 0.5 * (a + b * u + c * u**2 + d * u**3)
        xx, xy, yy, gain = knots[1, i, 2:] + u * (knots[2, i, 2:] - knots[1, i, 2:])
        q = xx * (x - px) ** 2 + 2 * xy * (x - px) * (y - py) + yy * (y - py) ** 2
        cover = np.interp(q * profile_scale, np.arange(len(profile)), profile, right=0.0)
        image = np.minimum(image + gain * cover * (white - base), white)
    return image


def fire_pixel(images, tick_us, pixel, levels, gains, level_scale, refractory_us):
    """Events (t, polarity) of one pixel that sees ``images``, and its signal, µs by µs.

    ``pixel`` is a dict with signal, reference, on, off, leak (per µs); the first tick begins at 0.
    """
    events, trace, free = [], [], -math.inf
    signal, reference = pixel["signal"], pixel["reference"]
    for tick, image in enumerate(images):
        place = image * level_scale
        k = int(place)
        goal = levels[k] + (place - k) * (levels[k + 1] - levels[k])
        after = signal + gains[k] * (goal - signal)
        for step in range(tick_us):
            t = tick * tick_us + step + 1
            now = signal + (after - signal) * (step + 1) / tick_us
            trace.append(now)
            if t <= free:
                reference = now
                continue
            reference -= pixel["leak"]
            if now - reference >= pixel["on"] or now - reference <= -pixel["off"]:
                events.append((t - 1, now > reference))
                reference, free = now, t + refractory_us
        signal = after
    return events, np.array(trace)

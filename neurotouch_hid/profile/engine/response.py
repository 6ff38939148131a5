"""Turns a measure into a value of 0..1: range, dead zone, curve, gain, ends.

1 |         ____    range     where the movement begins and ends, in mm
  |       ,'        dead zone what stays exactly 0; the rest is stretched, so nothing jumps
  |     ,'          curve     linear, expo, power or points; all rise from (0, 0)
0 |____/            ends      multiplied by the gain, lifted over the game's own dead zone, capped
    rest   full  mm
"""

import math
from bisect import bisect_right
from collections.abc import Callable, Sequence
from itertools import pairwise

from neurotouch_hid.profile.schema.shaping import Curve, Expo, Points, Power, Shaped

Response = Callable[[float], float]


def make_response(range_: tuple[float, float], shaped: Shaped) -> Response:
    """Returns a rising function from a measure (finite, in the range's unit) to 0..1.

    Args:
        range_: (rest, full); 0 up to ``rest``, the end from ``full`` on.
        shaped: dead zone, curve, gain and ends.
    """
    rest, full = range_
    begin = rest + shaped.deadzone * (full - rest)
    extent = full - begin
    bend = make_bend(shaped.curve)
    gain, floor, ceiling = shaped.gain, shaped.anti_deadzone, shaped.saturate
    plain = (gain, floor, ceiling) == (1.0, 0.0, 1.0)

    def respond(measure: float) -> float:
        if measure <= begin:
            return 0.0
        value = bend((measure - begin) / extent) if measure < full else bend(1.0)
        if plain:
            return value
        return min(floor + (1.0 - floor) * min(gain * value, 1.0), ceiling)

    return respond


def make_bend(curve: Curve) -> Response:
    """Returns the form between the ends: a rising function from 0..1 to 0..1."""
    match curve:
        case Expo(expo=expo) if expo >= 0.0:
            return lambda x: x * (1.0 - expo + expo * x * x)
        case Expo(expo=expo):
            return lambda x: _invert_expo(-expo, x)
        case Power(power=power):
            return lambda x: x**power
        case Points(points=points):
            return _interpolate(points)
        case _:
            return lambda x: x


def _invert_expo(expo: float, y: float) -> float:
    """Returns the x with (1 - expo) x + expo x³ = y: that curve mirrored at the diagonal."""
    if expo < 1e-3 or y >= 1.0:  # nearly straight, Cardano's formula loses its digits; or the end
        return y
    half = y / (2.0 * expo)
    root = math.hypot(half, math.sqrt(((1.0 - expo) / (3.0 * expo)) ** 3))
    return min(1.0, math.cbrt(half + root) + math.cbrt(half - root))


def _interpolate(points: Sequence[tuple[float, float]]) -> Response:
    """Returns a monotone cubic through the points [Fritsch and Carlson 1980]."""
    knots = [*points]
    if knots[0][0] > 0.0:
        knots.insert(0, (0.0, 0.0))
    if knots[-1][0] < 1.0:
        knots.append((1.0, 1.0))
    xs, ys = [x for x, _ in knots], [y for _, y in knots]
    secants = [(y1 - y0) / (x1 - x0) for (x0, y0), (x1, y1) in pairwise(knots)]
    slopes = [secants[0], *((a + b) / 2.0 for a, b in pairwise(secants)), secants[-1]]
    for i, secant in enumerate(secants):
        if secant == 0.0:
            slopes[i] = slopes[i + 1] = 0.0
            continue
        length = math.hypot(slopes[i] / secant, slopes[i + 1] / secant)
        if length > 3.0:
            slopes[i] *= 3.0 / length
            slopes[i + 1] *= 3.0 / length

    def bend(x: float) -> float:
        i = min(max(bisect_right(xs, x) - 1, 0), len(secants) - 1)
        h = xs[i + 1] - xs[i]
        s = (x - xs[i]) / h
        value = (
            (1.0 + 2.0 * s) * (1.0 - s) ** 2 * ys[i]
            + s * (1.0 - s) ** 2 * h * slopes[i]
            + s * s * (3.0 - 2.0 * s) * ys[i + 1]
            + s * s * (s - 1.0) * h * slopes[i + 1]
        )
        return min(max(value, 0.0), 1.0)

    return bend

"""Other things in the picture: reflections, dust, fibres, scratches, the edge of a fingertip.

Each is drawn as rows like those of markers: place in px, a quadratic form in 1/px², brightness.
"""

import math

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.source.simulator.knot import Knot
from neurotouch_hid.source.simulator.setup import Marks, Setup

Floats = NDArray[np.float64]

GLINT_TRAVEL = 1.6  # a reflection moves further than the dome that it is on
GLINT_GAIN = 1.25  # brighter than a white dot
EDGE_POINTS = 28  # of a fingertip's edge
N_NEAREST = 4  # dots that carry what lies on the gel


def glints(setup: Setup, number: float) -> Setup:
    """Adds reflections of the LEDs, each on or beside a dot; they move when the gel deforms."""
    rng = setup.random("glints")
    n = round(number)
    near = rng.choice(len(setup.dots.points_mm), n, replace=False)
    aside = rng.normal(0.0, 0.5, (n, 2)) * setup.config.camera.rig.px_per_mm
    dot_mm = setup.config.gel.layout.dot_mm
    size = rng.uniform(0.5, 0.9, n) * dot_mm * setup.config.camera.rig.px_per_mm

    def mark(_t_us: int, now: Knot, untouched: Knot) -> Floats:
        start = untouched.outline[near, :2]
        moved = now.outline[near, :2] - start
        return _rows(start + aside + GLINT_TRAVEL * moved, size, size, np.zeros(n), GLINT_GAIN)

    return setup.plus(marks=mark)


def dust(setup: Setup, number: float) -> Setup:
    """Adds specks on the lens, half of them bright and half dark; they stay in their place."""
    return setup.plus(marks=_lie(setup, _specks(setup, "dust", round(number))))


def gel_dust(setup: Setup, number: float) -> Setup:
    """Adds specks on the gel, half of them bright and half dark; they move with it."""
    return setup.plus(marks=_ride(setup, _specks(setup, "gel-dust", round(number))))


def fibres(setup: Setup, number: float) -> Setup:
    """Adds dark fibres of 4 to 12 mm on the lens; they stay in their place."""
    return setup.plus(marks=_lie(setup, _fibres(setup, "fibres", round(number), -0.5)))


def gel_fibres(setup: Setup, number: float) -> Setup:
    """Adds bright fibres of 4 to 12 mm on the gel; they move with it."""
    return setup.plus(marks=_ride(setup, _fibres(setup, "gel-fibres", round(number), 0.45)))


def scratches(setup: Setup, number: float) -> Setup:
    """Adds bright straight scratches of 4 to 12 mm in the window; they stay in their place."""
    return setup.plus(marks=_lie(setup, _fibres(setup, "scratches", round(number), 0.3)))


def edge(setup: Setup, percent: float) -> Setup:
    """Adds the edge of each fingertip, a soft ring as bright as ``percent`` % of a white dot."""
    rig = setup.config.camera.rig
    strokes = setup.strokes
    most = max((len(stroke.fingers) for stroke in strokes), default=0)
    radius_px = rig.px_per_mm * max(
        (finger.radius_mm for stroke in strokes for finger in stroke.fingers), default=6.5
    )
    angles = 2.0 * math.pi * np.arange(EDGE_POINTS) / EDGE_POINTS
    ring = np.column_stack([np.cos(angles), np.sin(angles)])
    long = np.full(EDGE_POINTS, 1.5 * math.pi * radius_px / EDGE_POINTS)
    wide = np.full(EDGE_POINTS, 0.6 * rig.px_per_mm)

    def mark(_t_us: int, now: Knot, _untouched: Knot) -> Floats:
        rows = np.tile([0.0, 0.0, 1.0, 0.0, 1.0, 0.0], (most * EDGE_POINTS, 1))
        for i, (place, seen_mm) in enumerate(zip(now.contacts_px, now.seen_mm, strict=True)):
            touch = min(float(seen_mm), 1.0)
            part = slice(i * EDGE_POINTS, (i + 1) * EDGE_POINTS)
            gain = 0.01 * percent * touch
            rows[part] = _rows(place + radius_px * ring, long, wide, angles + 0.5 * math.pi, gain)
        return rows

    return setup.plus(marks=mark)


def _specks(setup: Setup, name: str, n: int) -> Floats:
    rng = setup.random(name)
    px = setup.config.camera.rig.px_per_mm
    long = rng.uniform(0.15, 0.6, n) * px
    gain = np.where(np.arange(n) % 2, -0.6, rng.uniform(0.3, 0.9, n))
    angle = rng.uniform(0.0, math.pi, n)
    return _rows(_scatter(setup, rng, n), long, rng.uniform(0.5, 1.0, n) * long, angle, gain)


def _fibres(setup: Setup, name: str, n: int, gain: float) -> Floats:
    rng = setup.random(name)
    px = setup.config.camera.rig.px_per_mm
    long = 0.5 * rng.uniform(4.0, 12.0, n) * px
    thin = np.full(n, 0.15 * px)
    return _rows(_scatter(setup, rng, n), long, thin, rng.uniform(0.0, math.pi, n), gain)


def _scatter(setup: Setup, rng: np.random.Generator, n: int) -> Floats:
    far = setup.config.gel.layout.radius_mm * np.sqrt(rng.random(n))
    angle = rng.uniform(0.0, 2.0 * math.pi, n)
    return setup.config.camera.rig.to_px(
        np.column_stack([far * np.cos(angle), far * np.sin(angle)])
    )


def _lie(_setup: Setup, rows: Floats) -> Marks:
    def mark(_t_us: int, _now: Knot, _untouched: Knot) -> Floats:
        return rows

    return mark


def _ride(setup: Setup, rows: Floats) -> Marks:
    """Returns marks that move as the mean of the nearest dots does."""
    dots = setup.config.camera.rig.to_px(setup.dots.points_mm)
    away = np.linalg.norm(rows[:, None, :2] - dots[None], axis=2)
    near = np.argsort(away, axis=1)[:, :N_NEAREST]
    weight = 1.0 / (np.take_along_axis(away, near, axis=1) + 1.0)
    weight /= weight.sum(axis=1, keepdims=True)

    def mark(_t_us: int, now: Knot, untouched: Knot) -> Floats:
        moved = now.outline[:, :2] - untouched.outline[:, :2]
        riding = rows.copy()
        riding[:, :2] += (weight[:, :, None] * moved[near]).sum(axis=1)
        return riding

    return mark


def _rows(
    place_px: Floats, long_px: Floats, wide_px: Floats, angle: Floats, gain: Floats | float
) -> Floats:
    """Returns rows of ellipses: places (n, 2), half axes and directions (n,), brightness."""
    cos, sin = np.cos(angle), np.sin(angle)
    along, across = long_px**-2.0, wide_px**-2.0
    return np.column_stack(
        [
            place_px,
            along * cos**2 + across * sin**2,
            (along - across) * cos * sin,
            along * sin**2 + across * cos**2,
            np.broadcast_to(gain, len(place_px)),
        ]
    )

"""Dots as hands make them, and a gel as a dome makes it."""

import math
from dataclasses import replace

import numpy as np

from neurotouch_hid.source.simulator.setup import Setup

FAINT = 0.2  # brightness of a faint dot


def missing(setup: Setup, percent: float) -> Setup:
    """Leaves out ``percent`` % of all dots, here and there."""
    brightness = setup.dots.brightness.copy()
    brightness[_choose(setup, "missing", percent)] = 0.0
    return replace(setup, dots=replace(setup.dots, brightness=brightness))


def faint(setup: Setup, percent: float) -> Setup:
    """Makes ``percent`` % of all dots a fifth as bright, here and there."""
    brightness = setup.dots.brightness.copy()
    brightness[_choose(setup, "faint", percent)] *= FAINT
    return replace(setup, dots=replace(setup.dots, brightness=brightness))


def painted(setup: Setup, mm: float) -> Setup:
    """Puts each dot ``mm`` mm beside its place, in a random direction."""
    way = setup.random("painted").uniform(-math.pi, math.pi, len(setup.dots.size))
    points = setup.dots.points_mm + mm * np.column_stack([np.cos(way), np.sin(way)])
    return replace(setup, dots=replace(setup.dots, points_mm=points))


def irregular(setup: Setup, percent: float) -> Setup:
    """Makes dots up to ``percent`` % larger or smaller, and as much dimmer."""
    rng = setup.random("irregular")
    spread = 0.01 * percent
    size = setup.dots.size * rng.uniform(1.0 - spread, 1.0 + spread, len(setup.dots.size))
    brightness = setup.dots.brightness * rng.uniform(1.0 - spread, 1.0, len(setup.dots.size))
    return replace(setup, dots=replace(setup.dots, size=size, brightness=brightness))


def dome(setup: Setup, percent: float) -> Setup:
    """Spaces the dots evenly along the dome's surface, so that they crowd at its rim."""
    height = setup.config.camera.height_mm
    far = np.hypot(*setup.dots.points_mm.T)
    rim = max(float(far.max()), 1.0)
    sphere = (rim**2 + height**2) / (2.0 * height)
    crowded = sphere * np.sin(far / sphere)
    share = 1.0 + 0.01 * percent * (crowded / np.maximum(far, 1e-9) - 1.0)
    share[far == 0.0] = 1.0
    points = setup.dots.points_mm * share[:, None]
    return replace(setup, dots=replace(setup.dots, points_mm=points))


def residue(setup: Setup, percent: float) -> Setup:
    """Leaves each dot off by ``percent`` % of its largest motion, until the next touch."""
    return setup.configured("gel", residue=0.01 * percent)


def _choose(setup: Setup, name: str, percent: float) -> np.ndarray:
    n_all = len(setup.dots.size)
    n = round(0.01 * percent * n_all)
    return setup.random(name).choice(n_all, n, replace=False)

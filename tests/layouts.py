"""Gels with other layouts than the paper's."""

import numpy as np

from neurotouch_hid.geometry import (
    PAPER_GEL,
    Gel,
    make_gel,
    measure_pitch,
    place_grid,
    place_hex,
    place_rings,
)


def scatter(n: int, radius_mm: float, apart_mm: float, seed: int) -> np.ndarray:
    """Returns points (n, 2) mm at random places of a circle, no two nearer than ``apart_mm``."""
    rng, points = np.random.default_rng(seed), np.empty((0, 2))
    while len(points) < n:
        point = rng.uniform(-radius_mm, radius_mm, (1, 2))
        if np.hypot(*point[0]) <= radius_mm and (np.hypot(*(points - point).T) > apart_mm).all():
            points = np.concatenate([points, point])
    return points


def make_irregular(n: int = 120, seed: int = 5) -> Gel:
    points = scatter(n, 29.5, 3.5, seed)
    return make_gel("points", points, pitch_mm=measure_pitch(points), radius_mm=30.0)


HEX = make_gel("hex", place_hex(4.65, 30.0), pitch_mm=4.65, radius_mm=30.0)
RINGS = make_gel("rings", place_rings(4.8, 29.0), pitch_mm=4.8, radius_mm=29.0)
GRID = make_gel("grid", place_grid(10, 7, 4.0, 4.0), pitch_mm=4.0, radius_mm=23.0)
OBLONG = make_gel("oblong", place_grid(9, 7, 4.0, 5.5), pitch_mm=4.0, radius_mm=24.0)
POINTS = make_irregular()
LAYOUTS = {gel.name: gel for gel in (PAPER_GEL, HEX, RINGS, GRID, OBLONG, POINTS)}

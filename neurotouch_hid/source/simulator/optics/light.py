"""The light in the picture: uneven, with bright spots beside the gel, and blurred markers."""

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import NOMINAL_PX_PER_MM, PAPER_GEL, Gel, Rig
from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX
from neurotouch_hid.source.simulator.config import LightConfig

PROFILE_REACH = 2.6  # markers are drawn out to this multiple of their radius, or further if blurred
PROFILE_STEPS = 512
RING_AT, RING_WIDTH = 0.5, 0.06  # of the LED ring's reflection, in radii of the gel
PIXEL_BLUR_PX = 12**-0.5  # the pixel's own width blurs as well


@lru_cache(maxsize=1)  # a start opens the simulator twice
def compute_light(
    config: LightConfig, rig: Rig, gel: Gel = PAPER_GEL
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns the picture without markers and the brightness of a marker everywhere.

    Returns:
        Two (260, 346) float64 in DN.
    """
    y, x = np.mgrid[:SENSOR_HEIGHT_PX, :SENSOR_WIDTH_PX].astype(np.float64)
    dx, dy = x - rig.centre_px[0], y - rig.centre_px[1]
    radius_px = gel.radius_mm * rig.px_per_mm
    r = np.hypot(dx, dy) / radius_px
    slope = (dx * np.cos(config.uneven_rad) + dy * np.sin(config.uneven_rad)) / radius_px
    light = (1.0 + 0.5 * config.uneven * slope) * np.exp(-0.15 * r**2)
    light = np.clip(light, 0.2, 1.3)
    outside = 1.0 / (1.0 + np.exp(-(r - 1.12) * 40.0))
    base = config.black_dn * light * (1.0 - 0.5 * outside)
    if not gel.light:
        base += (config.white_dn - config.black_dn) * light * (1.0 - outside)
    rng = np.random.default_rng((config.seed, 3))
    for _ in range(config.n_spots):
        angle, far = rng.uniform(0, 2 * np.pi), rng.uniform(1.18, 1.7) * radius_px
        size = rng.uniform(0.8, 2.5)
        d2 = (dx - far * np.cos(angle)) ** 2 + (dy - far * np.sin(angle)) ** 2
        base += config.spot_dn * np.exp(-((d2 / (2 * size**2)) ** 2))
    ring = np.exp(-(((r - RING_AT) / RING_WIDTH) ** 2))
    base += config.ring_glare * config.white_dn * ring
    corner = np.hypot(0.5 * SENSOR_WIDTH_PX, 0.5 * SENSOR_HEIGHT_PX)
    middle_x, middle_y = 0.5 * (SENSOR_WIDTH_PX - 1), 0.5 * (SENSOR_HEIGHT_PX - 1)
    left = 1.0 - config.vignetting * (np.hypot(x - middle_x, y - middle_y) / corner) ** 2
    return np.minimum(base * left, 255.0), config.white_dn * light * left


def marker_profile(
    blur_px: float, dot_mm: float = PAPER_GEL.dot_mm
) -> tuple[NDArray[np.float32], float]:
    """Returns the brightness of a blurred white disc over its squared relative radius.

    Args:
        blur_px: standard deviation of the point spread.
        dot_mm: diameter of the disc.

    Returns:
        (PROFILE_STEPS + 1,) float32, the last is 0; and its entries per unit of squared radius.
    """
    sigma = math.hypot(blur_px, PIXEL_BLUR_PX) / (0.5 * dot_mm * NOMINAL_PX_PER_MM)
    reach = max(PROFILE_REACH, 0.5 + 2.5 * sigma)
    axis = np.linspace(-1.0, 1.0, 161)
    bell = np.exp(-(axis**2) / (2 * sigma**2))
    columns = bell @ (np.hypot(axis, axis[:, None]) <= 1.0)  # of the disc, each blurred along y
    radius = reach * np.sqrt(np.linspace(0.0, 1.0, PROFILE_STEPS + 1))
    across = np.exp(-((axis - radius[:, None]) ** 2) / (2 * sigma**2))
    area = (axis[1] - axis[0]) ** 2
    profile: NDArray[np.float64] = across @ columns * area / (2 * np.pi * sigma**2)
    return np.asarray(profile - profile[-1], np.float32), PROFILE_STEPS / reach**2

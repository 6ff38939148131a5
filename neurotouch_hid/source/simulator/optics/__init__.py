"""Optics between gel and sensor: camera, lens and light."""

from neurotouch_hid.source.simulator.config import CameraConfig, LightConfig
from neurotouch_hid.source.simulator.optics.light import (
    MARKER_RADIUS_PX,
    PIXEL_BLUR_PX,
    compute_light,
    marker_profile,
)
from neurotouch_hid.source.simulator.optics.projection import RING_MM, CameraModel

__all__ = [
    "MARKER_RADIUS_PX",
    "PIXEL_BLUR_PX",
    "RING_MM",
    "CameraConfig",
    "CameraModel",
    "LightConfig",
    "compute_light",
    "marker_profile",
]

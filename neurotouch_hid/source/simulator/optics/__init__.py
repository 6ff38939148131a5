"""Optics between gel and sensor: camera, lens and light."""

from neurotouch_hid.source.simulator.config import CameraConfig, LightConfig
from neurotouch_hid.source.simulator.optics.light import (
    PIXEL_BLUR_PX,
    compute_light,
    marker_profile,
)
from neurotouch_hid.source.simulator.optics.projection import CameraModel, find_ring

__all__ = [
    "PIXEL_BLUR_PX",
    "CameraConfig",
    "CameraModel",
    "LightConfig",
    "compute_light",
    "find_ring",
    "marker_profile",
]

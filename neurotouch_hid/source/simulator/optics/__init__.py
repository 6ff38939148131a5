"""Optics between gel and sensor: camera, lens and light."""

from neurotouch_hid.source.simulator.optics.light import (
    PROFILE_SCALE,
    LightConfig,
    compute_light,
    marker_profile,
)
from neurotouch_hid.source.simulator.optics.projection import CameraConfig, CameraModel

__all__ = [
    "PROFILE_SCALE",
    "CameraConfig",
    "CameraModel",
    "LightConfig",
    "compute_light",
    "marker_profile",
]

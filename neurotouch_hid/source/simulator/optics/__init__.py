"""What lies between gel and sensor: camera, lens and light."""

from neurotouch_hid.source.simulator.optics.light import (
    PROFILE_SCALE,
    LightConfig,
    marker_profile,
    paint,
)
from neurotouch_hid.source.simulator.optics.projection import Camera, CameraConfig

__all__ = ["PROFILE_SCALE", "Camera", "CameraConfig", "LightConfig", "marker_profile", "paint"]

"""What lies between gel and sensor: camera, lens and light."""

from neurotouch_hid.source.simulator.optics.camera import Camera, CameraConfig
from neurotouch_hid.source.simulator.optics.light import (
    PROFILE_SCALE,
    LightConfig,
    marker_profile,
    paint,
)

__all__ = ["PROFILE_SCALE", "Camera", "CameraConfig", "LightConfig", "marker_profile", "paint"]

"""The driver of the DAVIS-346: from USB to slices of sensor time.

A name loads its module when it is first asked for: cameras are found without numba and USB.
"""

from typing import TYPE_CHECKING

from neurotouch_hid.lazy import load_lazily

if TYPE_CHECKING:
    from neurotouch_hid.source.davis.camera import CameraVersions, identify
    from neurotouch_hid.source.davis.config import Biases, DavisConfig, Roi
    from neurotouch_hid.source.davis.enumeration import CameraInfo, choose_camera, find_cameras
    from neurotouch_hid.source.davis.source import DavisSource
else:
    __getattr__ = load_lazily(
        __name__,
        {
            "camera": "CameraVersions identify",
            "config": "Biases DavisConfig Roi",
            "enumeration": "CameraInfo choose_camera find_cameras",
            "source": "DavisSource",
        },
    )

__all__ = [
    "Biases",
    "CameraInfo",
    "CameraVersions",
    "DavisConfig",
    "DavisSource",
    "Roi",
    "choose_camera",
    "find_cameras",
    "identify",
]

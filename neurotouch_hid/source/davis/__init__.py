"""The driver of the DAVIS-346: from USB to slices of sensor time."""

from neurotouch_hid.source.davis.camera import CameraVersions, identify
from neurotouch_hid.source.davis.config import Biases, DavisConfig, Roi
from neurotouch_hid.source.davis.enumeration import CameraInfo, find_cameras
from neurotouch_hid.source.davis.source import MAX_DELAY_US, DavisSource, DavisStats

__all__ = [
    "MAX_DELAY_US",
    "Biases",
    "CameraInfo",
    "CameraVersions",
    "DavisConfig",
    "DavisSource",
    "DavisStats",
    "Roi",
    "find_cameras",
    "identify",
]

"""Emulated cameras, for tests and for people without one: a DAVIS-346; a webcam in ``uvc``."""

from neurotouch_devtools.emulator.camera import CameraConfig, EmulatedCamera
from neurotouch_devtools.emulator.descriptors import Identity
from neurotouch_devtools.emulator.faults import Fault, FaultKind, Stage
from neurotouch_devtools.emulator.prefetch import Prefetch
from neurotouch_devtools.emulator.usbip import UsbIp, find_port

__all__ = [
    "CameraConfig",
    "EmulatedCamera",
    "Fault",
    "FaultKind",
    "Identity",
    "Prefetch",
    "Stage",
    "UsbIp",
    "find_port",
]

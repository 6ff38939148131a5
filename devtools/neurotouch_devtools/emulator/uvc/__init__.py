"""An emulated UVC camera, which the kernel's own driver takes for a webcam."""

from neurotouch_devtools.emulator.uvc.camera import UvcCamera, UvcConfig, UvcControl, UvcStream
from neurotouch_devtools.emulator.uvc.controls import CONTROLS
from neurotouch_devtools.emulator.uvc.descriptors import UvcIdentity
from neurotouch_devtools.emulator.uvc.film import Film
from neurotouch_devtools.emulator.uvc.modes import MODES, Mode, PixelFormat

__all__ = [
    "CONTROLS",
    "MODES",
    "Film",
    "Mode",
    "PixelFormat",
    "UvcCamera",
    "UvcConfig",
    "UvcControl",
    "UvcIdentity",
    "UvcStream",
]

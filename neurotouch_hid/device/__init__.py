"""Fifth stage: the virtual gamepad that every program takes for a standard controller.

Where a profile asks for them, a keyboard and a mouse stand beside it.
"""

from neurotouch_hid.device.chord import ChordReader, explain_keyboards, find_keyboards
from neurotouch_hid.device.claim import Companion
from neurotouch_hid.device.composite import CompositeDevice
from neurotouch_hid.device.device import Device, check_device, open_device
from neurotouch_hid.device.memory import MemoryDevice

__all__ = [
    "ChordReader",
    "Companion",
    "CompositeDevice",
    "Device",
    "MemoryDevice",
    "check_device",
    "explain_keyboards",
    "find_keyboards",
    "open_device",
]

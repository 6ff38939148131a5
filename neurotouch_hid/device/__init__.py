"""Fifth stage: the virtual gamepad that every program takes for a standard controller.

Where a profile asks for them, a keyboard and a mouse stand beside it.
"""

from neurotouch_hid.device.claim import Companion
from neurotouch_hid.device.composite import CompositeDevice
from neurotouch_hid.device.device import Device, check_device, open_device
from neurotouch_hid.device.memory import MemoryDevice

__all__ = ["Companion", "CompositeDevice", "Device", "MemoryDevice", "check_device", "open_device"]

"""Fifth stage: the virtual gamepad that every program takes for a standard controller."""

from neurotouch_hid.device.device import Device, check_device, open_device
from neurotouch_hid.device.memory import MemoryDevice
from neurotouch_hid.device.uinput import UinputDevice

__all__ = ["Device", "MemoryDevice", "UinputDevice", "check_device", "open_device"]

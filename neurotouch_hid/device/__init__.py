"""Stage 5: the virtual gamepad, which every program treats as a standard controller.

A keyboard and a mouse are added where a profile uses them.
"""

from neurotouch_hid.device.device import Device, check_device, open_device, shows_change
from neurotouch_hid.device.inputs.copilot import Copilot
from neurotouch_hid.device.inputs.discovery import find_copilot
from neurotouch_hid.device.inputs.hotkeys import ChordReader, explain_keyboards, find_keyboards
from neurotouch_hid.device.inputs.merged_device import MergedDevice
from neurotouch_hid.device.inputs.nodes import is_input_name
from neurotouch_hid.device.outputs.composite import CompositeDevice
from neurotouch_hid.device.outputs.memory import MemoryDevice
from neurotouch_hid.device.outputs.rumble_router import RumbleRouter
from neurotouch_hid.device.outputs.spec import ExtraDevice

__all__ = [
    "ChordReader",
    "CompositeDevice",
    "Copilot",
    "Device",
    "ExtraDevice",
    "MemoryDevice",
    "MergedDevice",
    "RumbleRouter",
    "check_device",
    "explain_keyboards",
    "find_copilot",
    "find_keyboards",
    "is_input_name",
    "open_device",
    "shows_change",
]

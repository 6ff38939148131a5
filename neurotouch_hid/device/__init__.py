"""Fifth stage: the virtual gamepad that every program takes for a standard controller.

Where a profile asks for them, a keyboard and a mouse stand beside it.
"""

from neurotouch_hid.device.candidates import find_copilot
from neurotouch_hid.device.chord import ChordReader, explain_keyboards, find_keyboards
from neurotouch_hid.device.claim import Companion
from neurotouch_hid.device.composite import CompositeDevice
from neurotouch_hid.device.copilot import Copilot
from neurotouch_hid.device.device import Device, check_device, open_device, shows_change
from neurotouch_hid.device.inputs import is_input_name
from neurotouch_hid.device.memory import MemoryDevice
from neurotouch_hid.device.rumbleboard import RumbleBoard
from neurotouch_hid.device.shared import SharedDevice

__all__ = [
    "ChordReader",
    "Companion",
    "CompositeDevice",
    "Copilot",
    "Device",
    "MemoryDevice",
    "RumbleBoard",
    "SharedDevice",
    "check_device",
    "explain_keyboards",
    "find_copilot",
    "find_keyboards",
    "is_input_name",
    "open_device",
    "shows_change",
]

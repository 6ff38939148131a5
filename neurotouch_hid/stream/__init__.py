"""Sends what the running driver sees to other programs: OSC, WebSocket, LSL."""

from neurotouch_hid.stream.reading import Reading, read_states
from neurotouch_hid.stream.sender import Sender
from neurotouch_hid.stream.target import open_target, read_address

__all__ = ["Reading", "Sender", "open_target", "read_address", "read_states"]

"""Taps that show or write down what the line does, and never hold it up."""

from neurotouch_hid.monitor.cue import Cue, CueKind
from neurotouch_hid.monitor.sentence import describe_gesture, describe_pad
from neurotouch_hid.monitor.sound import SoundMonitor
from neurotouch_hid.monitor.speaker import Speaker
from neurotouch_hid.monitor.terminal import LinesMonitor, PictureMonitor
from neurotouch_hid.monitor.trace import TraceWriter

__all__ = [
    "Cue",
    "CueKind",
    "LinesMonitor",
    "PictureMonitor",
    "SoundMonitor",
    "Speaker",
    "TraceWriter",
    "describe_gesture",
    "describe_pad",
]

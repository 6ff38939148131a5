"""Taps that show, play or write the pipeline's steps, and never delay them."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from neurotouch_hid.monitor.cue import Cue, CueKind
    from neurotouch_hid.monitor.sentence import describe_gesture, describe_outputs
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
    "describe_outputs",
]

_MODULES = {
    "Cue": "cue",
    "CueKind": "cue",
    "LinesMonitor": "terminal",
    "PictureMonitor": "terminal",
    "SoundMonitor": "sound",
    "Speaker": "speaker",
    "TraceWriter": "trace",
    "describe_gesture": "sentence",
    "describe_outputs": "sentence",
}
"""The module of each name; it is loaded at the first use of the name. A tap needs the pipeline and
its compiled kernels; playing a sound in a person's session does not."""


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    return getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)

"""Taps that show, play or write the pipeline's steps, and never delay them.

A name loads its module when it is first asked for: a tap needs the pipeline and its compiled
kernels; playing a sound in a person's session does not.
"""

from typing import TYPE_CHECKING

from neurotouch_hid.lazy import load_lazily

if TYPE_CHECKING:
    from neurotouch_hid.monitor.cue import Cue, CueKind
    from neurotouch_hid.monitor.sentence import describe_gesture, describe_outputs
    from neurotouch_hid.monitor.sound import SoundMonitor
    from neurotouch_hid.monitor.speaker import Speaker
    from neurotouch_hid.monitor.terminal import LinesMonitor, PictureMonitor
    from neurotouch_hid.monitor.trace import TraceWriter
else:
    __getattr__ = load_lazily(
        __name__,
        {
            "cue": "Cue CueKind",
            "sentence": "describe_gesture describe_outputs",
            "sound": "SoundMonitor",
            "speaker": "Speaker",
            "terminal": "LinesMonitor PictureMonitor",
            "trace": "TraceWriter",
        },
    )

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

"""Where packets come from: the camera, recordings and the simulator."""

from neurotouch_hid.source.opening import FORMS, Speed, open_source
from neurotouch_hid.source.protocol import ActivityAware, LiveSource, Source
from neurotouch_hid.source.slicer import Slicer, slice_stream

__all__ = [
    "FORMS",
    "ActivityAware",
    "LiveSource",
    "Slicer",
    "Source",
    "Speed",
    "open_source",
    "slice_stream",
]

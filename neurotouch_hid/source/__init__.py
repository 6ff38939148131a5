"""Sources of packets: the camera, recordings and the simulator."""

from neurotouch_hid.source.check import FORMS, check_source
from neurotouch_hid.source.opening import Speed, open_source
from neurotouch_hid.source.protocol import ActivityAware, LiveSource, Source
from neurotouch_hid.source.slicer import Slicer, slice_stream

__all__ = [
    "FORMS",
    "ActivityAware",
    "LiveSource",
    "Slicer",
    "Source",
    "Speed",
    "check_source",
    "open_source",
    "slice_stream",
]

"""Sources of packets: the camera, recordings and the simulator."""

from neurotouch_hid.source.check import FORMS, check_source
from neurotouch_hid.source.opening import open_source
from neurotouch_hid.source.protocol import (
    ActivityAware,
    FactTelling,
    PolledSource,
    Source,
    Troubled,
)
from neurotouch_hid.source.slicer import Slicer, slice_recording

__all__ = [
    "FORMS",
    "ActivityAware",
    "FactTelling",
    "PolledSource",
    "Slicer",
    "Source",
    "Troubled",
    "check_source",
    "open_source",
    "slice_recording",
]

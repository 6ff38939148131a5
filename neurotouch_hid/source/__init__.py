"""Where packets come from: recordings, the simulator and, in a later version, the camera."""

from neurotouch_hid.source.opening import FORMS, Speed, open_source
from neurotouch_hid.source.protocol import Source
from neurotouch_hid.source.slicer import Slicer, slice_stream

__all__ = ["FORMS", "Slicer", "Source", "Speed", "open_source", "slice_stream"]

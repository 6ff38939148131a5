"""Sources of packets: the camera, recordings and the simulator.

A name loads its module when it is first asked for: a source is refused without numpy.
"""

from typing import TYPE_CHECKING

from neurotouch_hid.lazy import load_lazily

if TYPE_CHECKING:
    from neurotouch_hid.source.check import FORMS, check_source
    from neurotouch_hid.source.opening import open_source
    from neurotouch_hid.source.protocol import (
        ActivityAware,
        FactTelling,
        Periodic,
        PictureSource,
        PolledSource,
        SizedSource,
        Source,
        Troubled,
    )
else:
    __getattr__ = load_lazily(
        __name__,
        {
            "check": "FORMS check_source",
            "opening": "open_source",
            "protocol": "ActivityAware FactTelling Periodic PictureSource PolledSource "
            "SizedSource Source "
            "Troubled",
        },
    )

__all__ = [
    "FORMS",
    "ActivityAware",
    "FactTelling",
    "Periodic",
    "PictureSource",
    "PolledSource",
    "SizedSource",
    "Source",
    "Troubled",
    "check_source",
    "open_source",
]

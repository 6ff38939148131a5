"""The parts the mapping is made of, in the order a gesture passes them.

conditioned gesture: orientation, neutral, filter, range, latch, regions
    ─▶ binding runner, one for each binding: threshold ─ debounce ─ level ─ press ─ mode
    ─▶ output: buttons, axes, keys and mouse (response, slew, dwell)

A name loads its module when it is first asked for: a response curve needs no numpy.
"""

from typing import TYPE_CHECKING

from neurotouch_hid.lazy import load_lazily

if TYPE_CHECKING:
    from neurotouch_hid.profile.engine.conditioned_gesture import ConditionedGesture
    from neurotouch_hid.profile.engine.notch import Notch
    from neurotouch_hid.profile.engine.one_euro import FILTERS, OneEuro
    from neurotouch_hid.profile.engine.response import make_response
else:
    __getattr__ = load_lazily(
        __name__,
        {
            "conditioned_gesture": "ConditionedGesture",
            "notch": "Notch",
            "one_euro": "FILTERS OneEuro",
            "response": "make_response",
        },
    )

__all__ = ["FILTERS", "ConditionedGesture", "Notch", "OneEuro", "make_response"]

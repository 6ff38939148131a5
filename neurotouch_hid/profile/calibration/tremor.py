"""Proposes the weakest filter that is calm enough for a hand's tremor."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.profile.engine.one_euro import FILTERS, OneEuro
from neurotouch_hid.profile.engine.spectrum import Tremor, find_tremor
from neurotouch_hid.profile.schema.timing import FilterName

__all__ = ["Tremor", "find_tremor", "propose_filter", "smooth"]

GAP_MM: Final = 1.0
"""Between pressing at 2.5 and releasing at 1.5 mm."""


def propose_filter(mm: NDArray[np.float64], step_us: int) -> FilterName:
    """Returns the weakest filter that brings the tremor below the hysteresis.

    Args:
        mm: (n,) how far the hand was while it held, in mm.
        step_us: the time from one to the next.
    """
    names: tuple[FilterName, ...] = ("none", *FILTERS)
    for name in names:
        left = find_tremor(smooth(mm, step_us, name), step_us)
        if left is None or 2.0 * left.amplitude_mm <= GAP_MM:
            return name
    return names[-1]


def smooth(mm: NDArray[np.float64], step_us: int, name: FilterName) -> NDArray[np.float64]:
    """Returns a filtered hold, from 0.5 s on, where the filter has settled."""
    if name == "none":
        return mm
    one_euro = OneEuro(*FILTERS[name])
    smoothed = np.array([one_euro.update(float(value), step_us) for value in mm])
    return smoothed[round(500_000 / step_us) :]

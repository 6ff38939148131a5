"""Percentiles of all durations since the start, in a few kilobytes."""

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

CLASSES: Final = 320
"""Up to 2**42 ns, more than an hour; a longer duration counts as that."""


class Histogram:
    """Counts durations in classes that are an eighth of a power of two wide: 12 % at most."""

    def __init__(self) -> None:
        self._counts = np.zeros(CLASSES, np.int64)

    def add(self, took_ns: Sequence[int]) -> None:
        """Counts durations."""
        self._counts = self._counts + _count(took_ns)

    def percentiles(self, ranks: Sequence[float], newest_ns: Sequence[int] = ()) -> list[float]:
        """Returns percentiles of the durations in ns, by up to 12 % too large.

        Any thread may call it. They are 0 while nothing has been counted.

        Args:
            ranks: per cent, 0 to 100.
            newest_ns: durations that count as well, though they have not been added yet.
        """
        up_to = np.cumsum(self._counts + _count(newest_ns))
        if not up_to[-1]:
            return [0.0 for _ in ranks]
        first = np.searchsorted(up_to, np.maximum(up_to[-1] * np.asarray(ranks) / 100.0, 1.0))
        return [_find_edge(int(k)) for k in first]


def _count(took_ns: Sequence[int]) -> NDArray[np.int64]:
    """Returns how many durations are in each class."""
    took = np.array(took_ns, np.int64)
    shift = np.maximum(np.frexp(took)[1] - 4, 0)  # so that eight classes share a length in bits
    return np.bincount(np.minimum(8 * shift + (took >> shift), CLASSES - 1), minlength=CLASSES)


def _find_edge(k: int) -> float:
    """Returns the upper edge of a class."""
    shift = max(k // 8 - 1, 0)
    return float((k - 8 * shift + 1) << shift)

"""Percentiles of all durations since the start, in a few kilobytes."""

from typing import Final

CLASSES: Final = 320
"""Up to 2**42 ns, more than an hour; what takes longer counts as that."""


class Histogram:
    """Counts durations in classes that are an eighth of a power of two wide: 12 % at most."""

    def __init__(self) -> None:
        self._counts = [0] * CLASSES

    def add(self, took_ns: int) -> None:
        """Counts one duration."""
        shift = max(took_ns.bit_length() - 4, 0)
        self._counts[min(8 * shift + (took_ns >> shift), CLASSES - 1)] += 1

    def percentiles(self, *ranks: float) -> tuple[float, ...]:
        """Returns the durations in ns that so many per cent do not exceed, by up to 12 % too large.

        From any thread; 0 while nothing has been counted.

        Args:
            ranks: per cent, 0 to 100.
        """
        counts = self._counts.copy()
        n = sum(counts)
        return tuple(_find(counts, n * rank / 100.0) for rank in ranks)


def _find(counts: list[int], n_below: float) -> float:
    """Returns the upper edge of the class with which so many are counted."""
    n = 0
    for k, count in enumerate(counts):
        n += count
        if count and n >= n_below:
            shift = max(k // 8 - 1, 0)
            return float((k - 8 * shift + 1) << shift)
    return 0.0

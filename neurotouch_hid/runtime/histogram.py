"""Percentiles of all durations since the start, in a few kilobytes."""

from typing import Final

CLASSES: Final = 320
"""Up to 2**42 ns, more than an hour; a longer duration counts as that."""


class Histogram:
    """Counts durations in classes that are an eighth of a power of two wide: 12 % at most."""

    def __init__(self) -> None:
        self._counts = [0] * CLASSES

    def add(self, took_ns: int) -> None:
        """Counts one duration."""
        # With each stage of each step: comparisons take half as long as calls of max and min.
        shift = took_ns.bit_length() - 4
        k = took_ns if shift < 0 else 8 * shift + (took_ns >> shift)
        self._counts[k if k < CLASSES else -1] += 1

    def percentiles(self, *ranks: float) -> tuple[float, ...]:
        """Returns percentiles of the durations in ns, by up to 12 % too large.

        Any thread may call it. They are 0 while nothing has been counted.

        Args:
            ranks: per cent, 0 to 100.
        """
        counts = self._counts.copy()
        n = sum(counts)
        return tuple(_find(counts, n * rank / 100.0) for rank in ranks)


def _find(counts: list[int], n_below: float) -> float:
    """Returns the upper edge of the first class up to which ``n_below`` or more are counted."""
    n = 0
    for k, count in enumerate(counts):
        n += count
        if count and n >= n_below:
            shift = max(k // 8 - 1, 0)
            return float((k - 8 * shift + 1) << shift)
    return 0.0

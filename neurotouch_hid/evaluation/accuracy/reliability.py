"""Reliability of the confidence: the share of right types among slices of equal confidence."""

from collections import Counter
from dataclasses import dataclass, field

N_BINS = 10


@dataclass(slots=True, eq=False)
class Reliability:
    """Slices in which a gesture was recognised, by bins of its confidence; supports ``+``.

    Attributes:
        observations: slices by bin.
        right: those whose type is right.
        confidence: sums of their confidence.
    """

    observations: Counter[int] = field(default_factory=Counter)
    right: Counter[int] = field(default_factory=Counter)
    confidence: dict[int, float] = field(default_factory=dict)

    def add(self, confidence: float, *, is_right: bool) -> None:
        """Counts one slice.

        Args:
            confidence: 0..1; 1 belongs to the last bin.
            is_right: the type is the labelled one.
        """
        k = min(int(confidence * N_BINS), N_BINS - 1)
        self.observations[k] += 1
        self.right[k] += is_right
        self.confidence[k] = self.confidence.get(k, 0.0) + confidence

    def __add__(self, other: "Reliability") -> "Reliability":
        keys = self.confidence.keys() | other.confidence.keys()
        return Reliability(
            self.observations + other.observations,
            self.right + other.right,
            {k: self.confidence.get(k, 0.0) + other.confidence.get(k, 0.0) for k in keys},
        )

"""Labels of all moments of a recording, as arrays: proposals, a person's labels, another's."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.messages import GestureKind
from neurotouch_hid.recording.labels import MAX_CONTACTS

UNLABELLED = -1
"""The kind of a moment that nobody has labelled."""


@dataclass(frozen=True, slots=True)
class Run:
    """Neighbouring moments of one kind, both ends included."""

    first: int
    last: int
    kind: int


@dataclass(frozen=True, slots=True, eq=False)
class Track:
    """One label for each moment.

    Attributes:
        kind: (n,) int8, a ``GestureKind`` or ``UNLABELLED``.
        intensity_mm: (n,) float32.
        contacts_px: (n, 3, 2) float32, columns x, y in the canonical picture; NaN behind the last.
    """

    kind: NDArray[np.int8]
    intensity_mm: NDArray[np.float32]
    contacts_px: NDArray[np.float32]

    @classmethod
    def of_size(cls, n: int) -> "Track":
        """Returns a track without labels."""
        return cls(
            np.full(n, UNLABELLED, np.int8),
            np.zeros(n, np.float32),
            np.full((n, MAX_CONTACTS, 2), np.nan, np.float32),
        )

    def part(self, first: int, last: int) -> "Track":
        """Returns a copy of the moments from ``first`` to ``last``, both included."""
        chosen = slice(first, last + 1)
        return Track(
            self.kind[chosen].copy(),
            self.intensity_mm[chosen].copy(),
            self.contacts_px[chosen].copy(),
        )

    def put(self, first: int, part: "Track") -> None:
        """Replaces the moments from ``first`` on by those of another track."""
        chosen = slice(first, first + len(part.kind))
        self.kind[chosen] = part.kind
        self.intensity_mm[chosen] = part.intensity_mm
        self.contacts_px[chosen] = part.contacts_px

    def set(
        self, k: int, kind: int, intensity_mm: float, contacts_px: NDArray[np.floating]
    ) -> None:
        """Labels one moment.

        Args:
            k: the moment.
            kind: its kind.
            intensity_mm: its intensity.
            contacts_px: (m, 2); more than three are left out.
        """
        self.kind[k] = kind
        self.intensity_mm[k] = intensity_mm
        self.contacts_px[k] = np.nan
        points = contacts_px[:MAX_CONTACTS]
        self.contacts_px[k, : len(points)] = points

    @property
    def counts(self) -> NDArray[np.int64]:
        """The number of contacts at each moment, (n,)."""
        counts: NDArray[np.int64] = np.isfinite(self.contacts_px[:, :, 0]).sum(axis=1)
        return counts

    def points(self, k: int) -> NDArray[np.float64]:
        """Returns the contacts of a moment, (m, 2) px."""
        points = self.contacts_px[k].astype(np.float64)
        found: NDArray[np.float64] = points[np.isfinite(points[:, 0])]
        return found

    def run_at(self, k: int) -> Run:
        """Returns the run of equal kinds around a moment."""
        kind = int(self.kind[k])
        first = last = k
        while first > 0 and self.kind[first - 1] == kind:
            first -= 1
        while last + 1 < len(self.kind) and self.kind[last + 1] == kind:
            last += 1
        return Run(first, last, kind)

    def runs(self) -> Iterator[Run]:
        """Gives all runs, in order of time."""
        k = 0
        while k < len(self.kind):
            run = self.run_at(k)
            yield run
            k = run.last + 1


def is_gesture(kind: int) -> bool:
    """Returns True for a kind that is labelled and not rest."""
    return kind > GestureKind.NONE

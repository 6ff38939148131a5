"""Statistics of a data set's labels, as the paper gives them for its own."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import PAPER_GEL, Gel, Rig
from neurotouch_hid.messages import Truth


@dataclass(frozen=True, slots=True, eq=False)
class LabelStatistics:
    """The labels of one or more recordings as columns.

    Attributes:
        kinds: (n,) intp, ``GestureKind`` of each label.
        intensity_mm: (n,) float64.
        speed_mm_s: (m,) float64, change of intensity between neighbouring labels over their
            distance in time; negative on release.
        contacts_mm: (k, 2) float64, all labelled contact points on the gel, x right, y down.
        radius_mm: of the gel, the largest of several.
    """

    kinds: NDArray[np.intp]
    intensity_mm: NDArray[np.float64]
    speed_mm_s: NDArray[np.float64]
    contacts_mm: NDArray[np.float64]
    radius_mm: float

    @classmethod
    def of(
        cls, labels: Sequence[Truth], rig: Rig | None, gel: Gel = PAPER_GEL
    ) -> "LabelStatistics":
        """Returns the columns of one recording.

        Without a rig there are no contact points: their places on the gel are unknown.

        Differs: the paper draws its points in the image; recordings of several rigs share the gel.
        """
        intensity_mm = np.array([label.intensity_mm for label in labels])
        seconds = np.diff(np.array([label.t_us for label in labels])) / 1e6
        points = [label.contacts_px for label in labels if rig is not None]
        contacts_px = np.concatenate([np.zeros((0, 2)), *points])
        return cls(
            np.array([label.kind for label in labels], dtype=np.intp),
            intensity_mm,
            np.diff(intensity_mm) / seconds,
            contacts_px if rig is None else rig.to_mm(contacts_px),
            gel.radius_mm,
        )

    @classmethod
    def joined(cls, parts: Sequence["LabelStatistics"]) -> "LabelStatistics":
        """Returns the columns of all recordings; at least one."""
        return cls(
            np.concatenate([part.kinds for part in parts]),
            np.concatenate([part.intensity_mm for part in parts]),
            np.concatenate([part.speed_mm_s for part in parts]),
            np.concatenate([part.contacts_mm for part in parts]),
            max(part.radius_mm for part in parts),
        )

"""What is counted while predictions are compared with labels; two tallies add up."""

from collections import Counter
from dataclasses import dataclass, field, fields

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import Rig
from neurotouch_hid.messages import Gesture, GestureKind, Truth

BIN_MM = 0.6  # [NT, figure of the intensity labels]: each bin has a size of 0.6 mm


def _square() -> NDArray[np.int64]:
    return np.zeros((len(GestureKind), len(GestureKind)), np.int64)


@dataclass(slots=True, eq=False)
class Tally:
    """Sums over observations: an observation is one prediction against the labels at its moment.

    Attributes:
        confusion: (6, 6) int64, observations by labelled (row) and predicted (column) type.
        right_counts: observations whose number of contacts is right.
        distance_mm: sum of the distances of predicted contacts to their nearest labelled contact.
        distances: how many there are.
        intensity_error_mm: sum of |predicted - labelled| where a gesture is labelled.
        rest: frames by (labelled at rest, detected at rest).
        binned: observations with a labelled gesture by intensity bin.
        binned_types: those of them whose type is right.
        binned_counts: those of them whose number of contacts is right.
        frames: frames seen.
        events: events seen.
        sensor_s: sensor time seen.
        host_s: time of one core that it took.
    """

    confusion: NDArray[np.int64] = field(default_factory=_square)
    right_counts: int = 0
    distance_mm: float = 0.0
    distances: int = 0
    intensity_error_mm: float = 0.0
    rest: Counter[tuple[bool, bool]] = field(default_factory=Counter)
    binned: Counter[int] = field(default_factory=Counter)
    binned_types: Counter[int] = field(default_factory=Counter)
    binned_counts: Counter[int] = field(default_factory=Counter)
    frames: int = 0
    events: int = 0
    sensor_s: float = 0.0
    host_s: float = 0.0

    def add_gesture(self, gesture: Gesture, truth: Truth, rig: Rig | None) -> None:
        """Counts one observation [NT, "Metrics"].

        Args:
            gesture: the prediction.
            truth: the labels at the same moment.
            rig: millimetres of the image; None leaves the distances out.
        """
        same_type = gesture.kind is truth.kind
        same_count = len(gesture.contacts_px) == len(truth.contacts_px)
        self.confusion[truth.kind, gesture.kind] += 1
        self.right_counts += same_count
        if rig is not None:
            distances = measure_distances(gesture.contacts_px, truth.contacts_px)
            self.distance_mm += float(distances.sum()) / rig.px_per_mm
            self.distances += len(distances)
        if truth.kind is not GestureKind.NONE:
            self.intensity_error_mm += abs(gesture.intensity_mm - truth.intensity_mm)
            k = int(truth.intensity_mm / BIN_MM)
            self.binned[k] += 1
            self.binned_types[k] += same_type
            self.binned_counts[k] += same_count

    def add_rest(self, *, labelled: bool, detected: bool) -> None:
        """Counts one frame of the rest detection."""
        self.rest[labelled, detected] += 1

    def __add__(self, other: "Tally") -> "Tally":
        return Tally(
            **{f.name: getattr(self, f.name) + getattr(other, f.name) for f in fields(self)}
        )


def measure_distances(
    predicted: NDArray[np.float64], labelled: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Distance of each predicted point to its nearest labelled point; the surplus is dropped.

    [NT, "Metrics"]: where more points are predicted than labelled, the furthest are discarded.

    Args:
        predicted: (n, 2) px.
        labelled: (m, 2) px.

    Returns:
        (min(n, m),) px, ascending.
    """
    if not len(predicted) or not len(labelled):
        return np.zeros(0)
    distance = np.linalg.norm(predicted[:, None] - labelled[None], axis=2).min(axis=1)
    return np.sort(distance)[: len(labelled)]

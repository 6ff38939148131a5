"""Counts of the comparison of predictions with labels; two tallies can be added."""

from collections import Counter
from dataclasses import dataclass, field, fields

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.evaluation.accuracy.reliability import Reliability
from neurotouch_hid.evaluation.accuracy.type_timing import FIRM_MM, TypeTiming
from neurotouch_hid.geometry import Rig
from neurotouch_hid.messages import Gesture, GestureKind, Truth

BIN_MM = 0.6  # [NT, figure of the intensity labels]: each bin has a size of 0.6 mm


def _square() -> NDArray[np.int64]:
    return np.zeros((len(GestureKind), len(GestureKind)), np.int64)


def _counts() -> NDArray[np.int64]:
    return np.zeros(len(GestureKind), np.int64)


def _sums() -> NDArray[np.float64]:
    return np.zeros(len(GestureKind))


@dataclass(slots=True, eq=False)
class Tally:
    """Sums over observations: an observation is one prediction against the labels at its moment.

    Attributes:
        confusion: (6, 6) int64, observations by labelled (row) and predicted (column) type.
        right_counts: (6,) int64, observations whose number of contacts is right, by labelled type.
        distance_mm: (6,) float64, sums of the distances of predicted contacts to their nearest
            labelled contact, by labelled type.
        distances: (6,) int64, number of these distances.
        intensity_error_mm: (6,) float64, sums of |predicted - labelled| where a gesture is
            labelled, by labelled type.
        firm: observations with a labelled gesture of at least ``FIRM_MM``.
        firm_types: number of those whose type is right.
        rest: frames by (labelled at rest, detected at rest).
        binned: observations with a labelled gesture by intensity bin.
        binned_types: number of those whose type is right.
        binned_counts: number of those whose number of contacts is right.
        timing: times until types are recognised, and gestures recognised at rest.
        reliability: share of right types by confidence.
        frames: frames seen.
        events: events seen.
        sensor_s: sensor time seen.
        host_s: host time that it took on one core.
    """

    confusion: NDArray[np.int64] = field(default_factory=_square)
    right_counts: NDArray[np.int64] = field(default_factory=_counts)
    distance_mm: NDArray[np.float64] = field(default_factory=_sums)
    distances: NDArray[np.int64] = field(default_factory=_counts)
    intensity_error_mm: NDArray[np.float64] = field(default_factory=_sums)
    firm: int = 0
    firm_types: int = 0
    rest: Counter[tuple[bool, bool]] = field(default_factory=Counter)
    binned: Counter[int] = field(default_factory=Counter)
    binned_types: Counter[int] = field(default_factory=Counter)
    binned_counts: Counter[int] = field(default_factory=Counter)
    timing: TypeTiming = field(default_factory=TypeTiming)
    reliability: Reliability = field(default_factory=Reliability)
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
        self.right_counts[truth.kind] += same_count
        if gesture.kind is not GestureKind.NONE:
            self.reliability.add(gesture.confidence, is_right=same_type)
        if rig is not None:
            distances = measure_distances(gesture.contacts_px, truth.contacts_px)
            if len(distances):
                self.distance_mm[truth.kind] += float(distances.sum()) / rig.px_per_mm
                self.distances[truth.kind] += len(distances)
        if truth.kind is not GestureKind.NONE:
            error_mm = abs(gesture.intensity_mm - truth.intensity_mm)
            self.intensity_error_mm[truth.kind] += error_mm
            if truth.intensity_mm >= FIRM_MM:
                self.firm += 1
                self.firm_types += same_type
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
    """Returns the distance of each predicted point to its nearest labelled point.

    [NT, "Metrics"]: if more points are predicted than labelled, the furthest are dropped.

    Args:
        predicted: (n, 2) px.
        labelled: (m, 2) px.

    Returns:
        (min(n, m),) px, ascending.
    """
    if not len(predicted) or not len(labelled):
        return np.zeros(0)
    away = predicted[:, None] - labelled
    nearest: NDArray[np.float64] = np.sqrt((away * away).sum(axis=2)).min(axis=1)
    nearest.sort()
    return nearest[: len(labelled)]

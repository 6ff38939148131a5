"""Finds the worst moments of a recording, for the report's pictures."""

from dataclasses import dataclass

from neurotouch_hid.evaluation.accuracy.tally import measure_distances
from neurotouch_hid.geometry import Rig
from neurotouch_hid.messages import Gesture, GestureKind, MarkerField, Truth

N_WORST = 10
FINGERTIP_MM = 12.0  # typical radius of a fingertip [NT, "Results"]


@dataclass(frozen=True, slots=True, eq=False)
class WorstMoment:
    """Markers, prediction and labels at one moment.

    Attributes:
        severity_mm: size of the error; see ``measure_severity``.
        since_s: sensor time since the recording began.
        markers: the tracked markers.
        gesture: the prediction.
        truth: the labels.
        rig: millimetres of the image.
    """

    severity_mm: float
    since_s: float
    markers: MarkerField
    gesture: Gesture
    truth: Truth
    rig: Rig


def measure_severity(gesture: Gesture, truth: Truth, rig: Rig) -> float:
    """Returns the size of the error of a prediction, in mm.

    The error of the intensity; plus the larger of both intensities times the sum of three shares:
    1 for a wrong type, the share of the contacts that are too many or too few, and the mean contact
    distance in fingertip radii, at most 1. So an error in the middle of a strong gesture counts
    more than one at its faint beginning.
    """
    n_seen, n_labelled = len(gesture.contacts_px), len(truth.contacts_px)
    share = float(gesture.kind is not truth.kind)
    share += abs(n_seen - n_labelled) / max(n_seen, n_labelled, 1)
    distances_px = measure_distances(gesture.contacts_px, truth.contacts_px)
    if len(distances_px):
        distances_mm = distances_px / rig.px_per_mm
        share += min(float(distances_mm.mean()) / FINGERTIP_MM, 1.0)
    strength_mm = max(gesture.intensity_mm, truth.intensity_mm)
    return float(abs(gesture.intensity_mm - truth.intensity_mm) + strength_mm * share)


class WorstMoments:
    """Keeps the worst moment of each stretch of one label, and of those the worst ten."""

    def __init__(self) -> None:
        self._kept: list[WorstMoment] = []
        self._labelled: GestureKind | None = None
        self._worst: WorstMoment | None = None  # of the stretch that goes on

    def add(
        self, since_s: float, markers: MarkerField, gesture: Gesture, truth: Truth, rig: Rig
    ) -> None:
        """Adds one slice that ends ``since_s`` after the beginning of the recording."""
        if truth.kind is not self._labelled:
            self._kept, self._worst, self._labelled = self.ranked(), None, truth.kind
        severity_mm = measure_severity(gesture, truth, rig)
        if severity_mm > (self._worst.severity_mm if self._worst is not None else 0.0):
            self._worst = WorstMoment(severity_mm, since_s, markers, gesture, truth, rig)

    def ranked(self) -> list[WorstMoment]:
        """Returns the worst moments so far, the worst first; at most ``N_WORST``."""
        all_moments = [*self._kept, *([self._worst] if self._worst is not None else [])]
        return sorted(all_moments, key=lambda moment: -moment.severity_mm)[:N_WORST]

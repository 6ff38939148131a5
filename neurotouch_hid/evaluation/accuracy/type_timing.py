"""Times until the type of a gesture is recognised, and false gestures at rest."""

from dataclasses import dataclass, field, fields

from neurotouch_hid.evaluation.accuracy.label_track import LabelTrack
from neurotouch_hid.messages import GestureKind, Truth

FIRM_MM = 2.5
"""Intensity from which a type should be certain [NT, "Results"]: 90 % are right from here on."""
SETTLE_US = 500_000
"""At rest, no gesture is labelled within this time. In the frames around a gesture that are
labelled none, the gel still creeps, or the first finger already touches it."""


@dataclass(slots=True, eq=False)
class TypeTiming:
    """Sums over labelled gestures and over the time at rest; supports ``+``.

    Attributes:
        gestures: labelled gestures that reach ``FIRM_MM``.
        times_ms: for each of those whose type is recognised later: the time until then.
        changes: number of those whose type changed after it was recognised.
        false_gestures: number of gestures that began at rest.
        rest_s: sensor time at rest.
    """

    gestures: int = 0
    times_ms: list[float] = field(default_factory=list)
    changes: int = 0
    false_gestures: int = 0
    rest_s: float = 0.0

    def __add__(self, other: "TypeTiming") -> "TypeTiming":
        return TypeTiming(
            **{f.name: getattr(self, f.name) + getattr(other, f.name) for f in fields(self)}
        )


class Stopwatch:
    """Follows the slices of one recording and counts into a ``TypeTiming``.

    A gesture is a stretch of labels of one type. Its type counts as changed if, after it has been
    recognised, another gesture is recognised before the stretch ends, or none while the labelled
    intensity is still at least ``FIRM_MM``.

    Args:
        labels: of the recording.
    """

    def __init__(self, labels: LabelTrack) -> None:
        self.timing = TypeTiming()
        self._labels = labels
        self._labelled = GestureKind.NONE
        self._firm_us: int | None = None  # when this gesture reached FIRM_MM
        self._is_right = False
        self._has_changed = False
        self._false_before = False

    def add(self, t_us: int, slice_us: int, truth: Truth, kind: GestureKind) -> None:
        """Counts one slice.

        Args:
            t_us: its end.
            slice_us: its length.
            truth: the labels at its end.
            kind: the recognised type.
        """
        if truth.kind is not self._labelled:
            self._labelled = truth.kind
            self._firm_us, self._is_right, self._has_changed = None, False, False
        if truth.kind is GestureKind.NONE:
            self._watch_rest(t_us, slice_us, kind)
        else:
            self._watch_gesture(t_us, truth, kind)

    def _watch_rest(self, t_us: int, slice_us: int, kind: GestureKind) -> None:
        is_rest = self._labels.is_rest(t_us, SETTLE_US)
        is_false = is_rest and kind is not GestureKind.NONE
        self.timing.rest_s += is_rest * slice_us / 1e6
        self.timing.false_gestures += is_false and not self._false_before
        self._false_before = is_false

    def _watch_gesture(self, t_us: int, truth: Truth, kind: GestureKind) -> None:
        self._false_before = False
        is_firm = truth.intensity_mm >= FIRM_MM
        if is_firm and self._firm_us is None:
            self._firm_us = t_us
            self.timing.gestures += 1
        if self._firm_us is None:
            return
        if kind is truth.kind:
            if not self._is_right:
                self._is_right = True
                self.timing.times_ms.append((t_us - self._firm_us) / 1e3)
        elif self._is_right and not self._has_changed:
            self._has_changed = is_firm or kind is not GestureKind.NONE
            self.timing.changes += self._has_changed

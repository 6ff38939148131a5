"""Logs gestures that ended just below a threshold, so that people see why nothing happened."""

from collections.abc import Collection
from typing import Final

from neurotouch_hid.messages import GestureKind
from neurotouch_hid.profile.decision_log import DecisionLog
from neurotouch_hid.profile.engine.binding_runner import BindingRunner
from neurotouch_hid.profile.engine.conditioned_gesture import ConditionedGesture

NEAR: Final = 0.5
"""A gesture that stays below this share of a threshold was not meant for it."""
NEAR_BESIDE_AXIS: Final = 0.8
"""The same where an axis, a stick or the pointer follows the gesture: it may be meant for that."""


class MissedThreshold:
    """Watches one layer for gestures that end just below every threshold.

    A gesture counts as missed if nothing was down while it lasted, and its peak is between half
    of the lowest threshold and the threshold. What follows a gesture from its start has no
    threshold to miss, but where something does, the peak must be nearer to the threshold.

    Args:
        log: gets the decision ``missed``.
    """

    __slots__ = ("_acted", "_kind", "_label", "_log", "_near", "_on_mm", "_peak_mm")

    def __init__(self, log: DecisionLog) -> None:
        self._log = log
        self._kind = GestureKind.NONE
        self._acted = False
        self._label = ""
        self._peak_mm = self._on_mm = 0.0
        self._near = NEAR

    def update(self, reading: ConditionedGesture, wanted: Collection[BindingRunner]) -> None:
        """Takes one reading.

        Args:
            reading: the gesture.
            wanted: the bindings whose kind and direction it has.
        """
        if reading.kind != self._kind:
            if reading.kind == GestureKind.NONE:
                self._tell()
                self._begin(GestureKind.NONE, acted=False)
                return
            self._begin(reading.kind, acted=self._acted)
        if self._acted:
            return
        for each in wanted:
            if each.down and each.on_mm > 0.0:
                self._acted = True
                return
        if reading.mm <= self._peak_mm:
            return
        self._peak_mm, self._on_mm = reading.mm, 0.0
        for each in wanted:
            if each.on_mm == 0.0:
                self._near = NEAR_BESIDE_AXIS
            elif not self._on_mm or each.on_mm < self._on_mm:
                self._on_mm, self._label = each.on_mm, each.label

    def _tell(self) -> None:
        if not self._acted and self._near * self._on_mm <= self._peak_mm < self._on_mm:
            digits = 1 if round(self._peak_mm, 1) < self._on_mm else 3  # never "7 mm < 7 mm"
            why = f"peak {self._peak_mm:.{digits}f} mm < {self._on_mm:g} mm"
            self._log.note("missed", self._label, why)

    def _begin(self, kind: GestureKind, *, acted: bool) -> None:
        self._kind, self._acted = kind, acted
        self._peak_mm = self._on_mm = 0.0
        self._near = NEAR

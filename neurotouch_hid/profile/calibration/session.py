"""A calibration in progress: its steps, the repetitions of each, and the results."""

from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.messages import Gesture
from neurotouch_hid.profile.calibration.repetition import Repetition, RepetitionFinder
from neurotouch_hid.profile.calibration.result import (
    LEAST_PEAK_MM,
    LEAST_PEAKS,
    measure_range,
    measure_rest,
)
from neurotouch_hid.profile.calibration.tremor import Tremor, find_tremor, propose_filter
from neurotouch_hid.profile.calibration.unfinished import Progress
from neurotouch_hid.profile.engine.even_readings import READING_US, ReadingClock
from neurotouch_hid.profile.engine.input_conditioner import InputConditioner
from neurotouch_hid.profile.schema.movements import MOVEMENTS
from neurotouch_hid.profile.schema.timing import FilterName
from neurotouch_hid.profile.schema.user import MovementRange, Ranges, UserSettings
from neurotouch_hid.vocabulary import GestureKind

NEUTRAL: Final = "neutral"
HOLD: Final = "hold"
EVERYTHING: Final = "everything"
_HOLD_SHARE: Final = 0.6
_ALL_KINDS: Final = frozenset(kind for kind in GestureKind if kind != GestureKind.NONE)
_NEUTRAL_READINGS: Final = 300
"""The last 3 s before the next step count as rest; earlier readings, of laying the hand down, do
not."""
_SETTLE_READINGS: Final = 30
"""Readings beside a repetition that do not count as rest, before and after it: 0.3 s."""


@dataclass(slots=True)
class _Measured:
    """Holds the measurements of the steps so far."""

    peaks_mm: dict[str, list[float]] = field(default_factory=dict)
    resting_mm: list[float] = field(default_factory=list)
    hold_mm: list[float] = field(default_factory=list)


class CalibrationSession:
    """Measures one step after another; each lasts until a person says so.

    Args:
        user: the person; orientation and neutral hold, ranges and filter do not.
        movements: the movements to be measured, in this order.
        guided: ask for them one by one, first for rest and a hold; otherwise take every movement
            for what it is, as from a recording.

    Attributes:
        movements: the movements to be measured.
        steps: the names of all steps.
    """

    def __init__(
        self, user: UserSettings, movements: tuple[str, ...] = (), *, guided: bool = True
    ) -> None:
        plain = user.model_copy(
            update={"range": Ranges(), "unused": [], "filter": None, "tremor_hz": None}
        )
        self._reader = InputConditioner(plain, "none", _ALL_KINDS, latch=True)
        self.movements = movements or tuple(MOVEMENTS)
        self.steps = (NEUTRAL, HOLD, *self.movements) if guided else (EVERYTHING,)
        self._clock, self._t_us = ReadingClock(), 0
        self.restart()

    def restart(self) -> None:
        """Begins again: what was measured is forgotten."""
        self._at = 0
        self._skipped: set[str] = set()
        self._measured = _Measured()
        self._still_mm: list[float] = []
        self._latest_hold: list[float] = []
        self._finder = RepetitionFinder()

    @property
    def progress(self) -> Progress:
        """The measurements so far."""
        measured = self._measured
        return Progress(
            steps=list(self.steps),
            at=self._at,
            skipped=sorted(self._skipped),
            peaks_mm=self.peaks_mm,
            resting_mm=list(measured.resting_mm),
            hold_mm=list(measured.hold_mm),
        )

    def resume(self, progress: Progress) -> None:
        """Goes on with the measurements of the same steps."""
        self.restart()
        self._at = progress.at
        self._skipped = set(progress.skipped)
        self._measured = _Measured(
            dict(progress.peaks_mm), list(progress.resting_mm), list(progress.hold_mm)
        )

    @property
    def step(self) -> str | None:
        """``neutral``, ``hold``, a movement, or ``everything``; None at the end."""
        return self.steps[self._at] if self._at < len(self.steps) else None

    def next(self) -> None:
        """Ends this step."""
        self._at = min(self._at + 1, len(self.steps))
        self._finder = RepetitionFinder()

    def skip(self) -> None:
        """Leaves out this step."""
        if self.step is not None:
            self._skipped.add(self.step)
            self._measured.peaks_mm.pop(self.step, None)
        self.next()

    def back(self) -> None:
        """Repeats the step before, from its beginning."""
        self._at = max(self._at - 1, 0)
        step = self.steps[self._at]
        self._skipped.discard(step)
        self._measured.peaks_mm.pop(step, None)
        if step == NEUTRAL:
            self._measured.resting_mm.clear()
        if step == HOLD:
            self._measured.hold_mm.clear()
        self._finder = RepetitionFinder()

    def take(self, gesture: Gesture) -> Repetition | None:
        """Processes one gesture; returns the repetition it ends."""
        reading = self._reader.read(gesture)
        n = self._clock.count(gesture.t_us - self._t_us)
        self._t_us = gesture.t_us
        if n is None:
            self._end_hold()
            return None
        raw_mm = float(gesture.intensity_mm)
        if self.step == NEUTRAL:
            resting_mm = self._measured.resting_mm
            resting_mm += [raw_mm] * n
            del resting_mm[:-_NEUTRAL_READINGS]
            return None
        if not n:
            return None
        repetition = self._finder.update(reading)
        self._collect(reading.mm, raw_mm, n)
        if repetition is not None and self.accepts(repetition):
            self._measured.peaks_mm.setdefault(repetition.movement, []).append(repetition.peak_mm)
        return repetition

    def accepts(self, repetition: Repetition) -> bool:
        """Returns True if it is what was asked for, and far enough."""
        asked = self.step in (EVERYTHING, repetition.movement)
        return asked and repetition.peak_mm >= LEAST_PEAK_MM

    def _collect(self, mm: float, raw_mm: float, n: int) -> None:
        """Collects the rest between repetitions, and the longest stretch of one held movement."""
        if self._finder.is_moving:
            self._rest()
            if mm < _HOLD_SHARE * self._finder.peak_mm:
                self._end_hold()
            elif mm > 0.0:
                self._latest_hold += [mm] * n
            return
        self._end_hold()
        self._still_mm += [raw_mm] * n

    def _rest(self) -> None:
        """Collects the rest between two movements, but not right beside them."""
        if self.step == EVERYTHING:
            self._measured.resting_mm += self._still_mm[_SETTLE_READINGS:-_SETTLE_READINGS]
        self._still_mm = []

    def _end_hold(self) -> None:
        if self.step in (HOLD, EVERYTHING) and len(self._latest_hold) > len(self._measured.hold_mm):
            self._measured.hold_mm = self._latest_hold
        self._latest_hold = []

    @property
    def rest_mm(self) -> float:
        """The noise limit."""
        return measure_rest(self._measured.resting_mm)

    @property
    def ranges(self) -> dict[str, MovementRange | None]:
        """The range of each movement made often enough; None for one that was skipped.

        All others are left out: no movement is switched off unless a person says so.
        """
        measured = {name: self._measure(name) for name in self.movements}
        return {
            name: range_
            for name, range_ in measured.items()
            if range_ is not None or name in self._skipped
        }

    @property
    def unfinished(self) -> dict[str, int]:
        """The number of repetitions of each movement that was not made often enough."""
        return {
            name: len(peaks)
            for name, peaks in self._measured.peaks_mm.items()
            if self._measure(name) is None and name not in self._skipped
        }

    @property
    def made(self) -> int:
        """The number of repetitions of this step's movement that counted."""
        return len(self._measured.peaks_mm.get(self.step or "", ()))

    @property
    def missing(self) -> int:
        """The number of repetitions this step still needs."""
        return max(LEAST_PEAKS - self.made, 0) if self.step in self.movements else 0

    @property
    def held_s(self) -> float:
        """For how long the present movement has been held; 0 while there is none."""
        return len(self._latest_hold) * READING_US / 1e6

    def _measure(self, name: str) -> MovementRange | None:
        return measure_range(self._measured.peaks_mm.get(name, ()), self.rest_mm)

    @property
    def peaks_mm(self) -> dict[str, list[float]]:
        """The peaks of the repetitions that counted, by movement."""
        return {name: list(peaks) for name, peaks in self._measured.peaks_mm.items()}

    @property
    def tremor(self) -> Tremor | None:
        """The tremor while a movement was held; None if there is none or nothing was held."""
        return find_tremor(self._hold(), READING_US)

    @property
    def tremor_filter(self) -> FilterName | None:
        """The weakest filter that is calm enough; None if nothing was held long enough."""
        hold = self._hold()
        enough = len(hold) * READING_US >= 3_000_000
        return propose_filter(hold, READING_US) if enough else None

    def _hold(self) -> NDArray[np.float64]:
        """Returns the middle of the longest hold: its beginning and end are movements."""
        hold = self._measured.hold_mm
        edge = min(len(hold) // 5, 500_000 // READING_US)
        return np.array(hold[edge : len(hold) - edge])

"""Finds the repetitions of a movement in a stream of readings: attack, hold, release."""

from collections import deque
from dataclasses import dataclass, field
from statistics import median
from typing import Final

from neurotouch_hid.profile.engine.conditioned_gesture import ConditionedGesture
from neurotouch_hid.profile.schema.movements import name_movement

BEGIN_MM: Final = 1.5
END_MM: Final = 1.0
END_SHARE: Final = 0.3
"""A repetition ends below 1 mm or below 0.3 of its peak: some hands never come back entirely."""

AGAIN_MM: Final = 1.5
"""Above what was left at the end, another one begins this far up."""

SMOOTHED: Final = 5
"""Readings whose median is taken, so that one wrong measurement is no peak: 50 ms."""


@dataclass(frozen=True, slots=True)
class Repetition:
    """A movement there and back.

    Attributes:
        movement: which of the eight it was most of the time, weighed by how far it went.
        peak_mm: how far.
        begin_us: when it began.
        end_us: when it had ended.
    """

    movement: str
    peak_mm: float
    begin_us: int
    end_us: int


@dataclass(slots=True)
class RepetitionFinder:
    """Gives each repetition once it is over.

    Attributes:
        peak_mm: how far the present repetition has gone, or the last one went.
    """

    peak_mm: float = 0.0
    _window: deque[float] = field(default_factory=lambda: deque(maxlen=SMOOTHED))
    _votes: dict[str, float] = field(default_factory=dict)
    _begin_us: int | None = None
    _left_mm: float = 0.0

    @property
    def is_moving(self) -> bool:
        """True within a repetition."""
        return self._begin_us is not None

    def update(self, reading: ConditionedGesture) -> Repetition | None:
        """Returns the repetition that this reading ends, if it ends one."""
        self._window.append(reading.mm)
        mm = median(self._window)
        if self._begin_us is None:
            self._left_mm = min(self._left_mm, mm)
            if mm >= max(BEGIN_MM, self._left_mm + AGAIN_MM):
                self._begin_us, self.peak_mm, self._votes = reading.t_us, mm, {}
            return None
        movement = name_movement(reading.kind, reading.four)
        if movement is not None:
            self._votes[movement] = self._votes.get(movement, 0.0) + reading.mm
        self.peak_mm = max(self.peak_mm, mm)
        if mm >= max(END_MM, END_SHARE * self.peak_mm):
            return None
        begin_us, self._begin_us, self._left_mm = self._begin_us, None, mm
        if not self._votes:
            return None
        best = max(self._votes, key=lambda name: self._votes[name])
        return Repetition(best, self.peak_mm, begin_us, reading.t_us)

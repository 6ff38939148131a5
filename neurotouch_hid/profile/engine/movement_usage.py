"""Tracks the cost of each movement for the hand: peaks that fade, and long holds.

It only watches; a suggestion changes nothing by itself.
"""

from collections import deque
from dataclasses import dataclass, field
from statistics import median
from typing import Final

from neurotouch_hid.messages import GestureKind
from neurotouch_hid.profile.engine.conditioned_gesture import ConditionedGesture
from neurotouch_hid.profile.schema.movements import name_movement
from neurotouch_hid.profile.schema.profile import DEFAULT_FULL_MM, DEFAULT_REST_MM
from neurotouch_hid.profile.schema.user import Ranges

USES: Final = 50
FADED: Final = 0.8
"""Tired when the median peak of the last 50 uses is 20 % below the calibrated full range, or below
that of the first 50 uses where the movement was never calibrated."""

LEAST_SHARE: Final = 0.6
"""No suggestion goes below this share of the range one began with."""

USE_MM: Final = 2.5
HELD_SHARE: Final = 0.2
LONG_US: Final = 5_000_000
"""About 15 to 20 % of one's most is what muscles keep up for long (Rohmert)."""


@dataclass(frozen=True, slots=True)
class MovementUsage:
    """One movement so far.

    Attributes:
        movement: as in the user's ranges, ``push_left`` or ``zoom``.
        uses: how often it was made.
        peak_mm: median peak of the latest uses, in mm of the reference hand.
        share: how far it goes now, as a share of what it went; None while it has not faded.
        full_mm: the full range that fits this, in the person's own mm; None likewise.
        long_holds: how often it was held for more than 5 s: a toggle would be easier.
    """

    movement: str
    uses: int
    peak_mm: float
    share: float | None
    full_mm: float | None
    long_holds: int


@dataclass(slots=True)
class _Record:
    first: list[float] = field(default_factory=list)
    latest: deque[float] = field(default_factory=lambda: deque(maxlen=USES))
    uses: int = 0
    long_holds: int = 0


class UsageTracker:
    """Watches readings, gesture by gesture."""

    def __init__(self, ranges: Ranges) -> None:
        self._ranges = ranges
        self._records: dict[str, _Record] = {}
        self._movement = ""
        self._peak_mm = 0.0
        self._held_since_us: int | None = None
        self._long = False

    def update(self, reading: ConditionedGesture) -> None:
        """Takes one reading."""
        if reading.kind == GestureKind.NONE:
            self._finish()
            return
        if reading.mm > self._peak_mm:
            self._peak_mm = reading.mm
            self._movement = name_movement(reading.kind, reading.four) or ""
        extent_mm = DEFAULT_FULL_MM[reading.kind] - DEFAULT_REST_MM
        if reading.mm < DEFAULT_REST_MM + HELD_SHARE * extent_mm:
            self._held_since_us = None
        elif self._held_since_us is None:
            self._held_since_us = reading.t_us
        elif reading.t_us - self._held_since_us > LONG_US:
            self._long = True

    def report(self) -> tuple[MovementUsage, ...]:
        """Returns every movement that was made, by name."""
        return tuple(self._judge(name, record) for name, record in sorted(self._records.items()))

    def rest(self) -> None:
        """Starts over after a rest of the hand: only what follows shows whether it is tired."""
        for record in self._records.values():
            record.latest.clear()

    def _finish(self) -> None:
        if self._movement and self._peak_mm >= USE_MM:
            record = self._records.setdefault(self._movement, _Record())
            record.uses += 1
            record.long_holds += self._long
            record.latest.append(self._peak_mm)
            if len(record.first) < USES:
                record.first.append(self._peak_mm)
        self._movement, self._peak_mm = "", 0.0
        self._held_since_us, self._long = None, False

    def _judge(self, movement: str, record: _Record) -> MovementUsage:
        peak_mm = median(record.latest) if record.latest else 0.0
        own = getattr(self._ranges, movement)
        usual_mm = DEFAULT_FULL_MM[find_kind(movement)]
        fresh_mm, least_uses = (median(record.first), 2 * USES) if own is None else (usual_mm, USES)
        share = full_mm = None
        watched = len(record.latest) == USES and record.uses >= least_uses
        if watched and peak_mm <= FADED * fresh_mm:
            share = max(peak_mm / fresh_mm, LEAST_SHARE)
            full_mm = round(share * (usual_mm if own is None else own.full), 1)
        return MovementUsage(
            movement, record.uses, round(peak_mm, 1), share, full_mm, record.long_holds
        )


def find_kind(movement: str) -> GestureKind:
    """Returns the gesture a movement of the user's ranges belongs to."""
    return GestureKind["PUSH" if movement.startswith("push") else movement.upper()]

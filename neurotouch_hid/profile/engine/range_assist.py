"""Lets a tiring hand reach full output sooner; after a pause the ranges are as before."""

import math
from collections.abc import Iterable
from typing import Final

from neurotouch_hid.messages import GestureKind
from neurotouch_hid.profile.engine.conditioned_gesture import ConditionedGesture
from neurotouch_hid.profile.engine.movement_usage import MovementUsage, find_kind
from neurotouch_hid.profile.schema.profile import DEFAULT_FULL_MM, DEFAULT_REST_MM
from neurotouch_hid.profile.schema.user import MovementRange, Ranges

STEP: Final = 0.01
STEP_US: Final = 60_000_000
"""At most 1 % a minute, too slow to be felt as a change."""

RESTED_US: Final = 300_000_000
"""Five minutes without a movement are a pause, whether announced or not."""

NOISE_FACTOR: Final = 2.5
"""Up to this multiple of what is noise at rest nothing ever changes, so no threshold gets there."""

MOST_GAIN: Final = 2.0
"""Above that a movement counts at most double, or it could not be steered any more."""

_Bend = tuple[float, float]
"""Up to the first nothing changes; the second counts as full. Both in mm of the reference hand."""


class RangeAssist:
    """Moves the full range of each movement towards what the hand still does.

    Changes happen only between gestures, so nothing jumps in the hand.
    """

    def __init__(self, ranges: Ranges) -> None:
        self._ranges = ranges
        self._shares: dict[str, float] = {}
        self._bends: dict[str, _Bend] = {}
        self._stepped_us: int | None = None

    @property
    def shares(self) -> dict[str, float]:
        """The share of its full range that each movement needs now, where that is less than 1."""
        return dict(self._shares)

    def is_due(self, t_us: int) -> bool:
        """Returns True once a minute; the first minute begins with the first call."""
        if self._stepped_us is None or t_us < self._stepped_us:
            self._stepped_us = t_us
        return t_us - self._stepped_us >= STEP_US

    def step(self, t_us: int, usages: Iterable[MovementUsage]) -> None:
        """Moves every full range by at most 1 % towards what fits; called between gestures."""
        self._stepped_us = t_us
        for usage in usages:
            name = usage.movement
            now = self._shares.get(name, 1.0)
            goal = now if usage.share is None else usage.share
            share = now + min(max(goal - now, -STEP), STEP)
            if share < 1.0:
                self._shares[name] = share
                self._bends[name] = self._bend(name, share)

    def undo(self) -> None:
        """Sets all ranges as calibrated again."""
        self._shares.clear()
        self._bends.clear()
        self._stepped_us = None

    def ease(self, reading: ConditionedGesture) -> None:
        """Raises the intensity of a reading to what it counts as now."""
        if not self._bends or reading.kind == GestureKind.NONE:
            return
        full_mm = DEFAULT_FULL_MM[reading.kind]
        begin_mm, end_mm = self._find_bend(reading, full_mm)
        if begin_mm < end_mm and reading.mm > begin_mm:
            gain = (full_mm - begin_mm) / (end_mm - begin_mm)
            reading.mm = begin_mm + gain * (reading.mm - begin_mm)

    def _find_bend(self, reading: ConditionedGesture, full_mm: float) -> _Bend:
        """Returns the movement's bend; for a diagonal push, that of both neighbours by angle."""
        none = (full_mm, full_mm)
        if reading.kind != GestureKind.PUSH:
            return self._bends.get(reading.kind.label, none)
        if reading.way is None:
            return none
        x, y = reading.way
        sideways = "push_right" if x >= 0.0 else "push_left"
        along = "push_down" if y >= 0.0 else "push_up"
        if sideways not in self._bends and along not in self._bends:
            return none
        share = math.atan2(abs(y), abs(x)) / (0.5 * math.pi)
        one, other = (self._bends.get(name) or self._bend(name, 1.0) for name in (sideways, along))
        return (
            one[0] + share * (other[0] - one[0]),
            one[1] + share * (other[1] - one[1]),
        )

    def _bend(self, movement: str, share: float) -> _Bend:
        full_mm = DEFAULT_FULL_MM[find_kind(movement)]
        own = getattr(self._ranges, movement) or MovementRange(rest=DEFAULT_REST_MM, full=full_mm)
        per_mm = (full_mm - DEFAULT_REST_MM) / (own.full - own.rest)
        begin_mm = DEFAULT_REST_MM + (NOISE_FACTOR - 1.0) * own.rest * per_mm
        end_mm = DEFAULT_REST_MM + (share * own.full - own.rest) * per_mm
        begin_mm = min(begin_mm, full_mm)
        return begin_mm, max(end_mm, begin_mm + (full_mm - begin_mm) / MOST_GAIN)

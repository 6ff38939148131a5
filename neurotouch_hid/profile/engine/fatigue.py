"""Watches for a hand that tires; suggests smaller ranges, or applies them."""

from dataclasses import replace

from neurotouch_hid.messages import GestureKind
from neurotouch_hid.profile.decision_log import DecisionLog
from neurotouch_hid.profile.engine.conditioned_gesture import ConditionedGesture
from neurotouch_hid.profile.engine.movement_usage import MovementUsage, UsageTracker
from neurotouch_hid.profile.engine.range_assist import RESTED_US, RangeAssist
from neurotouch_hid.profile.schema.user import UserSettings


class FatigueMonitor:
    """Watches the readings and, where the person wants it, eases them.

    Args:
        user: the ranges, and what is to be done.
        log: gets each suggestion and each step.
    """

    def __init__(self, user: UserSettings, log: DecisionLog) -> None:
        self._setting = user.fatigue
        self._log = log
        self._effort = UsageTracker(user.range)
        self._relief = RangeAssist(user.range)
        self._suggested: set[str] = set()
        self._used_us: int | None = None

    def usages(self) -> tuple[MovementUsage, ...]:
        """Returns the usage of each movement so far; without suggestions if none are wanted."""
        report = self._effort.report()
        if self._setting != "none":
            return report
        return tuple(replace(usage, share=None, full_mm=None) for usage in report)

    def shares(self) -> dict[str, float]:
        """Returns the share of its full range that each movement needs now, where below 1."""
        return self._relief.shares

    def rest(self) -> None:
        """Starts a pause of the person: all ranges are as calibrated again."""
        if self._relief.shares:
            self._log.note("fatigue", "full ranges as calibrated", "a pause")
        self._relief.undo()
        self._effort.rest()
        self._suggested.clear()

    def update(self, reading: ConditionedGesture) -> None:
        """Takes one reading, and eases it."""
        self._effort.update(reading)
        if reading.kind == GestureKind.NONE:
            self.pass_time(reading.t_us)
        elif self._setting != "none":
            self._used_us = reading.t_us
            self._relief.ease(reading)

    def pass_time(self, t_us: int) -> None:
        """Takes that there is still no gesture."""
        if self._setting == "none":
            return
        if self._used_us is not None and t_us - self._used_us >= RESTED_US:
            self._used_us = None
            self.rest()
        if self._relief.is_due(t_us):
            self._consider(t_us)

    def _consider(self, t_us: int) -> None:
        usages = self._effort.report()
        before = self._relief.shares
        self._relief.step(t_us, usages if self._setting == "auto" else ())
        for usage in usages:
            name = usage.movement
            words = name.replace("_", " ")
            share = self._relief.shares.get(name)
            if share != before.get(name) and share is not None:
                self._log.note("fatigue", f"{words} needs {share:.0%} of its range")
            if usage.full_mm is not None and name not in self._suggested:
                self._suggested.add(name)
                why = f"its median is {usage.peak_mm:g} mm now"
                what = f"{words} could be full at {usage.full_mm:g} mm"
                self._log.note("fatigue", what, why)

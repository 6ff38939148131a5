"""The stages a binding needs between its gesture and its output."""

from collections.abc import Callable
from typing import Final

from neurotouch_hid.profile.engine.conditioned_gesture import ConditionedGesture
from neurotouch_hid.profile.engine.press import (
    Debounce,
    Double,
    Hold,
    Press,
    Released,
    Say,
    Soft,
    Tap,
    Test,
    Threshold,
)
from neurotouch_hid.profile.engine.press_modes import Mode, make_mode
from neurotouch_hid.profile.engine.sequence_steps import SequenceSteps
from neurotouch_hid.profile.schema.conditions import Condition, PressName, Sequence
from neurotouch_hid.profile.schema.profile import Binding
from neurotouch_hid.profile.schema.targets import Acting, LayerTarget
from neurotouch_hid.profile.schema.timing import Times

WEAK_DROP: Final = 0.35
"""Share of the peak by which the intensity falls where a weak hand wants to release."""


class StageFactory:
    """Makes the stages of a binding runner, new at every reset."""

    def __init__(
        self,
        binding: Binding,
        times: Times,
        siblings: tuple[Binding, ...],
        say: Say,
        accept: Say,
    ) -> None:
        self._binding = binding
        self._condition = binding.condition
        self._times = times
        self._say = say
        self._accept = accept
        self._others = [
            other.condition
            for other in siblings
            if other is not binding and binding.condition.has_gesture_of(other.condition)
        ]
        self.make_mode = self._choose_mode()

    def make_threshold(self) -> Threshold:
        """Returns the stage that presses and releases by intensity."""
        on_mm, off_mm = self._binding.thresholds_mm
        release = self._condition.release
        if release is not None:
            most_us = float("inf") if release.max_hold_ms is None else 1000 * release.max_hold_ms
            return Threshold(on_mm, off_mm, release.drop, most_us)
        weak = self._times.weak_release and not self._binding.is_followed
        return Threshold(on_mm, off_mm, WEAK_DROP if weak else 0.0)

    def make_steps(self) -> SequenceSteps | None:
        """Returns the steps, if it is a sequence."""
        when = self._binding.when
        return SequenceSteps(when, self._say, self._accept) if isinstance(when, Sequence) else None

    def make_debounce(self) -> Debounce | None:
        """Returns the stage that accepts a press; None for an output that follows a measure."""
        if self._binding.is_followed:
            return None
        condition, times = self._condition, self._times
        if isinstance(self._binding.when, Sequence):
            return Debounce(0, 0, self._say)
        accept_ms = times.choose_ms("accept_ms", condition.accept_ms)
        ignore_ms = times.choose_ms("ignore_repeat_ms", condition.ignore_repeat_ms)
        if condition.press == "double":
            ignore_ms = 0  # the second tap is a repeat; it has a shortest pause of its own
        return Debounce(1000 * accept_ms, 1000 * ignore_ms, self._say)

    def make_presses(self) -> tuple[Press, ...]:
        """Returns level, then press."""
        if self._binding.is_followed or isinstance(self._binding.when, Sequence):
            return ()
        condition = self._condition
        presses: list[Press] = []
        hard = [other for other in self._others if other.level == "hard"]
        if condition.level == "soft" and hard:
            presses.append(Soft(min(other.thresholds_mm[0] for other in hard)))
        presses += self._make_press(condition.press)
        return tuple(presses)

    def _make_press(self, name: PressName | None) -> list[Press]:
        times, say = self._times, self._say
        tap_us, gap_us, double_us = (
            1000 * ms for ms in (times.tap_ms, times.gap_ms, times.double_ms)
        )
        match name:
            case "tap":
                wait_us = double_us if self._has_beside("double") else 0
                return [Tap((0, tap_us), wait_us, gap_us, say)]
            case "double":
                return [Double(tap_us, gap_us, double_us, say)]
            case "hold" if self._has_beside("long"):
                long_us = min(
                    1000 * times.choose_ms("long_ms", other.hold_ms)
                    for other in self._others
                    if other.press == "long"
                )
                hold_us = 1000 * times.choose_ms("hold_ms", self._condition.hold_ms)
                return [Tap((hold_us, long_us), 0, 0, say)]
            case "hold" | "long":
                hold_ms = times.choose_ms(f"{name}_ms", self._condition.hold_ms)
                return [Hold(1000 * hold_ms, say)]
        return (
            [Released(self._binding.thresholds_mm[1], self._fits, say)]
            if self._acts_on_release()
            else []
        )

    def _fits(self, reading: ConditionedGesture) -> bool:
        """Tells whether the gesture is still the one the binding waits for, however large."""
        condition = self._condition
        direction = make_direction_test(condition)
        return reading.kind in condition.kinds and (direction is None or direction(reading))

    def _has_beside(self, press: PressName) -> bool:
        return any(other.press == press for other in self._others)

    def _acts_on_release(self) -> bool:
        """Returns True if it acts when the gesture ends; what is repeated or held cannot."""
        target = self._binding.do
        if isinstance(target, Acting) and (target.repeat is not None or target.mode == "turbo"):
            return False
        if isinstance(target, LayerTarget) and target.mode == "hold":
            return False
        return self._times.choose_trigger(self._condition.trigger) == "release"

    def _choose_mode(self) -> Callable[[], Mode] | None:
        target = self._binding.do
        if not isinstance(target, Acting) or self._binding.is_followed:
            return None
        repeat_us = None
        if target.repeat is not None:
            repeat_us = (
                1000 * self._times.choose_ms("repeat_delay_ms", target.repeat.delay_ms),
                1000 * self._times.choose_ms("repeat_every_ms", target.repeat.every_ms),
            )
        turbo_us = (1000 * target.every_ms, round(1e6 * target.max_s))
        return make_mode(target.mode, repeat_us, turbo_us)


def make_direction_test(condition: Condition) -> Test | None:
    """Returns whether a push goes the way the condition wants; None if it wants none."""
    direction = condition.direction
    if direction is None:
        return None
    if (condition.sectors or (8 if "_" in direction else 4)) == 4:
        return lambda reading: reading.four == direction
    return lambda reading: reading.eight == direction


def make_tests(condition: Condition) -> tuple[Test, ...]:
    """Returns the tests of a condition beside kind, direction and intensity."""
    tests: list[Test] = []
    if (zone := condition.zone) is not None:
        tests.append(lambda reading: reading.zone == zone)
    if (contacts := condition.contacts) is not None:
        tests.append(lambda reading: reading.contacts == contacts)
    if (button := condition.with_button) is not None:
        tests.append(lambda reading: button in reading.helper)
    if (phase := condition.phase) is not None:
        tests.append(lambda reading: reading.phase == phase)
    if (speed := condition.min_speed_mm_s) is not None:
        tests.append(lambda reading: reading.top_speed_mm_s >= speed)
    return tuple(tests)

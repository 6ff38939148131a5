"""One binding at work: does its gesture hold, is it pressed, what does it put out."""

from collections.abc import Callable
from typing import Final

from neurotouch_hid.messages import GestureKind
from neurotouch_hid.profile.conditions import Condition, PressName, Sequence
from neurotouch_hid.profile.engine.modes import Mode, make_mode
from neurotouch_hid.profile.engine.output import make_output
from neurotouch_hid.profile.engine.press import (
    Double,
    Gate,
    Hold,
    Press,
    Released,
    Say,
    Soft,
    Tap,
    Test,
    Threshold,
)
from neurotouch_hid.profile.engine.reading import Reading
from neurotouch_hid.profile.engine.steps import Steps
from neurotouch_hid.profile.schema import Binding
from neurotouch_hid.profile.targets import Acting, LayerTarget
from neurotouch_hid.profile.timing import Times

WEAK_DROP: Final = 0.35
"""Share of the peak by which the intensity falls where a weak hand wants to let go."""


class Channel:
    """Carries out one binding.

    Attributes:
        binding: what it carries out.
        label: the same in words.
        kinds: the gestures it waits for.
        down: whether it acts now.
        busy: it must be asked even if another gesture, or none, is there.
        put: what it does to the outputs while it is down; None for a layer or a command.

    Args:
        binding: what to carry out.
        times: how long things take.
        siblings: all bindings of the layer; a double beside it delays a tap.
        say: is told why something was not accepted.
        label: the binding in words.
    """

    __slots__ = (
        "_direction",
        "_gate",
        "_mode",
        "_plan",
        "_presses",
        "_slew",
        "_steps",
        "_tests",
        "_threshold",
        "binding",
        "busy",
        "down",
        "kinds",
        "label",
        "put",
    )

    def __init__(
        self,
        binding: Binding,
        times: Times,
        siblings: tuple[Binding, ...],
        say: Say,
        label: str,
    ) -> None:
        self.binding = binding
        self.label = label
        self.kinds = frozenset(binding.condition.kinds)
        sequence = isinstance(binding.when, Sequence)
        if sequence:
            self.kinds = frozenset(kind for kind in GestureKind if kind != GestureKind.NONE)
        self.put, self._slew = make_output(binding)
        self._direction = None if sequence else _make_direction_test(binding.condition)
        self._tests = _make_tests(binding.condition)
        self._plan = _Plan(binding, times, siblings, say)
        self.reset()

    def reset(self) -> None:
        """Lets go and forgets."""
        self.down = self.busy = False
        plan = self._plan
        self._threshold = plan.make_threshold()
        self._steps = plan.make_steps()
        self._gate = plan.make_gate()
        self._presses = plan.make_presses()
        self._mode = plan.make_mode() if plan.make_mode is not None else None
        if self._slew is not None:
            self._slew.rest()

    def may_act(self, reading: Reading) -> bool:
        """True if the kind and direction of the gesture are right, whatever else is asked."""
        return reading.kind in self.kinds and (self._direction is None or self._direction(reading))

    def update(self, reading: Reading) -> None:
        """Takes one reading."""
        threshold = self._threshold
        held = False
        if self._steps is not None:
            held = self._steps.update(reading)
            busy = self._steps.busy
        else:
            if self.may_act(reading) and (
                not self._tests or all(test(reading) for test in self._tests)
            ):
                held = threshold.update(reading.mm, reading.t_us)
            elif threshold.held:
                threshold.reset()
            busy = held
        gate = self._gate
        if gate is not None:
            since_us = gate.since_us
            held = gate.update(held, reading.t_us)
            if since_us is None:
                since_us = gate.since_us
            if since_us is None:
                since_us = reading.t_us
            for press in self._presses:
                held = press.update(held, reading, since_us)
                busy = busy or press.busy
        if self._mode is not None:
            held = self._mode.update(held, reading.t_us)
            busy = busy or self._mode.busy
        if self._slew is not None and not held:
            self._slew.rest()
        self.down = held
        self.busy = busy or held

    def finish_action(self) -> None:
        """Another binding's action is done: what waited for it lets go."""
        if self._mode is not None:
            self._mode.finish_action()


class _Plan:
    """The stages of a channel, to be made anew at every reset."""

    def __init__(
        self, binding: Binding, times: Times, siblings: tuple[Binding, ...], say: Say
    ) -> None:
        self._binding = binding
        self._condition = binding.condition
        self._times = times
        self._say = say
        self._others = [
            other.condition
            for other in siblings
            if other is not binding and _same_place(other.condition, binding.condition)
        ]
        self.make_mode = self._plan_mode()

    def make_threshold(self) -> Threshold:
        on_mm, off_mm = self._binding.thresholds_mm
        release = self._condition.release
        if release is not None:
            most_us = float("inf") if release.max_hold_ms is None else 1000 * release.max_hold_ms
            return Threshold(on_mm, off_mm, release.drop, most_us)
        weak = self._times.weak_release and not self._binding.is_followed
        return Threshold(on_mm, off_mm, WEAK_DROP if weak else 0.0)

    def make_steps(self) -> Steps | None:
        when = self._binding.when
        return Steps(when, self._say) if isinstance(when, Sequence) else None

    def make_gate(self) -> Gate | None:
        if self._binding.is_followed:
            return None
        condition, times = self._condition, self._times
        if isinstance(self._binding.when, Sequence):
            return Gate(0, 0, self._say)
        accept_ms = _choose(condition.accept_ms, times.accept_ms)
        ignore_ms = _choose(condition.ignore_repeat_ms, times.ignore_repeat_ms)
        if condition.press == "double":
            ignore_ms = 0  # the second tap is a repeat; it has a shortest pause of its own
        return Gate(1000 * accept_ms, 1000 * ignore_ms, self._say)

    def make_presses(self) -> tuple[Press, ...]:
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
                    1000 * _choose(other.hold_ms, times.long_ms)
                    for other in self._others
                    if other.press == "long"
                )
                hold_us = 1000 * _choose(self._condition.hold_ms, times.hold_ms)
                return [Tap((hold_us, long_us), 0, 0, say)]
            case "hold" | "long":
                usual_ms = times.hold_ms if name == "hold" else times.long_ms
                return [Hold(1000 * _choose(self._condition.hold_ms, usual_ms), say)]
        return (
            [Released(self._binding.thresholds_mm[1], self._fits, say)]
            if self._acts_on_release()
            else []
        )

    def _fits(self, reading: Reading) -> bool:
        """True if the gesture is still the one the binding waits for, however far it goes."""
        condition = self._condition
        direction = _make_direction_test(condition)
        return reading.kind in condition.kinds and (direction is None or direction(reading))

    def _has_beside(self, press: PressName) -> bool:
        return any(other.press == press for other in self._others)

    def _acts_on_release(self) -> bool:
        """True if it acts when the gesture ends; what is repeated or held cannot."""
        target = self._binding.do
        if isinstance(target, Acting) and (target.repeat is not None or target.mode == "turbo"):
            return False
        if isinstance(target, LayerTarget) and target.mode == "hold":
            return False
        return (self._condition.trigger or self._times.trigger) == "release"

    def _plan_mode(self) -> Callable[[], Mode] | None:
        target = self._binding.do
        if not isinstance(target, Acting) or self._binding.is_followed:
            return None
        repeat_us = None
        if target.repeat is not None:
            repeat_us = (
                1000 * _choose(target.repeat.delay_ms, self._times.repeat_delay_ms),
                1000 * _choose(target.repeat.every_ms, self._times.repeat_every_ms),
            )
        turbo_us = (1000 * target.every_ms, round(1e6 * target.max_s))
        return make_mode(target.mode, repeat_us, turbo_us)


def _choose(own: int | None, usual: int) -> int:
    return usual if own is None else own


def _same_place(a: Condition, b: Condition) -> bool:
    """True if both act on the same gesture, apart from how it is pressed and how far."""
    keys = ("gesture", "direction", "zone", "contacts", "phase")
    return all(getattr(a, key) == getattr(b, key) for key in keys)


def _make_direction_test(condition: Condition) -> Test | None:
    direction = condition.direction
    if direction is None:
        return None
    if (condition.sectors or (8 if "_" in direction else 4)) == 4:
        return lambda reading: reading.four == direction
    return lambda reading: reading.eight == direction


def _make_tests(condition: Condition) -> tuple[Test, ...]:
    """What must be true beside kind, direction and intensity."""
    tests: list[Test] = []
    if (zone := condition.zone) is not None:
        tests.append(lambda reading: reading.zone == zone)
    if (contacts := condition.contacts) is not None:
        tests.append(lambda reading: reading.contacts == contacts)
    if (phase := condition.phase) is not None:
        tests.append(lambda reading: reading.phase == phase)
    if (speed := condition.min_speed_mm_s) is not None:
        tests.append(lambda reading: reading.top_speed_mm_s >= speed)
    return tuple(tests)

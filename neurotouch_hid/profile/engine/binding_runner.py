"""Runs one binding: checks its gesture, decides whether it is pressed, moves its output."""

from neurotouch_hid.messages import GestureKind
from neurotouch_hid.profile.engine.conditioned_gesture import ConditionedGesture
from neurotouch_hid.profile.engine.output import make_output
from neurotouch_hid.profile.engine.press import Say
from neurotouch_hid.profile.engine.stage_factory import (
    StageFactory,
    make_direction_test,
    make_tests,
)
from neurotouch_hid.profile.schema.conditions import Sequence
from neurotouch_hid.profile.schema.profile import Binding
from neurotouch_hid.profile.schema.timing import Times


class BindingRunner:
    """Carries out one binding.

    Attributes:
        binding: what it carries out.
        label: the same in words.
        kinds: the gestures it waits for.
        down: whether it acts now.
        busy: it must be asked even if another gesture, or none, is there.
        on_mm: its threshold; 0 without.
        put: what it does to the outputs while it is down; None for a layer or a command.

    Args:
        binding: what to carry out.
        times: how long things take.
        siblings: all bindings of the layer; a double beside it delays a tap.
        say: is told why something was not accepted.
        accept: is told of each step of a sequence.
        label: the binding in words.
    """

    __slots__ = (
        "_debounce",
        "_direction",
        "_factory",
        "_mode",
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
        "on_mm",
        "put",
    )

    def __init__(
        self,
        binding: Binding,
        times: Times,
        siblings: tuple[Binding, ...],
        say: Say,
        accept: Say,
        label: str,
    ) -> None:
        self.binding = binding
        self.label = label
        self.on_mm, _ = binding.thresholds_mm
        self.kinds = frozenset(binding.condition.kinds)
        sequence = isinstance(binding.when, Sequence)
        if sequence:
            self.kinds = frozenset(kind for kind in GestureKind if kind != GestureKind.NONE)
        self.put, self._slew = make_output(binding)
        self._direction = None if sequence else make_direction_test(binding.condition)
        self._tests = make_tests(binding.condition)
        self._factory = StageFactory(binding, times, siblings, say, accept)
        self.reset()

    def reset(self) -> None:
        """Releases and forgets."""
        self.down = self.busy = False
        factory = self._factory
        self._threshold = factory.make_threshold()
        self._steps = factory.make_steps()
        self._debounce = factory.make_debounce()
        self._presses = factory.make_presses()
        self._mode = factory.make_mode() if factory.make_mode is not None else None
        if self._slew is not None:
            self._slew.rest()

    def may_act(self, reading: ConditionedGesture) -> bool:
        """Tells whether the gesture's kind and direction are right, whatever else is required."""
        return reading.kind in self.kinds and (self._direction is None or self._direction(reading))

    def update(self, reading: ConditionedGesture) -> None:
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
            elif threshold.busy:
                threshold.reset()
            busy = threshold.busy
        debounce = self._debounce
        if debounce is not None:
            since_us = debounce.since_us
            held = debounce.update(held, reading.t_us)
            if since_us is None:
                since_us = debounce.since_us
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

    def takes_over(self, reading: ConditionedGesture) -> bool:
        """Tells whether a chord's button is down and the gesture is its own, however large."""
        condition = self.binding.condition
        return (
            condition.with_button in reading.helper
            and self.may_act(reading)
            and condition.zone in (None, reading.zone)
            and condition.contacts in (None, reading.contacts)
        )

    def withdraw(self, t_us: int) -> None:
        """Forgets the current gesture, which another binding has; toggled and sticky ones stay."""
        self._threshold.reset()
        if self._steps is not None:
            self._steps.update(ConditionedGesture(t_us))
        if self._debounce is not None:
            self._debounce.reset()
        self._presses = self._factory.make_presses()
        self.down = self._mode is not None and self._mode.update(False, t_us)
        self.busy = self.down
        if self._slew is not None:
            self._slew.rest()

    def finish_action(self) -> None:
        """Releases what waited for another binding's action to end."""
        if self._mode is not None:
            self._mode.finish_action()

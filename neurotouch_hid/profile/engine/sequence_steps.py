"""Gestures one after another."""

from collections import deque

from neurotouch_hid.messages import GestureKind
from neurotouch_hid.profile.engine.conditioned_gesture import ConditionedGesture
from neurotouch_hid.profile.engine.press import Say, Threshold
from neurotouch_hid.profile.schema.conditions import DEFAULT_ON_MM, OFF_SHARE, Condition, Sequence
from neurotouch_hid.profile.schema.profile import make_step
from neurotouch_hid.profile.schema.targets import EightWay

Done = tuple[int, GestureKind, EightWay | None]


class SequenceSteps:
    """Pressed while the last gesture of the sequence is there, if those before it were its others.

    What counts is the latest gestures, so a wrong one costs nothing but itself.

    Args:
        when: the gestures.
        say: is told why a complete sequence was not accepted.
        accept: is told of each step that was, but for the last, ``2 of 3``.
    """

    def __init__(self, when: Sequence, say: Say, accept: Say) -> None:
        self._steps = [make_step(name) for name in when.sequence]
        self._within_us = None if when.within_ms is None else 1000 * when.within_ms
        self._say = say
        self._accept = accept
        self._threshold = Threshold(DEFAULT_ON_MM, OFF_SHARE * DEFAULT_ON_MM)
        self._done: deque[Done] = deque(maxlen=len(self._steps))
        self._complete = False
        self.busy = False

    def update(self, reading: ConditionedGesture) -> bool:
        """Returns whether the sequence is complete and its last gesture still there."""
        before = self._threshold.held
        if reading.kind == GestureKind.NONE:
            self._threshold.reset()
        else:
            self._threshold.update(reading.mm, reading.t_us)
        held = self._threshold.held
        if held and not before:
            self._done.append((reading.t_us, reading.kind, reading.four))
            self._complete = self._is_complete()
            if self._complete:
                self._done.clear()
            elif (n := self._count()) > 0:
                self._accept(f"{n} of {len(self._steps)}")
        elif not held:
            self._complete = False
        self.busy = held
        return self._complete

    def _count(self) -> int:
        """Returns the number of its first gestures that have just been made."""
        done = list(self._done)
        for n in range(min(len(done), len(self._steps) - 1), 0, -1):
            if all(_fits(step, one) for step, one in zip(self._steps, done[-n:], strict=False)):
                return n
        return 0

    def _is_complete(self) -> bool:
        if len(self._done) < len(self._steps):
            return False
        if not all(_fits(step, done) for step, done in zip(self._steps, self._done, strict=True)):
            return False
        lasted_us = self._done[-1][0] - self._done[0][0]
        if self._within_us is not None and lasted_us > self._within_us:
            self._say(f"sequence took {lasted_us // 1000} ms > {self._within_us // 1000} ms")
            return False
        return True


def _fits(step: Condition, done: Done) -> bool:
    _, kind, direction = done
    return kind in step.kinds and step.direction in (None, direction)

"""Decides when a gesture presses: thresholds first, then tap, double or hold.

Every stage takes whether the stage before it is pressed and says whether it is itself; ``say`` is
told why something was not accepted.
"""

import math
from collections.abc import Callable
from typing import Final, Protocol

from neurotouch_hid.profile.engine.conditioned_gesture import ConditionedGesture

Say = Callable[[str], None]
Test = Callable[[ConditionedGesture], bool]

PULSE_US: Final = 50_000
"""How long something is down that only ever happens for a moment: three frames of a game."""

SETTLE_US: Final = 250_000
"""After this long even a gesture that still rises counts as soft."""

RISE: Final = 1.2
"""After a weak release, a rise of 20 % presses again."""


class Press(Protocol):
    """One stage.

    Attributes:
        busy: it must be asked again even if its gesture is over.
    """

    busy: bool

    def update(self, held: bool, reading: ConditionedGesture, since_us: int, /) -> bool:
        """Returns whether it is pressed; ``since_us`` is when the current press began."""
        ...


class Threshold:
    """Presses at ``on_mm`` and releases below ``off_mm``.

    With ``drop`` it also releases when the intensity has fallen by that share of its peak, and
    after ``most_us`` in any case.
    """

    __slots__ = (
        "_drop",
        "_level_mm",
        "_most_us",
        "_off_mm",
        "_on_mm",
        "_since_us",
        "_spent",
        "held",
    )

    def __init__(
        self, on_mm: float, off_mm: float, drop: float = 0.0, most_us: float = math.inf
    ) -> None:
        self._on_mm, self._off_mm = on_mm, off_mm
        self._drop, self._most_us = drop, most_us
        self.reset()

    def reset(self) -> None:
        """Releases the press."""
        self.held = False
        self._level_mm = 0.0  # the peak while held; after a weak release the lowest since
        self._since_us = 0
        self._spent = False

    @property
    def busy(self) -> bool:
        """True if it must be told when the gesture is over."""
        return self.held or self._spent or self._level_mm > 0.0

    def update(self, mm: float, t_us: int) -> bool:
        """Returns whether it is pressed."""
        if self.held:
            self._level_mm = max(self._level_mm, mm)
            self._spent = t_us - self._since_us >= self._most_us
            fallen = self._drop > 0.0 and mm <= (1.0 - self._drop) * self._level_mm
            if mm < self._off_mm or fallen or self._spent:
                self.held, self._level_mm = False, mm if fallen else 0.0
        else:
            self._level_mm = min(self._level_mm, mm)
            self._spent = self._spent and mm >= self._off_mm
            if mm >= max(self._on_mm, RISE * self._level_mm) and not self._spent:
                self.held, self._level_mm, self._since_us = True, mm, t_us
        return self.held


class Debounce:
    """Accepts a press once it has lasted, and not too soon after the one before."""

    __slots__ = ("_accept_us", "_blocked", "_free_us", "_ignore_us", "_open", "_say", "since_us")

    def __init__(self, accept_us: int, ignore_us: int, say: Say) -> None:
        self._accept_us, self._ignore_us = accept_us, ignore_us
        self._say = say
        self._free_us: int | None = None
        self.reset()

    def reset(self) -> None:
        """Releases; the time before the next press still counts."""
        self.since_us: int | None = None
        self._open = self._blocked = False

    def update(self, held: bool, t_us: int) -> bool:
        """Returns whether the press is accepted."""
        if not held:
            if self._open:
                self._free_us = t_us + self._ignore_us
            elif self.since_us is not None and not self._blocked:
                lasted_us = t_us - self.since_us
                self._say(f"lasted {lasted_us // 1000} ms < {self._accept_us // 1000} ms")
            self.reset()
            return False
        if self.since_us is None:
            self.since_us = t_us
            if self._free_us is not None and t_us < self._free_us:
                self._blocked = True
                after_us = t_us - self._free_us + self._ignore_us
                self._say(f"repeat {after_us // 1000} ms < {self._ignore_us // 1000} ms")
        if not self._open and not self._blocked and t_us - self.since_us >= self._accept_us:
            self._open = True
            self._free_us = t_us + self._ignore_us
        return self._open


class Soft:
    """Pressed once it is clear that the gesture stays below the hard level."""

    def __init__(self, hard_mm: float) -> None:
        self._hard_mm = hard_mm
        self.busy = False
        self._began = self._decided = self._spoiled = False
        self._until_us: int | None = None

    def update(self, held: bool, reading: ConditionedGesture, since_us: int) -> bool:
        """Returns whether it is pressed; a soft gesture that ends early gives a short press."""
        if not held:
            if self._began and not self._decided and not self._spoiled:
                self._until_us = reading.t_us + PULSE_US
            self._began = self._decided = self._spoiled = False
            self.busy = self._until_us is not None and reading.t_us < self._until_us
            return self.busy
        self._began = True
        self._until_us = None
        if reading.mm >= self._hard_mm:
            self._spoiled, self._decided = True, False
        settled = reading.phase != "attack" or reading.t_us - since_us >= SETTLE_US
        self._decided = not self._spoiled and (self._decided or settled)
        self.busy = True
        return self._decided


class Released:
    """A short press when the gesture ends; none if it has turned into another one before."""

    def __init__(self, off_mm: float, fits: Test, say: Say) -> None:
        self._off_mm, self._fits = off_mm, fits
        self._say = say
        self.busy = False
        self._began = False
        self._until_us: int | None = None

    def update(self, held: bool, reading: ConditionedGesture, _since_us: int) -> bool:
        """Returns whether the short press is on."""
        if held:
            self._began = True
            self._until_us = None
        elif self._began:
            self._began = False
            if reading.mm < self._off_mm or self._fits(reading):
                self._until_us = reading.t_us + PULSE_US
            else:
                self._say("turned into another gesture before it ended")
        pulse = self._until_us is not None and reading.t_us < self._until_us
        self.busy = self._began or pulse
        return pulse


class Tap:
    """A short press after a gesture of the right length, and after the wait for a second one.

    A second tap within that wait makes it a double tap; one that comes sooner than ``gap_us`` is a
    tremor and changes nothing.
    """

    def __init__(self, length_us: tuple[int, int], wait_us: int, gap_us: int, say: Say) -> None:
        self._least_us, self._most_us = length_us
        self._wait_us, self._gap_us = wait_us, gap_us
        self._say = say
        self.busy = False
        self._since_us: int | None = None
        self._begin_us: int | None = None  # of the short press
        self._counts = True

    def update(self, held: bool, reading: ConditionedGesture, since_us: int) -> bool:
        """Returns whether the short press is on."""
        t_us = reading.t_us
        if held:
            if self._since_us is None:
                self._since_us = since_us
                self._begin(since_us)
        elif self._since_us is not None:
            if self._counts:
                self._end(t_us, t_us - self._since_us)
            self._since_us = None
        begin_us = self._begin_us
        self.busy = held or (begin_us is not None and t_us < begin_us + PULSE_US)
        return begin_us is not None and begin_us <= t_us < begin_us + PULSE_US

    def _begin(self, t_us: int) -> None:
        waits = self._begin_us is not None and t_us < self._begin_us
        self._counts = not waits
        if waits and self._begin_us is not None:
            pause_us = t_us - (self._begin_us - self._wait_us)
            if pause_us >= self._gap_us:
                self._begin_us = None
                self._say("another tap follows")

    def _end(self, t_us: int, lasted_us: int) -> None:
        if lasted_us < self._least_us:
            self._say(f"lasted {lasted_us // 1000} ms < {self._least_us // 1000} ms")
        elif lasted_us > self._most_us:
            self._say(f"lasted {lasted_us // 1000} ms > {self._most_us // 1000} ms")
        else:
            self._begin_us = t_us + self._wait_us


class Double:
    """The second of two taps, as long as it is held."""

    def __init__(self, tap_us: int, gap_us: int, window_us: int, say: Say) -> None:
        self._tap_us, self._gap_us, self._window_us = tap_us, gap_us, window_us
        self._say = say
        self.busy = False
        self._since_us: int | None = None
        self._first_us: int | None = None  # when the first tap ended
        self._second = False

    def update(self, held: bool, reading: ConditionedGesture, since_us: int) -> bool:
        """Returns whether the second tap is on."""
        t_us = reading.t_us
        if held:
            if self._since_us is None:
                self._since_us = since_us
                self._begin(since_us)
        elif self._since_us is not None:
            tapped = not self._second and t_us - self._since_us <= self._tap_us
            self._first_us = t_us if tapped else None
            self._since_us, self._second = None, False
        waiting = self._first_us is not None and t_us - self._first_us <= self._window_us
        self.busy = held or waiting
        return self._second

    def _begin(self, t_us: int) -> None:
        if self._first_us is None:
            return
        pause_us = t_us - self._first_us
        if pause_us < self._gap_us:
            self._say(f"pause of {pause_us // 1000} ms < {self._gap_us // 1000} ms")
        elif pause_us <= self._window_us:
            self._second = True
        else:
            self._say(f"pause of {pause_us // 1000} ms > {self._window_us // 1000} ms")


class Hold:
    """Pressed once the gesture has been held for a while, until it ends."""

    def __init__(self, hold_us: int, say: Say) -> None:
        self._hold_us = hold_us
        self._say = say
        self.busy = False
        self._since_us: int | None = None
        self._pressed = False

    def update(self, held: bool, reading: ConditionedGesture, since_us: int) -> bool:
        """Returns whether it has been held long enough."""
        if held:
            if self._since_us is None:
                self._since_us = since_us
            self._pressed = reading.t_us - self._since_us >= self._hold_us
        elif self._since_us is not None:
            if not self._pressed:
                lasted_us = reading.t_us - self._since_us
                self._say(f"held {lasted_us // 1000} ms < {self._hold_us // 1000} ms")
            self._since_us, self._pressed = None, False
        self.busy = held
        return self._pressed

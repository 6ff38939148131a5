"""Modes of a press: held, toggled, kept for the next action, repeated."""

from collections.abc import Callable
from typing import Final, Protocol

PAUSE_US: Final = 20_000
"""How long something is released between two repeats: it must be seen in one slice at least."""


class Mode(Protocol):
    """The stage after a press.

    Attributes:
        busy: it is down although nothing is pressed.
    """

    busy: bool

    def update(self, pressed: bool, t_us: int, /) -> bool:
        """Returns whether the output is down."""
        ...

    def finish_action(self) -> None:
        """Notes that another action is done."""
        ...


class Toggle:
    """Down until pressed again."""

    def __init__(self) -> None:
        self.busy = False
        self._pressed = False

    def update(self, pressed: bool, _t_us: int) -> bool:
        """Returns whether it is down."""
        if pressed and not self._pressed:
            self.busy = not self.busy
        self._pressed = pressed
        return self.busy

    def finish_action(self) -> None:
        """Stays as it is."""


class Sticky:
    """Down until the next other action is done; twice in a row locks it, if it can be locked."""

    def __init__(self, *, locks: bool) -> None:
        self.busy = False
        self._locks = locks
        self._locked = False
        self._pressed = False

    def update(self, pressed: bool, _t_us: int) -> bool:
        """Returns whether it is down."""
        if pressed and not self._pressed:
            if not self.busy:
                self.busy = True
            elif self._locks and not self._locked:
                self._locked = True
            else:
                self.busy = self._locked = False
        self._pressed = pressed
        return self.busy

    def finish_action(self) -> None:
        """Releases, unless it is locked."""
        self.busy = self._locked


class AutoRepeat:
    """Down with short pauses: the first after ``delay_us``, then one every ``every_us``.

    After ``most_us`` it stays up.
    """

    def __init__(self, delay_us: int, every_us: int, pause_us: int, most_us: int | None) -> None:
        self.busy = False
        self._delay_us, self._every_us, self._pause_us = delay_us, every_us, pause_us
        self._most_us = most_us
        self._since_us: int | None = None

    def update(self, pressed: bool, t_us: int) -> bool:
        """Returns whether it is down."""
        if not pressed:
            self._since_us = None
            return False
        if self._since_us is None:
            self._since_us = t_us
        passed_us = t_us - self._since_us
        if self._most_us is not None and passed_us >= self._most_us:
            return False
        if passed_us < self._delay_us:
            return passed_us < self._delay_us - self._pause_us
        return (passed_us - self._delay_us) % self._every_us < self._every_us - self._pause_us

    def finish_action(self) -> None:
        """Goes on."""


def make_mode(
    name: str,
    repeat_us: tuple[int, int] | None,
    turbo_us: tuple[int, int],
) -> Callable[[], Mode] | None:
    """Returns a maker of modes for a binding; None where the output simply follows the press.

    Args:
        name: the mode's name in the profile.
        repeat_us: delay and period of a repeat, if there is one.
        turbo_us: period and longest time of turbo.
    """
    if repeat_us is not None:
        delay_us, every_us = repeat_us
        return lambda: AutoRepeat(max(delay_us, 2 * PAUSE_US), every_us, PAUSE_US, None)
    match name:
        case "toggle":
            return Toggle
        case "sticky" | "oneshot":
            return lambda: Sticky(locks=name == "sticky")
        case "turbo":
            every_us, most_us = turbo_us
            return lambda: AutoRepeat(every_us, every_us, every_us // 2, most_us)
    return None

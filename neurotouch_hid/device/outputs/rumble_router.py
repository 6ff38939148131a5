"""Passes the rumble of games to its listeners: a physical pad, viewers."""

import time
from collections import deque
from collections.abc import Callable
from typing import Final

from neurotouch_hid.device.outputs.effects import STILL, Rumble
from neurotouch_hid.device.outputs.rumble import HearRumble
from neurotouch_hid.status import RumbleState

_SHOWN_S: Final = 0.6
"""A viewer reads twice a second, and must not miss a short knock."""


class RumbleRouter:
    """Calls all listeners with each change, and keeps the latest for viewers that poll.

    Args:
        listeners: called with every change, in the server's thread; must return at once.
        now: seconds on any clock.
    """

    def __init__(self, *listeners: HearRumble, now: Callable[[], float] = time.monotonic) -> None:
        self._listeners = listeners
        self._now = now
        self._latest = deque([(now(), STILL)], maxlen=64)  # when each began

    def hear(self, rumble: Rumble) -> None:
        """Passes a change to all listeners."""
        self._latest.append((self._now(), rumble))
        for listener in self._listeners:
            listener(rumble)

    def describe(self) -> RumbleState:
        """Returns the strongest recent rumble, ready for JSON."""
        since = self._now() - _SHOWN_S
        latest = list(self._latest)
        ends = [begin for begin, _ in latest[1:]] + [self._now()]
        shown = [each for (_, each), end in zip(latest, ends, strict=True) if end >= since]
        return {
            "strong": round(max(each.strong for each in shown), 3),
            "weak": round(max(each.weak for each in shown), 3),
        }

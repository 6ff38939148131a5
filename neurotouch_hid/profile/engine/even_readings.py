"""Makes evenly spaced readings of gestures, which come faster while the hand moves."""

from typing import Final

READING_US: Final = 10_000
"""Readings are this far apart, as the spectrum of a tremor needs."""

_MOST_US: Final = 500_000
"""One gesture stands for the time until the next, up to this; after longer, some were lost."""


class ReadingClock:
    """Counts the readings that become due."""

    def __init__(self) -> None:
        self._since_us = 0

    def count(self, step_us: int) -> int | None:
        """Returns how many readings have become due; None if gestures were lost.

        Args:
            step_us: the time since the gesture before; negative if the clock was set back.
        """
        if not 0 <= step_us <= _MOST_US:
            self._since_us = 0
            return None
        n, self._since_us = divmod(self._since_us + step_us, READING_US)
        return n

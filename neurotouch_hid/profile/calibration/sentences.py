"""Writes what a person is told during a measurement: how far, how often, how long, what next.

The terminal and the page say the same, so no sentence names a key or a button.
"""

from typing import Final

from neurotouch_hid.profile.calibration.result import LEAST_PEAKS

_GO_ON: Final = "enough. Go on to the next one"
_BEGUN_S: Final = 0.3
ENOUGH_S: Final = 4.0
"""A hold this long shows whether the hand trembles: 3 s between its beginning and its end."""

_MILESTONES: Final = (
    (_BEGUN_S, "Keep it there."),
    (ENOUGH_S, f"{ENOUGH_S:g} seconds, {_GO_ON}, or keep it longer."),
    (10.0, f"10 seconds, {_GO_ON}."),
)


def describe_peak(peak_mm: float, made: int) -> str:
    """Returns for example ``8.4 millimetres, good, 1 of 2``.

    Args:
        peak_mm: how far it went.
        made: how often this movement has been made now.
    """
    words = f"{peak_mm:.1f} millimetres, good"
    if made < LEAST_PEAKS:
        return f"{words}, {made} of {LEAST_PEAKS}"
    return f"{words}, {made} made: {_GO_ON}."


class HoldTeller:
    """Says how long a movement is held: while it lasts, and when it is over."""

    def __init__(self) -> None:
        self._held_s = 0.0

    def take(self, held_s: float) -> str | None:
        """Returns what is to be said now, if anything.

        Args:
            held_s: for how long it has been held, 0 while nothing is.
        """
        before, self._held_s = self._held_s, held_s
        if held_s < before:
            return self._conclude(before)
        passed = [words for limit_s, words in _MILESTONES if before < limit_s <= held_s]
        return passed[-1] if passed else None

    def _conclude(self, held_s: float) -> str | None:
        if held_s < _BEGUN_S:
            return None
        words = f"Kept for {held_s:.1f} seconds"
        if held_s < ENOUGH_S:
            return f"{words}. Keep it for {ENOUGH_S:g} or longer."
        return f"{words}, {_GO_ON}, or keep it again."

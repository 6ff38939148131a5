"""Log of the mapping's decisions, for the live view, ``profile test`` and bug reports."""

from collections import deque
from dataclasses import dataclass
from typing import Final, Literal

Verdict = Literal["pressed", "ignored", "missed", "step", "layer", "command", "fatigue"]

REFUSALS: Final = ("ignored", "missed")

KEPT: Final = 20


@dataclass(frozen=True, slots=True)
class MappingDecision:
    """One decision.

    Attributes:
        t_us: when.
        verdict: what was decided. A gesture is ``ignored`` if a rule kept it from acting, and
            ``missed`` if it stayed just below its threshold.
        what: the binding in words, ``push left tap -> button a``, a layer or a command.
        why: what kept it from acting, ``repeat 140 ms < 200 ms``; of a step towards it, which one,
            ``2 of 3``; empty otherwise.
    """

    t_us: int
    verdict: Verdict
    what: str
    why: str = ""

    @property
    def is_refusal(self) -> bool:
        """True if the gesture had no effect."""
        return self.verdict in REFUSALS

    def __str__(self) -> str:
        return describe_decision(self.verdict, self.what, self.why)


def describe_decision(verdict: str, what: str, why: str) -> str:
    """Returns for example ``ignored: pinch -> button a, because repeat 140 ms < 200 ms``."""
    if not why:
        return f"{verdict}: {what}"
    return f"{verdict}: {what}" + (f", because {why}" if verdict in REFUSALS else f" ({why})")


class DecisionLog:
    """The latest decisions."""

    def __init__(self) -> None:
        self._kept: deque[MappingDecision] = deque(maxlen=KEPT)
        self.t_us = 0

    def note(self, verdict: Verdict, what: str, why: str = "") -> None:
        """Adds a decision of this moment."""
        self._kept.append(MappingDecision(self.t_us, verdict, what, why))

    def read(self) -> tuple[MappingDecision, ...]:
        """Returns the latest decisions, oldest first."""
        return tuple(self._kept)

"""What the mapping decided, for viewers: the live view, ``profile test``, bug reports."""

from collections import deque
from dataclasses import dataclass
from typing import Final, Literal

Verdict = Literal["pressed", "ignored", "step", "layer", "command", "fatigue"]

KEPT: Final = 20


@dataclass(frozen=True, slots=True)
class MappingDecision:
    """One decision.

    Attributes:
        t_us: when.
        verdict: what was decided.
        what: the binding in words, ``push left tap -> button a``, a layer or a command.
        why: what kept it from acting, ``repeat 140 ms < 200 ms``; of a step towards it, which one,
            ``2 of 3``; empty otherwise.
    """

    t_us: int
    verdict: Verdict
    what: str
    why: str = ""

    def __str__(self) -> str:
        return f"{self.verdict}: {self.what}{f' ({self.why})' if self.why else ''}"


class Journal:
    """The latest decisions."""

    def __init__(self) -> None:
        self._kept: deque[MappingDecision] = deque(maxlen=KEPT)
        self.t_us = 0

    def note(self, verdict: Verdict, what: str, why: str = "") -> None:
        """Adds a decision of this moment."""
        self._kept.append(MappingDecision(self.t_us, verdict, what, why))

    def read(self) -> tuple[MappingDecision, ...]:
        """The latest decisions, oldest first."""
        return tuple(self._kept)

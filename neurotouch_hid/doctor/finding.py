"""The finding of a check: a status, a sentence, and the fix."""

from dataclasses import asdict, dataclass
from enum import StrEnum
from typing import Any


class CheckStatus(StrEnum):
    """Outcome of one check. Only FAILED makes the doctor's exit code 1."""

    OK = "OK"
    WARNING = "WARNING"
    FAILED = "FAILED"
    SKIPPED = "SKIPPED"


@dataclass(frozen=True, slots=True)
class Finding:
    """The result of a check.

    Attributes:
        status: the severity.
        sentence: the finding in words.
        fix: the fix, for people.
        commands: the fix as shell commands, as an ordinary user types them.
        check: the name of the check; empty until the examination fills it in.
    """

    status: CheckStatus
    sentence: str
    fix: str | None = None
    commands: tuple[str, ...] = ()
    check: str = ""

    def as_json(self) -> dict[str, Any]:
        """Returns the same as plain values, the name of the check first."""
        return {"check": self.check} | asdict(self)


def approve(sentence: str) -> Finding:
    """Returns the finding that all is in order."""
    return Finding(CheckStatus.OK, sentence)


def warn(sentence: str, fix: str, *commands: str) -> Finding:
    """Returns the finding that something works, but not as it should."""
    return Finding(CheckStatus.WARNING, sentence, fix, commands)


def fail(sentence: str, fix: str, *commands: str) -> Finding:
    """Returns the finding that something does not work."""
    return Finding(CheckStatus.FAILED, sentence, fix, commands)


def skip(sentence: str) -> Finding:
    """Returns the finding that something could not be, or need not be, checked."""
    return Finding(CheckStatus.SKIPPED, sentence)

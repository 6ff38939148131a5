"""What a check finds: a status, a sentence, and the way out."""

from dataclasses import asdict, dataclass
from enum import StrEnum
from typing import Any


class Status(StrEnum):
    """Outcome of one check. Only FAILED makes the doctor's exit code 1."""

    OK = "OK"
    WARNING = "WARNING"
    FAILED = "FAILED"
    SKIPPED = "SKIPPED"


@dataclass(frozen=True, slots=True)
class Verdict:
    """What a check says.

    Attributes:
        status: how bad it is.
        sentence: what was found.
        fix: how to mend it, for people.
        commands: the same for a shell, as an ordinary user who types them would.
    """

    status: Status
    sentence: str
    fix: str | None = None
    commands: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Finding:
    """A verdict with the name of its check."""

    check: str
    status: Status
    sentence: str
    fix: str | None = None
    commands: tuple[str, ...] = ()

    def as_json(self) -> dict[str, Any]:
        """The same for programs."""
        return asdict(self)


def approve(sentence: str) -> Verdict:
    """All is well."""
    return Verdict(Status.OK, sentence)


def warn(sentence: str, fix: str, *commands: str) -> Verdict:
    """It works, but not as it should."""
    return Verdict(Status.WARNING, sentence, fix, commands)


def fail(sentence: str, fix: str, *commands: str) -> Verdict:
    """It does not work."""
    return Verdict(Status.FAILED, sentence, fix, commands)


def skip(sentence: str) -> Verdict:
    """It could not be, or need not be, checked."""
    return Verdict(Status.SKIPPED, sentence)

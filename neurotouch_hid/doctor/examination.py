"""Runs checks one after another, each with a time limit."""

import threading
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Final

from neurotouch_hid.doctor.finding import CheckStatus, Finding, fail
from neurotouch_hid.errors import NeuroTouchError

PATIENCE_S: Final = 10.0
TELL_S: Final = 1.0
TELL_AGAIN_S: Final = 10.0

_AGAIN: Final = "Install it again: pip install --force-reinstall neurotouch-hid"


@dataclass(frozen=True, slots=True)
class Check:
    """One check.

    Attributes:
        name: its name in the report.
        look: runs the check and returns its finding.
        patience_s: its time limit.
    """

    name: str
    look: Callable[[], Finding]
    patience_s: float = PATIENCE_S


def examine(
    checks: Iterable[Check],
    *,
    tell: Callable[[str], object] = str,  # says nothing
) -> Iterator[Finding]:
    """Runs the checks in order; yields each finding as soon as it is known.

    Args:
        checks: the checks.
        tell: called with a sentence about a slow check, and again every ten seconds.
    """
    for check in checks:
        yield replace(_look(check, tell), check=check.name)


def _look(check: Check, tell: Callable[[str], object]) -> Finding:
    """Returns the finding of a check; a check that takes too long is abandoned."""
    findings: list[Finding] = []

    def work() -> None:
        try:
            findings.append(check.look())
        except NeuroTouchError as error:
            findings.append(Finding(CheckStatus.FAILED, error.message, error.hint))
        except ImportError as error:
            findings.append(fail(f"A part of the program cannot be loaded: {error}.", _AGAIN))
        except OSError as error:
            what = f"{error.filename}: " if error.filename else ""
            reason = error.strerror or str(error)
            findings.append(fail(f"It could not be examined: {what}{reason}.", "Report this."))

    thread = threading.Thread(target=work, name=f"check {check.name}", daemon=True)
    thread.start()
    begun_s = time.monotonic()
    thread.join(min(TELL_S, check.patience_s))
    while thread.is_alive() and (passed_s := time.monotonic() - begun_s) < check.patience_s:
        tell(
            f"Checking: {check.name}. {passed_s:.0f} s of at most {check.patience_s:.0f} s; the "
            "first time on a machine it compiles."
        )
        thread.join(min(TELL_AGAIN_S, check.patience_s - passed_s))
    if thread.is_alive():
        return fail(
            f"There was no answer within {check.patience_s:.0f} s.",
            "A driver or a library hangs. Try again; if it happens again, report this.",
        )
    return findings[0] if findings else fail("The check itself failed.", "Report this as a bug.")

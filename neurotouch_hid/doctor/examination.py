"""Runs checks one after another, each within its time."""

import threading
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Final

from neurotouch_hid.doctor.finding import Finding, Status, Verdict, fail
from neurotouch_hid.errors import NeuroTouchError

PATIENCE_S: Final = 10.0

_AGAIN: Final = "Install it again: pip install --force-reinstall neurotouch-hid"


@dataclass(frozen=True, slots=True)
class Check:
    """One thing to look at.

    Attributes:
        name: what it is called in the report.
        look: looks, and says what it found.
        patience_s: how long it may take.
    """

    name: str
    look: Callable[[], Verdict]
    patience_s: float = PATIENCE_S


def examine(checks: Iterable[Check], *, patience: float = 1.0) -> Iterator[Finding]:
    """Runs the checks in order; yields each finding as soon as it is known.

    Args:
        checks: what to look at.
        patience: factor on all times, for slow machines.
    """
    for check in checks:
        verdict = _look(check, check.patience_s * patience)
        yield Finding(check.name, verdict.status, verdict.sentence, verdict.fix, verdict.commands)


def _look(check: Check, patience_s: float) -> Verdict:
    """The verdict of a check, which is left alone if it does not come back in time."""
    verdicts: list[Verdict] = []

    def work() -> None:
        try:
            verdicts.append(check.look())
        except NeuroTouchError as error:
            verdicts.append(Verdict(Status.FAILED, error.message, error.hint))
        except ImportError as error:
            verdicts.append(fail(f"A part of the program cannot be loaded: {error}.", _AGAIN))
        except OSError as error:
            what = f"{error.filename}: " if error.filename else ""
            reason = error.strerror or str(error)
            verdicts.append(fail(f"It could not be looked at: {what}{reason}.", "Report this."))

    thread = threading.Thread(target=work, name=f"check {check.name}", daemon=True)
    thread.start()
    thread.join(patience_s)
    if thread.is_alive():
        return fail(
            f"There was no answer within {patience_s:.0f} s.",
            "Something hangs below this program. Try again; if it stays, report this.",
        )
    return verdicts[0] if verdicts else fail("The check itself broke.", "Report this as a bug.")

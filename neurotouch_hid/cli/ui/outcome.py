"""Outcome of a command that changes something, as text for people or JSON for programs."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import click

from neurotouch_hid.cli.ui.output import echo, print_json, say, show_changes

if TYPE_CHECKING:
    from neurotouch_hid.files.faults import Mark
    from neurotouch_hid.profile import Checked


@dataclass(frozen=True, slots=True)
class Outcome:
    """Outcome of a command; every command that changes something prints the same keys as JSON.

    Attributes:
        message: the outcome in a sentence.
        status: ``OK``, or ``FAILED`` if the change was refused.
        file: the changed file, if any.
        changed: True if anything has changed.
        lines: the changed lines, from ``compare``.
        checked: the file as it is now, or as it was refused, with its faults.
        notes: further notes, a sentence each.
        fix: the fix after a failure.
    """

    message: str
    status: Literal["OK", "WARNING", "FAILED"] = "OK"
    file: Path | None = None
    changed: bool = False
    lines: Sequence[tuple[str, int, str]] = ()
    checked: "Checked[Any] | None" = None
    notes: tuple[str, ...] = ()
    fix: str = ""

    def tell(self, *, plain: bool, as_json: bool) -> None:
        """Prints it; warnings come last, because there may be many."""
        if as_json:
            print_json(self.report())
            return
        show_changes(self.lines, plain=plain)
        say(self.status, self.message, self.fix, plain=plain)
        for note in self.notes:
            echo(note)
        if self.checked is not None:
            show_faults(self.checked, plain=plain)

    def report(self) -> dict[str, Any]:
        """Returns the same as plain values."""
        return {
            "status": self.status,
            "message": self.message,
            "file": None if self.file is None else str(self.file),
            "changed": self.changed,
            "lines": report_lines(self.lines),
            "faults": [] if self.checked is None else report_faults(self.checked),
            "notes": list(self.notes),
            "fix": self.fix or None,
        }


def report_lines(lines: Sequence[tuple[str, int, str]]) -> list[dict[str, Any]]:
    """Returns the changed lines as plain values."""
    return [{"verb": verb, "line": number, "text": text} for verb, number, text in lines]


def report_faults(checked: "Checked[Any]") -> list[dict[str, Any]]:
    """Returns the faults of a text as plain values."""
    lines = checked.text.splitlines()
    return [
        {
            "file": checked.name,
            "line": fault.mark.line + 1,
            "col": fault.mark.column + 1,
            "end": _find_end(fault.mark, lines),
            "code": fault.code,
            "severity": fault.severity,
            "path": fault.path,
            "message": fault.sentence,
            "fix": fault.hint or None,
        }
        for fault in checked.faults
    ]


def _find_end(mark: "Mark", lines: list[str]) -> int:
    """Returns the column after the last one, from 1; a mark may reach to the line's end."""
    length = len(lines[mark.line]) if mark.line < len(lines) else 0
    return 1 + max(mark.column + 1, min(mark.column + mark.length, length))


def show_faults(checked: "Checked[Any]", *, plain: bool) -> None:
    """Prints the faults of a text, one a line in plain output."""
    if not plain:
        if checked.faults:
            echo(checked.format())
        return
    for fault in checked.faults:
        status = "WARNING" if fault.severity == "warning" else "FAILED"
        place = f"{checked.name}:{fault.mark.line + 1}:{fault.mark.column + 1}"
        path = f"{fault.path}: " if fault.path else ""
        say(status, f"{place}: {path}{fault.sentence} [{fault.code}]", fault.hint)


def confirm(question: str, *, yes: bool, as_json: bool) -> bool:
    """Returns True if the person agrees, now or with ``--yes``; never asks a script."""
    if yes or as_json:
        return yes
    return click.confirm(question, default=False)

"""Output of commands: plain lines for screen readers and pipes, some colour on a terminal."""

import json
import os
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.partial_file import try_writing, write_whole
from neurotouch_hid.printable import is_printable, make_lines_printable, make_printable
from neurotouch_hid.process.dead_output import silence

if TYPE_CHECKING:
    from neurotouch_hid.doctor.finding import Finding

Command = TypeVar("Command", bound=Callable[..., Any])

_COLOURS = {"OK": "green", "WARNING": "yellow", "FAILED": "red"}


def echo(text: str, *, err: bool = False, nl: bool = True) -> None:
    """Prints lines of text. All commands print with it, whatever the text quotes.

    File names, profiles, devices and answers may hold characters that steer a terminal. None of
    them gets there. What nobody can read on the standard error does not end the work.
    """
    try:
        click.echo(make_lines_printable(text), err=err, nl=nl)
    except OSError:
        if not err:
            raise
        silence(sys.stderr)


def echo_file(text: str) -> None:
    """Prints the text of a file: as it is into a file or pipe, on a terminal as ``echo`` does."""
    if sys.stdout.isatty():
        echo(text, nl=False)
    else:
        click.echo(text, nl=False)


def plain_option(command: Command) -> Command:
    """Adds ``--plain``, which gives the command its ``plain`` argument."""
    return click.option(
        "--plain",
        is_flag=True,
        callback=lambda _ctx, _param, value: is_plain(asked=value),
        help="One fact per line, the status first: for screen readers. Automatic when not on a "
        "terminal or with NT_ACCESSIBLE=1.",
    )(command)


json_option = click.option("--json", "as_json", is_flag=True, help="Print it as JSON.")
"""Gives a command its ``as_json`` argument. With it a failure is JSON too, see ``LazyGroup``."""


def is_plain(*, asked: bool = False) -> bool:
    """Returns True if output is one fact per line."""
    return (
        asked
        or os.environ.get("NT_ACCESSIBLE", "0") not in ("", "0")
        or os.environ.get("TERM") == "dumb"
        or not sys.stdout.isatty()
    )


def paint(text: str, colour: str, *, plain: bool) -> str:
    """Returns the text in colour if the terminal supports it and ``NO_COLOR`` is not set."""
    if plain or os.environ.get("NO_COLOR"):
        return text
    return click.style(text, fg=colour)


def say(status: str, sentence: str, fix: str = "", *, plain: bool = True) -> None:
    """Prints a line that begins with its status, and the next step below."""
    click.echo(f"{paint(status, _COLOURS.get(status, 'cyan'), plain=plain)} ", nl=False)
    echo(sentence)
    if fix:
        echo(f"Fix: {fix}")


def show_finding(finding: "Finding", *, plain: bool) -> None:
    """Prints a finding of the doctor: its status, its sentence, its fix."""
    status = paint(f"{finding.status:<8}", _COLOURS.get(finding.status, "cyan"), plain=plain)
    click.echo(f"{status} ", nl=False)
    echo(f"{finding.check}: {finding.sentence}")
    if finding.fix:
        echo(f"         Fix: {finding.fix}")
    for line in finding.commands:
        echo(f"           {line}")


def show_changes(lines: Sequence[tuple[str, int, str]], *, plain: bool) -> None:
    """Prints the changed lines that ``compare`` has found."""
    for verb, number, text in lines:
        if plain:
            echo(f"line {number} {verb}: {text.strip() or 'an empty line'}")
        else:
            sign, colour = ("-", "red") if verb == "removed" else ("+", "green")
            click.echo(paint(f"{number:>5} {sign} {make_printable(text)}", colour, plain=plain))


def print_json(value: Any) -> None:
    """Prints the value as JSON."""
    text = json.dumps(value, indent=2, ensure_ascii=False, default=str)
    lines = ("".join(map(_escape, line)) for line in text.split("\n"))
    click.echo("\n".join(lines))


def _escape(char: str) -> str:
    """Returns a character as JSON may write it, and a terminal may show it."""
    return char if is_printable(char) else json.dumps(char)[1:-1]


def save_json(path: Path, value: Any) -> None:
    """Writes the value as JSON to a file that a person has named.

    Raises:
        NeuroTouchError: it cannot be written.
    """
    save_text(path, json.dumps(value, indent=2) + "\n")


def save_text(path: Path, text: str) -> None:
    """Writes a text to a file that a person has named.

    Raises:
        NeuroTouchError: it cannot be written.
    """
    try:
        write_whole(path, text.encode())
    except OSError as error:
        raise NeuroTouchError.of_writing(path, error) from error


def require_writable(path: Path) -> None:
    """Checks before the work that a file can be written.

    Raises:
        NeuroTouchError: it cannot be written.
    """
    try:
        try_writing(path)
    except OSError as error:
        raise NeuroTouchError.of_writing(path, error) from error


def make_stamp() -> str:
    """Returns the present time, for the name of a version."""
    return time.strftime("%Y-%m-%d_%H-%M-%S")


def make_calibration_stamp() -> str:
    """Returns the same for a version that a calibration replaces, so that 'undo' can find it."""
    return f"{make_stamp()}_calibration"


def choose(question: str, choices: Sequence[str], *, default: int | None = None) -> int:
    """Asks for one of several by number, without a time limit; returns its index.

    Raises:
        click.Abort: the input has ended.
    """
    echo(question)
    for number, choice in enumerate(choices, 1):
        echo(f"  {number}. {choice}")
    shown = None if default is None else str(default + 1)  # goes through `read` like an answer

    def read(answer: str) -> int:
        if answer.strip() in map(str, range(1, len(choices) + 1)):
            return int(answer)
        raise click.UsageError(f"Type a number from 1 to {len(choices)}.")

    return int(click.prompt("Number", value_proc=read, default=shown)) - 1

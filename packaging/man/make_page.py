"""Writes neurotouch(1) from the command line's own help: ``make_page.py > neurotouch.1``."""

import inspect
import re

import click

from neurotouch_hid import __version__
from neurotouch_hid.cli.main import cli

TITLE = "soft gel seen by an event camera, as a standard game controller"
INTRODUCTION = """\
A silicone dome with 177 white dots sits on a DAVIS-346 event camera. This driver follows the dots,
recognises what the fingers do (push, pinch, zoom, twist), and moves a gamepad that every program
knows. Where the package is installed, a service does this as soon as the camera is plugged in, see
.BR neurotouch-service (7).
"""
FILES = """\
.TP
.I ~/.config/neurotouch/user.yaml
Your own values: ranges, tremor filter, patience, favourites.
.TP
.I ~/.config/neurotouch/driver.yaml
Profiles of applications, keys that stop everything.
.TP
.I ~/.config/neurotouch/profiles/
Your own profiles.
"""


def main() -> None:
    """Prints the page."""
    print(f'.TH NEUROTOUCH 1 "" "neurotouch_hid {__version__}" "User Commands"')
    print(
        ".SH NAME\nneurotouch \\- soft gel seen by an event camera, as a standard game controller"
    )
    print(".SH SYNOPSIS\n.B neurotouch\n.I COMMAND\n[\\fIOPTION\\fR]... [\\fIARGUMENT\\fR]...")
    print(f".SH DESCRIPTION\n{INTRODUCTION}.SH COMMANDS")
    context = click.Context(cli, info_name="neurotouch")
    for name in cli.list_commands(context):
        print_command(cli.get_command(context, name), context, name)
    print(f".SH EXIT STATUS\n{escape(find_exit_codes())}")
    print(f".SH FILES\n{FILES}.SH SEE ALSO\n.BR neurotouch-service (7)")


def print_command(command: click.Command | None, parent: click.Context, name: str) -> None:
    """Prints a command, its options, and the commands within it."""
    if command is None or command.hidden:
        return
    context = click.Context(command, info_name=name, parent=parent)
    usage = " ".join(command.collect_usage_pieces(context))
    print(f".SS {escape(context.command_path)} {escape(usage)}")
    text = inspect.cleandoc(command.help or "").replace("\b\n", "")
    print(escape(re.sub(r"\n\n+", "\n.PP\n", text)))
    for parameter in command.get_params(context):
        if record := parameter.get_help_record(context):
            print(f".TP\n.B {escape(record[0])}\n{escape(record[1])}")
    if isinstance(command, click.Group):
        for each in command.list_commands(context):
            print_command(command.get_command(context, each), context, each)


def find_exit_codes() -> str:
    """The sentence about exit codes in the help of the whole."""
    text = inspect.cleandoc(cli.help or "")
    return text[text.index("Exit codes: ") + len("Exit codes: ") :]


def escape(text: str) -> str:
    """The text as roff prints it: hyphens that can be copied, nothing taken for a request."""
    text = text.replace("\\", r"\e").replace("-", r"\-")
    lines = (rf"\&{line}" if line[:1] in ("'", ".") else line for line in text.splitlines())
    return re.sub(r"^\\&\.PP$", ".PP", "\n".join(lines), flags=re.MULTILINE)


main()

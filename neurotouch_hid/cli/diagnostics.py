"""``neurotouch diagnostics``: writes a report for a bug thread."""

import json
from pathlib import Path

import click

from neurotouch_hid.cli.ui.options import OutFile
from neurotouch_hid.cli.ui.output import echo, json_option, save_text
from neurotouch_hid.errors import NeuroTouchError


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch diagnostics                        read it, then paste it\n"
    "  neurotouch diagnostics --json --out report.json\n\n"
    "Exit code 0, also if the doctor finds faults: the report lists them."
)
@click.option(
    "--out",
    type=OutFile(),
    help="Write it to this file instead of printing it.",
)
@click.option("--force", is_flag=True, help="Replace the file if it exists.")
@json_option
def command(out: Path | None, force: bool, as_json: bool) -> None:
    """Write one report about this machine, the program and the doctor's findings.

    The report leaves out user name, host name, home folder, serial numbers and addresses; a list at
    its end says what. It stays on this machine until you send it.
    """
    from neurotouch_hid.doctor import examine, list_checks
    from neurotouch_hid.doctor.bug_report import format_report, gather

    if out is not None and out.exists() and not force:
        raise NeuroTouchError(
            f"'{out}' exists already.", hint="Give another name, or --force to replace it."
        )
    echo("Checking everything, about 15 seconds ...", err=True)
    report = gather(examine(list_checks()))
    text = json.dumps(report, indent=2) + "\n" if as_json else format_report(report)
    if out is None:
        echo(text, nl=False)
        return
    save_text(out, text)
    echo(f"OK the report is in {out}. Read it before you send it.", err=True)

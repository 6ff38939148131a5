"""``neurotouch doctor``: checks this machine and says how to fix it."""

import shlex
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from neurotouch_hid.cli.ui.completing import complete_source
from neurotouch_hid.cli.ui.options import OutFile, gel_option
from neurotouch_hid.cli.ui.output import (
    echo,
    json_option,
    plain_option,
    print_json,
    show_finding,
)

if TYPE_CHECKING:
    from neurotouch_hid.doctor import Finding
    from neurotouch_hid.doctor.directions import Advice


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch doctor\n"
    "  neurotouch doctor --keys                   only try the keys that stop everything\n"
    "  neurotouch doctor --source video:          a video camera and the gel before it\n"
    "  neurotouch doctor --directions             also find a mirrored or turned picture\n"
    "  neurotouch doctor --fix-script > fix.sh    read it, then: sh fix.sh\n"
    "  neurotouch doctor --json | jq '.[] | select(.status == \"FAILED\")'\n\n"
    "Exit code 0 if nothing failed, 1 otherwise."
)
@click.option(
    "--keys", is_flag=True, help="Only try the keys that stop everything, without a time limit."
)
@click.option(
    "--directions",
    is_flag=True,
    help="Ask for one push and one twist, and find a mirrored or turned picture.",
)
@click.option(
    "--fix-script", is_flag=True, help="Print a shell script with the fixes; run nothing."
)
@click.option(
    "--picture",
    type=OutFile(),
    help="Where to save the picture of the gel. Default: in your cache folder.",
)
@click.option(
    "--source",
    shell_complete=complete_source,
    help="Check this source instead of the DAVIS: video:NAME (a video camera), file:NAME.aedat4 or "
    "sim:NAME.",
)
@gel_option
@plain_option
@json_option
def command(
    keys: bool,
    directions: bool,
    fix_script: bool,
    picture: Path | None,
    source: str | None,
    gel: str | None,
    plain: bool,
    as_json: bool,
) -> None:
    """Check this machine and say how to fix its faults.

    Each check has a time limit: one that hangs is reported and skipped. Nothing is changed.
    """
    if source is not None:
        from neurotouch_hid.source.check import check_source

        check_source(source)
    from neurotouch_hid.doctor import CheckStatus, examine, list_checks

    checks = [] if keys else list_checks(picture, source, gel)
    quiet = as_json or fix_script
    findings = []
    for finding in examine(checks, tell=lambda text: echo(text, err=True)):
        findings.append(finding)
        if not quiet:
            show_finding(finding, plain=plain)
    if keys:
        findings.append(_try_keys())
        if not quiet:
            show_finding(findings[-1], plain=plain)
    if directions:
        finding, advice = _try_directions(source, gel)
        findings.append(finding)
        if not quiet:
            show_finding(finding, plain=plain)
            if advice is not None:
                _offer(advice)
    if as_json:
        print_json([finding.as_json() for finding in findings])
    elif fix_script:
        click.echo(_write_script(findings), nl=False)
    if any(finding.status is CheckStatus.FAILED for finding in findings):
        raise SystemExit(1)


def _write_script(findings: "list[Finding]") -> str:
    lines = [
        "#!/bin/sh",
        "# What 'neurotouch doctor --fix-script' proposes for this machine. Read it before you run",
        "# it: each part says its purpose, and you may delete parts. Nothing has been run yet.",
        "set -eu",
    ]
    done: set[str] = set()
    for finding in findings:
        fresh = [line for line in finding.commands if line not in done]
        done.update(fresh)
        if not fresh:
            continue
        about = f"{finding.status} {finding.check}: {finding.sentence}\n{finding.fix or ''}"
        # A device may have any name; here it must stay a comment.
        lines += ["", *(f"# {line}" for line in about.splitlines())]
        for line in fresh:
            lines += [f"echo {shlex.quote(f'+ {line}')}", line]
    if not done:
        lines += ["", "# Nothing that a command could fix was found."]
    return "\n".join([*lines, ""])


def _try_keys() -> "Finding":
    from neurotouch_hid.doctor.finding import skip
    from neurotouch_hid.doctor.inventory import find_driver
    from neurotouch_hid.doctor.person import try_chords

    name = "stop keys"
    if not sys.stdin.isatty():
        return replace(skip("They can only be tried in a terminal."), check=name)
    if find_driver() is not None:
        echo("The running driver reacts to them too; to continue: neurotouch resume", err=True)
    finding = try_chords(lambda text: echo(text, err=True), _wait_or_skip)
    return replace(finding, check=name)


def _try_directions(source: str | None, gel: str | None) -> "tuple[Finding, Advice | None]":
    from neurotouch_hid.client import find_live_source
    from neurotouch_hid.doctor.directions import try_directions
    from neurotouch_hid.doctor.finding import CheckStatus, Finding, skip
    from neurotouch_hid.doctor.inventory import find_driver
    from neurotouch_hid.driver.gel_file import choose_gel
    from neurotouch_hid.errors import NeuroTouchError

    name = "directions"
    if not sys.stdin.isatty():
        return replace(skip("They can only be tried in a terminal."), check=name), None
    if source is None and find_driver() is not None:
        echo("The running driver reacts to your hand too. To stop it: neurotouch pause", err=True)
    try:
        made = choose_gel(gel, source or find_live_source()).gel
        finding, advice = try_directions(
            source, lambda text: echo(text, err=True), _is_skipped, made
        )
    except NeuroTouchError as error:
        finding, advice = Finding(CheckStatus.FAILED, error.message, error.hint), None
    return replace(finding, check=name), advice


def _offer(advice: "Advice") -> None:
    """Asks whether to save what the directions have shown, and does so."""
    from neurotouch_hid.driver.camera_settings import save_camera_settings

    if not advice.changes or not advice.is_own:
        return
    if click.confirm(f"Write this into {advice.path} now?", default=False, err=True):
        save_camera_settings(advice.path, advice.changes)
        echo("Saved. It applies at the next start of the driver.")


def _is_skipped() -> bool:
    """Returns True once the person has typed S and Enter, or the terminal has gone."""
    import select

    if not select.select([sys.stdin], [], [], 0.0)[0]:
        return False
    line = sys.stdin.readline()
    return not line or line.strip().lower() == "s"


def _wait_or_skip(happened: Callable[[], bool]) -> bool:
    """Waits until the condition is true; returns False if the person types S and Enter first.

    Other lines do not count, because Enter is part of a chord.
    """
    import time

    while not happened():
        if _is_skipped():
            return False
        time.sleep(0.1)
    return True

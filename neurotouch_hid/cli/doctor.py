"""``neurotouch doctor``: what is missing on this machine."""

import json

import click


@click.command(epilog="\b\nExamples:\n  neurotouch doctor\n  neurotouch doctor --json | jq .")
@click.option("--json", "as_json", is_flag=True, help="Print the findings as JSON.")
def command(as_json: bool) -> None:
    """Check this machine and say how to fix what is missing.

    Exit code 0 if nothing failed, 1 otherwise.
    """
    from neurotouch_hid.doctor import Status, examine

    findings = []
    for finding in examine():
        findings.append(finding)
        if not as_json:
            click.echo(f"{finding.status:<8} {finding.check}: {finding.sentence}")
            if finding.fix:
                click.echo(f"         Fix: {finding.fix}")
    if as_json:
        click.echo(json.dumps([finding.as_json() for finding in findings], indent=2))
    if any(finding.status is Status.FAILED for finding in findings):
        raise SystemExit(1)

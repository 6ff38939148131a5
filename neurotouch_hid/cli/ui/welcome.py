"""``neurotouch`` alone: how things stand, and the next sensible step."""

from typing import Any

import click


def welcome() -> None:
    """Says in a few lines what is there and what to do next; changes nothing."""
    from neurotouch_hid import client as driver
    from neurotouch_hid.errors import DriverError

    try:
        _describe_driver(driver.ask("status"))
    except DriverError:
        click.echo(_advise())
    click.echo("All commands: neurotouch --help")


def _describe_driver(status: dict[str, Any]) -> None:
    click.echo(f"The driver is {status['state']}, with the profile {status['profile']}.")
    click.echo(f"source: {status.get('source', 'unknown')}")
    click.echo(f"pad: {status.get('device', 'unknown')}")
    click.echo(f"gel: {status['gel']}")
    if status["state"] != "running":
        click.echo("Next: neurotouch resume")
    elif status["errors"]:
        click.echo(f"Last error: {status['errors'][-1]['error']}. More: neurotouch status")
    else:
        click.echo("Next: neurotouch view")


def _advise() -> str:
    from neurotouch_hid.profile.reading.library import find_user_file
    from neurotouch_hid.source.davis.finding import find_cameras

    cameras = find_cameras()
    if not cameras:
        return "No camera found. Try it now: neurotouch demo"
    reasons = [info.reason for info in cameras]
    if all(reasons):
        if "no right" in reasons[0]:
            return "Camera found but not readable. Fix: neurotouch setup"
        return f"Camera found but not usable: {reasons[0]}. Fix: neurotouch doctor"
    user = find_user_file()
    if user.exists() and "range:" in user.read_text(encoding="utf-8", errors="replace"):
        return "Ready. Next: neurotouch run"
    return "Ready. Next: neurotouch calibrate (about 3 minutes, no time limit)"

"""``neurotouch`` alone: prints the present state and the next step."""

import os
import sys
from typing import Any

import click

from neurotouch_hid.cli.ui.output import is_plain


def welcome() -> None:
    """Prints the present state and the next step in a few lines; changes nothing."""
    from neurotouch_hid import client as driver
    from neurotouch_hid.errors import DriverError

    try:
        _describe_driver(driver.ask("status"))
    except DriverError:
        click.echo(_advise())
    click.echo("All commands: neurotouch --help")


def has_desktop() -> bool:
    """Returns True if a person at a desktop typed the command, so that a page can be opened."""
    desktop = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    return bool(desktop) and sys.stdout.isatty() and not is_plain()


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
    from neurotouch_hid.page.situation import find_situation

    found = find_situation()
    return f"{found.text} {found.next}"

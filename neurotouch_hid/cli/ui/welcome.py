"""``neurotouch`` alone: the present state, and the next sensible step."""

import os
import sys
from typing import Any

import click

from neurotouch_hid.cli.ui.output import is_plain


def welcome() -> None:
    """Says in a few lines what is there and what to do next; changes nothing."""
    from neurotouch_hid import client as driver
    from neurotouch_hid.errors import DriverError

    try:
        _describe_driver(driver.ask("status"))
    except DriverError:
        click.echo(_advise())
    click.echo("All commands: neurotouch --help")


def has_desktop() -> bool:
    """Tells whether a person at a desktop has asked, who can be shown a page."""
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
        click.echo("Next: neurotouch view --edit --open")


def _advise() -> str:
    from neurotouch_hid.page.situation import find_situation

    found = find_situation()
    return f"{found.text} {found.next}"

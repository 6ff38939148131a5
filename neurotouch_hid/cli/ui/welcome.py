"""``neurotouch`` alone: prints the present state and the next step."""

import os
import sys
from typing import TYPE_CHECKING

from neurotouch_hid.cli.ui.output import echo, is_plain

if TYPE_CHECKING:
    from neurotouch_hid.status import Status

_STATES = {"running": "runs", "paused": "is paused", "panic": "is stopped by panic"}


def welcome() -> None:
    """Prints the present state and the next step in a few lines; changes nothing."""
    from neurotouch_hid import client as driver
    from neurotouch_hid.errors import DriverError, NotRunningError
    from neurotouch_hid.players import explain_start

    try:
        _describe_driver(driver.ask_status())
    except NotRunningError as error:
        echo(_advise())
        if error.hint != explain_start():  # another player's driver runs
            echo(error.hint or "")
    except DriverError as error:  # there is one: to start another is no advice
        echo(error.message)
        echo(f"Fix: {error.hint}" if error.hint else "Next: neurotouch doctor")
    echo("All commands: neurotouch --help")


def has_desktop() -> bool:
    """Returns True if a person at a desktop typed the command, so that a page can be opened."""
    desktop = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    return bool(desktop) and sys.stdout.isatty() and not is_plain()


def _describe_driver(status: "Status") -> None:
    gel = status["gel"]
    echo(f"The driver {_STATES[status['state']]}, with the profile {status['profile']}.")
    echo(f"source: {'SIMULATED ' if status['simulated'] else ''}{status['source']}")
    echo(f"pad: {status['device']}")
    echo(f"gel: {gel['text']}")
    if status["state"] != "running":
        echo("Next: neurotouch resume")
    elif gel["fix"]:
        echo(f"Fix: {gel['fix']}")
    elif status["errors"]:
        echo(f"Last error: {status['errors'][-1]['error']}. More: neurotouch status")
    else:
        echo("Next: neurotouch view --edit --open")


def _advise() -> str:
    from neurotouch_hid.page.situation import find_situation

    found = find_situation()
    return f"{found.text} {found.next}"

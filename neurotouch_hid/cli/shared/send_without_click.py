"""Sends pause, resume, panic, stop or reload to the running driver, as fast as possible.

In an emergency nothing but the standard library is imported before it, not even ``click``.
"""

import json
import sys

from neurotouch_hid.client import ask, wait_until_ended
from neurotouch_hid.errors import DriverError, NotRunningError
from neurotouch_hid.players import list_players


def send_command(command: str, *, as_json: bool = False) -> int:
    """Sends a command to the drivers of all players, prints the answers, returns the exit code."""
    try:
        texts = _ask_all(command)
    except DriverError as error:
        if as_json:
            print(json.dumps({"status": "FAILED", "message": error.message, "fix": error.hint}))
            return error.exit_code
        print(f"Error: {error.message}", file=sys.stderr)
        if error.hint:
            print(f"Fix: {error.hint}", file=sys.stderr)
        return error.exit_code
    for text in texts:
        print(json.dumps({"status": "OK", "message": text}) if as_json else text)
    return 0


def _ask_all(command: str) -> list[str]:
    """Returns the answers; sends the command to all drivers, even if one fails.

    Raises:
        DriverError: none runs, or one refuses.
    """
    texts, failures = [], []
    players = list_players()
    for player in players:
        whose = f"Player {player}: " if len(players) > 1 else ""
        try:
            text = ask(command, player=player)["text"]
            if command == "stop":
                wait_until_ended(player)
            texts.append(whose + text)
        except NotRunningError as error:  # a killed driver has left its socket behind
            missing = error
        except DriverError as error:
            failures.append(error)
    if failures:
        raise failures[0]
    if not texts:
        raise missing
    return texts

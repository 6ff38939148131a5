"""``neurotouch pause``, ``resume``, ``panic``, ``stop``: one word to the running drivers, at once.

In an emergency nothing but the standard library is imported before it, not even ``click``.
"""

import json
import os
from collections.abc import Iterable

from neurotouch_hid.client import NOT_RUNNING, Reached, ask_every, wait_until_ended
from neurotouch_hid.errors import DriverError
from neurotouch_hid.players import PLAYER, PLAYERS, list_players
from neurotouch_hid.process.dead_output import print_answer, print_error


def send_command(command: str, *, as_json: bool = False, on_desktop: bool = False) -> int:
    """Sends a command to every driver of every player that this person may ask.

    Prints what each answers, after its name.

    Args:
        command: one word, such as ``panic``.
        as_json: print each answer as JSON.
        on_desktop: show a failure as a message on the desktop, too.

    Returns:
        The exit code: 0 if all have carried it out.
    """
    try:
        reached = ask_every(command, _choose_players(command))
    except DriverError as error:
        return _tell_nobody(command, error, as_json=as_json, on_desktop=on_desktop)
    if command == "stop":
        reached = [_wait(each) for each in reached]
    code = 0
    for name, each in zip(_name_all(reached), reached, strict=True):
        if each.error is not None:
            code = _tell_failure(name, each.error, as_json=as_json, on_desktop=on_desktop)
        else:
            _tell(name + each.text, as_json=as_json)
    return code


def _choose_players(command: str) -> list[int]:
    """Returns the players whose drivers get a command; a wrong variable stops no panic."""
    try:
        return list_players()
    except DriverError:
        if command != "panic":
            raise
        return [int(each) for each in PLAYERS]


def _tell(text: str, *, as_json: bool) -> None:
    print_answer(json.dumps({"status": "OK", "message": text}) if as_json else text)


def _tell_nobody(command: str, error: DriverError, *, as_json: bool, on_desktop: bool) -> int:
    """Prints that no driver was reached, and what that means; returns the exit code.

    To end what does not run is done already. To release what nobody holds is not: a person who
    needs it must know that nothing was reached.
    """
    if error.message == NOT_RUNNING and command == "stop":
        _tell(f"{NOT_RUNNING} There is nothing to end.", as_json=as_json)
        return 0
    if command == "panic":
        hint = "If a button is still held, another program holds it. See: neurotouch devices"
        error = type(error)(f"{error.message} Nothing was reached or released.", hint=hint)
    return _tell_failure("", error, as_json=as_json, on_desktop=on_desktop)


def _wait(reached: Reached) -> Reached:
    """Returns the same once that driver has ended, or with the error that it has not."""
    try:
        if reached.error is None:
            wait_until_ended(reached.folder)
    except DriverError as error:
        return reached._replace(error=error)
    return reached


def _name_all(reached: Iterable[Reached]) -> list[str]:
    """Returns what to write before the answer of each driver.

    A single one has its name too: a person must read whom the command has reached.
    """
    rows = [(each.player, each.name) for each in reached]
    players, names = {player for player, _ in rows}, {name for _, name in rows}
    if players == {1} or (len(players) == 1 and os.environ.get(PLAYER)):
        return [f"{name[0].upper()}{name[1:]}: " for _, name in rows]
    if len(names) == 1:
        return [f"Player {player}: " for player, _ in rows]
    return [f"Player {player}, {name}: " for player, name in rows]


def _tell_failure(name: str, error: DriverError, *, as_json: bool, on_desktop: bool) -> int:
    """Tells why a driver refused, and returns the exit code."""
    message = name + error.message
    if as_json:
        print_answer(json.dumps({"status": "FAILED", "message": message, "fix": error.hint}))
    else:
        print_error(f"Error: {message}")
        if error.hint:
            print_error(f"Fix: {error.hint}")
    if on_desktop:
        from neurotouch_hid.cli.ui.notification import notify

        notify("NeuroTouch cannot do this", f"{message} {error.hint or ''}".strip())
    return error.exit_code

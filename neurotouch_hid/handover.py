"""Gives the running driver this person's settings as they are saved now.

A driver of this person reads the files itself; the system's service may not, and gets a copy. Only
the standard library is imported here.
"""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from neurotouch_hid.client import ask
from neurotouch_hid.errors import DriverError, NotRunningError, ProfileError
from neurotouch_hid.files.small_file import MAX_SETTINGS_BYTES, read_text
from neurotouch_hid.players import (
    find_config_folder,
    find_user_file,
    has_socket,
    list_players,
    list_runtime_folders,
    look_into,
)
from neurotouch_hid.vocabulary import NAME_PATTERN


@dataclass(frozen=True, slots=True)
class Handover:
    """The result of handing saved settings over.

    Attributes:
        status: ``plays``: a driver has them; ``waits``: none runs; ``refused``: the driver keeps
            its settings.
        text: the same in a sentence.
        fix: the fix after a refusal.
        profiles: the active profiles of the drivers that have them.
    """

    status: str
    text: str
    fix: str = ""
    profiles: tuple[str, ...] = ()


def hand_over(player: int | None = None) -> Handover:
    """Hands this person's settings to the running driver, or to those of all players.

    Args:
        player: the player number; None: every player, because profiles are for all.
    """
    active: list[str] = []
    refused: Handover | None = None
    for number in list_players() if player is None else [player]:
        if not any(map(has_socket, list_runtime_folders(number))):
            continue
        try:
            answer = ask("settings", player=number, **collect_settings(number))
        except NotRunningError:
            continue
        except (DriverError, ProfileError) as error:
            text = f"The running driver does not play it: {error.message}"
            refused = refused or Handover("refused", text, error.hint or "")
            continue
        active.append(str(answer.get("profile")))
    if refused is not None:
        return refused
    if not active:
        return Handover("waits", "No driver is running; it applies from the next start.")
    names = " and ".join(f"'{name}'" for name in dict.fromkeys(active))
    return Handover("plays", f"It applies now; the active profile is {names}.", "", tuple(active))


def collect_settings(player: int) -> dict[str, Any]:
    """Returns a player's settings as the question ``settings`` takes them.

    Files that are no text, or have no name of a profile, are left out: they cannot be played, and
    a command that names them says so.

    Raises:
        ProfileError: the folder of profiles is there and cannot be looked into. To hand over none
            would delete the service's copies.
    """
    folder = find_config_folder()
    texts = {
        path.stem: _read(path)
        for path in look_into(folder / "profiles")
        if path.suffix == ".yaml" and re.fullmatch(NAME_PATTERN, path.stem)
    }
    return {
        "folder": str(folder),
        "user": _read(find_user_file(player)),
        "profiles": {name: text for name, text in texts.items() if text is not None},
    }


def _read(path: Path) -> str | None:
    try:
        return read_text(path, MAX_SETTINGS_BYTES)
    except OSError:
        return None

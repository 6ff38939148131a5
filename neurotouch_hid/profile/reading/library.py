"""Where profiles lie: the user's own folder first, then those shipped with the program."""

import os
import re
from pathlib import Path
from typing import Final

from neurotouch_hid.client import find_player
from neurotouch_hid.errors import ProfileError
from neurotouch_hid.profile.faults import make_printable, suggest
from neurotouch_hid.resources import PACKAGE_FOLDER, find_resources
from neurotouch_hid.vocabulary import NAME_PATTERN

OWN_VALUES: Final = "user"
"""What commands call the person's own values; no profile has this name."""


def find_shipped_folder(package: Path = PACKAGE_FOLDER) -> Path:
    """The folder of the shipped profiles."""
    return find_resources("profiles", package)


def find_user_folder() -> Path:
    """The folder for the user's own profiles; it need not exist."""
    return _find_config_folder() / "profiles"


def find_user_file(player: int | None = None) -> Path:
    """Returns the file of the person's own values; it need not exist.

    Another player has another hand: player 2 has it in a folder ``player-2``, and beside it what
    else belongs to that player. Profiles are for everybody.

    Args:
        player: the player number; None means the one of the environment.

    Raises:
        DriverError: the environment names no player.
    """
    player = player or find_player()
    folder = _find_config_folder()
    return (folder if player == 1 else folder / f"player-{player}") / "user.yaml"


def _find_config_folder() -> Path:
    config = Path(os.environ.get("XDG_CONFIG_HOME", ""))
    if not config.is_absolute():  # the XDG specification: a relative path is to be ignored
        config = Path("~/.config").expanduser()
    return config / "neurotouch"


def list_profiles() -> dict[str, Path]:
    """Every profile that can be loaded by name, sorted; a user's own hides a shipped one.

    Raises:
        ProfileError: a folder is there and cannot be looked into.
    """
    try:
        found = {
            path.stem: path
            for folder in (find_shipped_folder(), find_user_folder())
            if folder.is_dir()
            for path in folder.glob("*.yaml")
            if re.fullmatch(NAME_PATTERN, path.stem) and path.is_file()
        }
    except OSError as error:
        raise ProfileError(f"{error.filename} cannot be looked into: {error.strerror}") from None
    return dict(sorted(found.items()))


def find_profile(name_or_path: str | Path) -> Path:
    """The file of a profile.

    Args:
        name_or_path: a path (it has a ``/`` or ends in ``.yaml`` or ``.yml``) or a name, which is
            looked for in the user's folder, then among the shipped ones.

    Raises:
        ProfileError: no profile has this name, or nobody can know.
    """
    if isinstance(name_or_path, Path):
        return name_or_path
    if "/" in name_or_path or name_or_path.endswith((".yaml", ".yml")):
        return Path(name_or_path)
    known = list_profiles()
    if name_or_path in known:
        return known[name_or_path]
    near = suggest(name_or_path, list(known))
    raise ProfileError(
        f"no profile is called '{make_printable(name_or_path[:64])}'{near and ': ' + near}",
        hint=f"Profiles: {', '.join(known) or 'none'}. Your own go to {find_user_folder()}.",
    )

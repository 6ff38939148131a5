"""Players, each with a driver, sockets and settings of their own; only profiles are for all.

Only the standard library is imported here, so that ``neurotouch panic`` is there at once.
"""

import os
from pathlib import Path
from typing import Final

from neurotouch_hid.errors import DriverError, ProfileError

PLAYER: Final = "NEUROTOUCH_PLAYER"
PLAYERS: Final = ("1", "2", "3", "4")
"""Each player has a driver of their own."""

SERVICE_FOLDER: Final = Path("/run/neurotouch")
"""The folder of the sockets of the first player's service."""

SERVICE_UNIT: Final = Path("/usr/lib/systemd/system/neurotouch.service")
"""Part of the Debian package, where only the service has the rights to camera and gamepad."""

MACHINE_FOLDER: Final = Path("/etc/neurotouch")
"""The administrator's settings, for everybody without settings of their own."""

_SOCKET: Final = "control"


def find_player() -> int:
    """Returns the player number: 1, unless ``NEUROTOUCH_PLAYER`` names another; empty is none.

    Raises:
        DriverError: it names none.
    """
    text = os.environ.get(PLAYER) or "1"
    if text not in PLAYERS:
        raise DriverError(
            f"The variable {PLAYER} must be one of {', '.join(PLAYERS)}, not {text!r}.",
            hint=f"For the first player: unset {PLAYER}",
        )
    return int(text)


def list_players() -> list[int]:
    """Returns players whose driver may run: the environment's, else all with a socket."""
    if os.environ.get(PLAYER):
        return [find_player()]
    found = (
        player for player in map(int, PLAYERS) if any(map(has_socket, list_runtime_folders(player)))
    )
    return list(found) or [1]


def name_command(player: int) -> str:
    """Returns the command for one player's driver alone, without which it may reach others."""
    is_alone = player == 1 and list_players() == [1]
    return "neurotouch" if is_alone else f"{PLAYER}={player} neurotouch"


def find_user_file(player: int | None = None, folder: Path | None = None) -> Path:
    """Returns the file of the person's own values; it need not exist.

    Another player has another hand: player 2 has it in a folder ``player-2``, and beside it what
    else belongs to that player. Profiles are for everybody.

    Args:
        player: the player number; None means the one of the environment.
        folder: the person's settings; None means those of this process's user.

    Raises:
        DriverError: the environment names no player.
    """
    player = player or find_player()
    folder = folder or find_config_folder()
    return (folder if player == 1 else folder / f"player-{player}") / "user.yaml"


def find_home() -> Path:
    """Returns this user's home folder.

    Raises:
        ProfileError: neither ``HOME`` nor the machine's list of users names one.
    """
    home = Path(os.path.expanduser("~"))  # noqa: PTH111  a Path would raise RuntimeError
    if not home.is_absolute():
        raise ProfileError(
            "Your home folder is not known, so there is no place for settings.",
            hint="Set the variable HOME to the whole path of a folder of yours.",
        )
    return home


def find_config_folder() -> Path:
    """Returns the folder of all settings of this user; it need not exist.

    Raises:
        ProfileError: as ``find_home``.
    """
    config = Path(os.environ.get("XDG_CONFIG_HOME", ""))
    if not config.is_absolute():  # the XDG specification: a relative path is to be ignored
        config = find_home() / ".config"
    return config / "neurotouch"


def look_into(folder: Path) -> list[Path]:
    """Returns the paths in a folder of settings, sorted; nothing where there is no such folder.

    ``Path.glob`` finds nothing also where nobody may look.

    Raises:
        ProfileError: the folder is there and cannot be looked into.
    """
    try:
        paths = sorted(folder.iterdir())
        os.stat(f"{folder}/.")  # noqa: PTH116  a Path drops the dot, which needs the right to search
    except (FileNotFoundError, NotADirectoryError):
        return []
    except OSError as error:
        from neurotouch_hid.partial_file import explain_missing_right  # noqa: PLC0415

        raise ProfileError(
            f"The folder '{folder}' cannot be looked into: {error.strerror}.",
            hint=explain_missing_right(error, "look into it"),
        ) from None
    return paths


def find_machine_folder() -> Path:
    """Returns the folder of the machine's settings, which apply where a person has none."""
    return Path(os.environ.get("CONFIGURATION_DIRECTORY", "").split(":")[0] or MACHINE_FOLDER)


def explain_start() -> str:
    """Returns how a driver is started on this machine, for people."""
    if SERVICE_UNIT.exists():
        start = "Plug the camera in, or: sudo systemctl start neurotouch"
        return f"{start}. Without a camera: neurotouch demo"
    return "Start it: neurotouch run. Without a camera: neurotouch demo"


def find_runtime_folder(player: int | None = None) -> Path:
    """Returns the folder a driver of this user keeps its sockets in; it need not exist.

    Args:
        player: the player number; None means the one of the environment.
    """
    return list_runtime_folders(player)[0]


def is_service_folder(folder: Path) -> bool:
    """Returns whether a folder is that of a service, of whatever player."""
    return folder in [SERVICE_FOLDER, *(_name_for(int(each), SERVICE_FOLDER) for each in PLAYERS)]


def find_socket(folder: Path) -> Path:
    """Returns the control socket in a driver's folder."""
    return folder / _SOCKET


def has_socket(folder: Path) -> bool:
    """Returns whether a driver's folder has a control socket; none in a folder closed to us.

    A driver of root leaves such a folder in ``/run``.
    """
    return os.path.lexists(find_socket(folder))  # where Path.exists would raise PermissionError


def list_runtime_folders(player: int | None = None) -> list[Path]:
    """Returns the folders that a driver may be in, the user's own first, the service's last.

    Args:
        player: the player number; None means the one of the environment.
    """
    player = player or find_player()
    return [_name_for(player, folder) for folder in _list_first_folders()]


def _name_for(player: int, folder: Path) -> Path:
    """Returns what a folder of the first player is called for another one."""
    own = f"-{player}"  # which the folder of this player's service bears already
    if player == 1 or folder.name.endswith(own):
        return folder
    return folder.with_name(folder.name + own)


def _list_first_folders() -> list[Path]:
    service = os.environ.get("RUNTIME_DIRECTORY", "").split(":")[0]
    if service:  # we are a part of a service, for which systemd made this folder
        return [Path(service)]
    user = os.getuid()
    session = Path(os.environ.get("XDG_RUNTIME_DIR", ""))
    folders = [session / "neurotouch"] if session.is_absolute() else []
    if Path(f"/run/user/{user}").is_dir():
        folders.append(Path(f"/run/user/{user}/neurotouch"))
    if user != 0 and not folders:
        # The folder's owner and mode are checked before it is used.
        folders.append(Path(f"/tmp/neurotouch-{user}"))  # noqa: S108
    return list(dict.fromkeys([*folders, SERVICE_FOLDER]))

"""The running driver as other processes reach it: where its socket lies, and one question to it.

A question is one line of JSON, ``{"command": "pause"}``, and so is its answer: ``ok``, with
``text`` for people if it was done, else with ``error`` and perhaps ``hint``. Only the standard
library is imported here, so that ``neurotouch panic`` is there at once.
"""

import json
import os
import socket
import time
from contextlib import suppress
from pathlib import Path
from typing import Any, Final

from neurotouch_hid.errors import DriverError, NotRunningError

LIMIT_BYTES: Final = 64 * 1024
"""The longest question or answer."""

REQUEST_S: Final = 1.0
"""A question must be there, and is answered, within this time."""

LOADING_S: Final = 10.0
"""What has a profile loaded, ``reload`` or ``use``, is answered within this time: the answer says
what came of it."""

PLAYER: Final = "NEUROTOUCH_PLAYER"
PLAYERS: Final = ("1", "2", "3", "4")
"""Each player has a driver of their own."""

_SOCKET: Final = "control"
_SERVICE: Final = Path("/run/neurotouch")
_PATIENCE_S: Final = 3 * REQUEST_S
_AGAIN_S: Final = 0.1

Answer = dict[str, Any]


def find_runtime_folder(player: int | None = None) -> Path:
    """Returns the folder a driver of this user keeps its sockets in; it need not exist.

    Args:
        player: the player number; None means the one of the environment.
    """
    return list_folders(player)[0]


def find_socket(folder: Path) -> Path:
    """The control socket in a driver's folder."""
    return folder / _SOCKET


def ask(command: str, *, player: int | None = None, **arguments: str) -> Answer:
    """The running driver's answer to a command.

    Args:
        command: ``pause``, ``resume``, ``panic``, ``reload``, ``status`` or ``use``.
        player: whose driver; as the environment says without.
        arguments: what the command needs: ``profile``, a name or an absolute path, for ``use``.

    Raises:
        NotRunningError: no driver is running.
        DriverError: it does not answer, or it refuses.
    """
    question = json.dumps({"command": command, **arguments}).encode() + b"\n"
    patience_s = _PATIENCE_S + (LOADING_S if command in ("reload", "use") else 0.0)
    answer, line = _ask_any(question, patience_s, player)
    line.close()
    if answer.get("ok") is not True:
        raise DriverError(str(answer.get("error")), hint=answer.get("hint"))
    return answer


def open_stream(command: str) -> tuple[Answer, socket.socket]:
    """The running driver's answer, and the socket on which it goes on speaking.

    Args:
        command: ``record``: packets follow, until either end closes.

    Raises:
        NotRunningError: no driver is running.
        DriverError: it does not answer, or it refuses.
    """
    answer, line = _ask_any(json.dumps({"command": command}).encode() + b"\n", _PATIENCE_S)
    if answer.get("ok") is not True:
        line.close()
        raise DriverError(str(answer.get("error")), hint=answer.get("hint"))
    line.settimeout(None)
    return answer, line


def is_service_running() -> bool:
    """Whether the system's service is there, whoever may ask it anything."""
    return is_served(_SERVICE)


def is_served(folder: Path) -> bool:
    """Whether a driver listens in a folder, of whatever user."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as line:
        line.settimeout(REQUEST_S)
        try:
            line.connect(str(find_socket(folder)))
        except OSError:
            return False
    return True


def find_player() -> int:
    """Whose driver is meant: 1, unless ``NEUROTOUCH_PLAYER`` names another player.

    Raises:
        DriverError: it names none.
    """
    text = os.environ.get(PLAYER, "1")
    if text not in PLAYERS:
        raise DriverError(f"{PLAYER} must be one of {', '.join(PLAYERS)}, not {text!r}.")
    return int(text)


def list_players() -> list[int]:
    """Those whose drivers may run: the one that the environment names, else all with a socket."""
    if PLAYER in os.environ:
        return [find_player()]
    found = (
        player
        for player in map(int, PLAYERS)
        if any(find_socket(folder).exists() for folder in list_folders(player))
    )
    return list(found) or [1]


def list_folders(player: int | None = None) -> list[Path]:
    """Where a driver may be, the user's own first, the system's service last.

    Args:
        player: whose driver; as the environment says without.
    """
    player = player or find_player()
    folders = _list_folders_of_first()
    if player == 1:
        return folders
    own = f"-{player}"  # which the folder of this player's service bears already
    return [
        folder if folder.name.endswith(own) else folder.with_name(folder.name + own)
        for folder in folders
    ]


def _list_folders_of_first() -> list[Path]:
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
    return list(dict.fromkeys([*folders, _SERVICE]))


def _ask_any(
    question: bytes, patience_s: float, player: int | None = None
) -> tuple[Answer, socket.socket]:
    for path in map(find_socket, list_folders(player)):
        try:
            return _ask_patiently(path, question, patience_s)
        except (FileNotFoundError, NotADirectoryError, ConnectionRefusedError):
            continue  # nobody is there: no socket, or one that its driver has left behind
        except TimeoutError:
            raise DriverError(
                "The driver does not answer.", hint="Is it still starting? Try again in a moment."
            ) from None
        except OSError as error:
            raise DriverError(f"The driver cannot be reached: {error.strerror} ({path}).") from None
        except ValueError:
            raise DriverError(f"What answers at {path} is not a driver.") from None
    raise NotRunningError("No driver is running.", hint="Start it: neurotouch run")


def _ask_patiently(path: Path, question: bytes, patience_s: float) -> tuple[Answer, socket.socket]:
    """The answer and the open line; while the driver is busy with others, asks again."""
    deadline = time.monotonic() + patience_s
    while time.monotonic() < deadline:
        with suppress(BlockingIOError):  # its queue is full
            answer, line = _ask_once(path, question, patience_s)
            if not answer.get("busy"):
                return answer, line
            line.close()
        time.sleep(_AGAIN_S)
    raise TimeoutError


def _ask_once(path: Path, question: bytes, patience_s: float) -> tuple[Answer, socket.socket]:
    line = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    try:
        line.settimeout(patience_s)
        line.connect(str(path))
        with suppress(BrokenPipeError, ConnectionResetError):  # refused unread; the answer says why
            line.sendall(question)
        answer = json.loads(_read_line(line))
        if not isinstance(answer, dict):
            raise ValueError
    except (OSError, ValueError):
        line.close()
        raise
    return answer, line


def _read_line(line: socket.socket) -> bytes:
    """A line of text, and not a byte more: what comes after it may be no text."""
    text = b""
    while len(text) <= LIMIT_BYTES:
        ahead = line.recv(4096, socket.MSG_PEEK)
        piece = line.recv(ahead.find(b"\n") + 1 or len(ahead)) if ahead else b""
        text += piece
        if not piece or text.endswith(b"\n"):
            break
    return text

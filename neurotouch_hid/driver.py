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

_SOCKET: Final = "control"
_PATIENCE_S: Final = 3 * REQUEST_S
_AGAIN_S: Final = 0.1

Answer = dict[str, Any]


def find_runtime_folder() -> Path:
    """The folder a driver of this user keeps its socket in; it need not exist."""
    return _list_folders()[0]


def find_socket(folder: Path) -> Path:
    """The control socket in a driver's folder."""
    return folder / _SOCKET


def ask(command: str, **arguments: str) -> Answer:
    """The running driver's answer to a command.

    Args:
        command: ``pause``, ``resume``, ``panic``, ``reload``, ``status`` or ``use``.
        arguments: what the command needs: ``profile``, a name or an absolute path, for ``use``.

    Raises:
        NotRunningError: no driver is running.
        DriverError: it does not answer, or it refuses.
    """
    question = json.dumps({"command": command, **arguments}).encode() + b"\n"
    answer = _ask_somebody(question)
    if answer.get("ok") is not True:
        raise DriverError(str(answer.get("error")), hint=answer.get("hint"))
    return answer


def _list_folders() -> list[Path]:
    """Where a driver may be, the user's own first, the system's service last."""
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
    return list(dict.fromkeys([*folders, Path("/run/neurotouch")]))


def _ask_somebody(question: bytes) -> Answer:
    for path in map(find_socket, _list_folders()):
        try:
            return _ask_patiently(path, question)
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


def _ask_patiently(path: Path, question: bytes) -> Answer:
    """The answer; while the driver is busy with others, asks again."""
    deadline = time.monotonic() + _PATIENCE_S
    while time.monotonic() < deadline:
        with suppress(BlockingIOError):  # its queue is full
            answer = _ask_once(path, question)
            if not answer.get("busy"):
                return answer
        time.sleep(_AGAIN_S)
    raise TimeoutError


def _ask_once(path: Path, question: bytes) -> Answer:
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as line:
        line.settimeout(_PATIENCE_S)
        line.connect(str(path))
        with suppress(BrokenPipeError, ConnectionResetError):  # refused unread; the answer says why
            line.sendall(question)
        text = b""
        while b"\n" not in text and len(text) <= LIMIT_BYTES:
            piece = line.recv(4096)
            if not piece:
                break
            text += piece
    answer = json.loads(text)
    if not isinstance(answer, dict):
        raise ValueError
    return answer

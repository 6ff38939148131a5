"""Asks the running driver from another process: finds its socket and sends it one question.

A question is one line of JSON, ``{"command": "pause"}``, and so is its answer: ``ok``, with
``text`` for people if it was done, else with ``error`` and perhaps ``hint``. Only the standard
library is imported here, so that ``neurotouch panic`` is there at once.
"""

import json
import socket
import time
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, Final, NamedTuple

from neurotouch_hid.errors import DriverError, NotRunningError
from neurotouch_hid.ipc import StrangerError, connect_to, find_stopped_peer
from neurotouch_hid.players import (
    PLAYERS,
    SERVICE_FOLDER,
    explain_start,
    find_player,
    find_socket,
    has_socket,
    is_service_folder,
    list_runtime_folders,
    name_command,
)
from neurotouch_hid.printable import make_value_printable
from neurotouch_hid.status import Status, check_status, explain_missing
from neurotouch_hid.vocabulary import RUNNING_DRIVER

NOT_RUNNING: Final = "No driver is running."

LIMIT_BYTES: Final = 1024 * 1024
"""The longest question or answer: a person's settings, which are handed over whole."""

REQUEST_S: Final = 1.0
"""A question must be there, and is answered, within this time."""

LOADING_S: Final = 10.0
"""Time limit for the answer to ``reload`` and ``use``, which load a profile and report the result.
"""

ENDING_S: Final = 10.0
"""A driver that was asked to end has ended within this time."""

PATIENCE_S: Final = 3 * REQUEST_S
_AGAIN_S: Final = 0.1

Reply = dict[str, Any]
"""An answer as it came over the socket: each value is checked where it is used."""


class Reached(NamedTuple):
    """A driver that a command was sent to.

    Attributes:
        player: whose driver it is.
        folder: where its sockets are.
        text: its answer, in a sentence; empty if it refused.
        is_done: whether the command has taken effect already.
        error: why it refused; None if it did not.
    """

    player: int
    folder: Path
    text: str = ""
    is_done: bool = False
    error: DriverError | None = None

    @property
    def name(self) -> str:
        """The name of the driver that people use."""
        return "the service" if is_service_folder(self.folder) else "your driver"


def ask(command: str, *, player: int | None = None, **arguments: Any) -> Reply:
    """Returns the nearest running driver's answer to a command.

    Args:
        command: ``reload``, ``status``, ``gel``, ``use``, ``settings``, ``pause``, ``resume``,
            ``panic`` or ``stop``.
        player: the player number; None means the one of the environment.
        arguments: of the command: ``profile``, a name or an absolute path, for ``use``; for
            ``settings`` see ``handover``.

    Raises:
        NotRunningError: no driver is running.
        DriverError: it does not answer, or it refuses.
    """
    question = json.dumps({"command": command, **arguments}).encode() + b"\n"
    patience_s = PATIENCE_S + (LOADING_S if command in ("reload", "use", "settings") else 0.0)
    answer, connection = _ask_any(question, patience_s, player)
    connection.close()
    return answer


def ask_every(command: str, players: Iterable[int]) -> list[Reached]:
    """Sends a command to all drivers of these players at once, so that none waits for another.

    Args:
        command: ``pause``, ``resume``, ``panic``, ``stop`` or ``reload``.
        players: the player numbers: each may have one of this user, and one that is a service.

    Returns:
        The drivers that run, whether or not they refused.

    Raises:
        NotRunningError: none runs.
    """
    question = json.dumps({"command": command}).encode() + b"\n"
    patience_s = PATIENCE_S + (LOADING_S if command == "reload" else 0.0)
    folders = [(player, each) for player in players for each in list_runtime_folders(player)]
    found: list[Reached | NotRunningError] = []

    def send(player: int, folder: Path) -> None:
        try:
            answer, connection = _ask_at(folder, question, patience_s)
            connection.close()
            found.append(Reached(player, folder, get_text(answer), answer.get("done") is True))
        except NotRunningError as error:
            found.append(error)
        except DriverError as error:
            found.append(Reached(player, folder, error=error))

    _call_at_once(send, folders)
    reached = [each for each in found if isinstance(each, Reached)]
    if not reached:
        raise _join([each for each in found if isinstance(each, NotRunningError)])
    return sorted(reached, key=lambda each: folders.index((each.player, each.folder)))


def _call_at_once(send: Callable[[int, Path], None], folders: list[tuple[int, Path]]) -> None:
    """Calls a function for each folder; for those with a socket at the same time."""
    others = [each for each in folders if has_socket(each[1])][1:]
    threads = []
    if others:  # a panic must be there at once, and mostly there is one driver
        from threading import Thread  # noqa: PLC0415

        threads = [Thread(target=send, args=each) for each in others]
    for thread in threads:
        thread.start()
    for each in folders:
        if each not in others:
            send(*each)
    for thread in threads:
        thread.join()


def get_text(answer: Reply) -> str:
    """Returns what an answer says to people.

    Raises:
        DriverError: it says nothing.
    """
    text = answer.get("text")
    if not isinstance(text, str):
        raise explain_missing("text")
    return text


def ask_status(player: int | None = None) -> Status:
    """Returns what the running driver says of itself.

    Args:
        player: the player number; None means the one of the environment.

    Raises:
        NotRunningError: no driver is running.
        DriverError: it does not answer, or its answer lacks something.
    """
    return check_status(ask("status", player=player))


def open_stream(command: str) -> tuple[Reply, socket.socket]:
    """Returns the running driver's answer, and the socket on which it goes on speaking.

    Args:
        command: ``record``: packets follow, until either end closes; ``pause_while_connected``, see
            ``program_pause``.

    Raises:
        NotRunningError: no driver is running.
        DriverError: it does not answer, or it refuses.
    """
    answer, connection = _ask_any(json.dumps({"command": command}).encode() + b"\n", PATIENCE_S)
    connection.settimeout(None)
    return answer, connection


def is_service_running() -> bool:
    """Returns whether the system's service runs, whether or not this user may ask it."""
    return is_served(SERVICE_FOLDER)


def is_served(folder: Path) -> bool:
    """Returns whether a driver listens in a folder; what a stranger has put there is none."""
    try:
        connect_to(find_socket(folder), kind=socket.SOCK_STREAM, timeout_s=REQUEST_S).close()
    except OSError:
        return False
    return True


def explain_absence(player: int | None = None) -> str:
    """Returns what to do where a player's driver does not run: it may be another's that is meant.

    Args:
        player: the player number; None means the one of the environment.
    """
    sought = player or find_player()
    playing = [
        each
        for each in map(int, PLAYERS)
        if each != sought and any(map(is_served, list_runtime_folders(each)))
    ]
    if not playing:
        return explain_start()
    names = " and ".join(f"player {each}" for each in playing)
    return f"The driver of {names} runs. For this one: {name_command(playing[0])} COMMAND"


def is_driver_running() -> bool:
    """Returns whether a driver of the environment's player runs that this user may ask."""
    try:
        ask_status()
    except DriverError:
        return False
    return True


def find_live_source() -> str:
    """Returns ``driver:`` while a driver runs that this user may ask, else ``davis:``."""
    return RUNNING_DRIVER if is_driver_running() else "davis:"


def wait_until_ended(folder: Path) -> None:
    """Waits until no driver listens in a folder any more.

    Raises:
        DriverError: it still listens after 10 s.
    """
    deadline = time.monotonic() + ENDING_S
    while is_served(folder):
        if time.monotonic() > deadline:
            raise DriverError(
                f"The driver has not ended within {ENDING_S:g} s.",
                hint=f"Its pad is released. To end it at once: kill -9 {read_pid(folder) or 'PID'}",
            )
        time.sleep(_AGAIN_S)


def read_pid(folder: Path) -> str:
    """Returns the number of a driver's process, which is in its lock; empty if it is unknown."""
    with suppress(OSError):
        return (folder / "lock").read_bytes()[:20].decode("ascii", "replace").strip()
    return ""


def _ask_any(
    question: bytes, patience_s: float, player: int | None = None
) -> tuple[Reply, socket.socket]:
    """Returns the answer of the nearest driver, and the open connection.

    Raises:
        NotRunningError: none runs.
        DriverError: it does not answer, or it refuses.
    """
    missing = []
    for folder in list_runtime_folders(player):
        try:
            return _ask_at(folder, question, patience_s)
        except NotRunningError as error:
            missing.append(error)
    absent = _join(missing)
    raise NotRunningError(absent.message, hint=explain_absence(player))


def _ask_at(folder: Path, question: bytes, patience_s: float) -> tuple[Reply, socket.socket]:
    """Returns the answer of the driver in a folder, and the open connection.

    Raises:
        NotRunningError: none is there that is to be believed.
        DriverError: it does not answer, or it refuses.
    """
    path = find_socket(folder)
    try:
        answer, connection = _ask_patiently(path, question, patience_s)
    except (StrangerError, PermissionError):
        raise NotRunningError(
            f"No driver is running. '{folder}' belongs to another user, so it was not asked.",
            hint=explain_start(),
        ) from None
    except (FileNotFoundError, NotADirectoryError, ConnectionRefusedError):
        # Nobody is there: no socket, or one that its driver has left behind.
        raise NotRunningError(NOT_RUNNING, hint=explain_start()) from None
    except TimeoutError:
        fix = "If it still starts, it takes the command when it is ready."
        if pid := read_pid(folder):
            fix += f" To end it now: kill -9 {pid}"  # one that was stopped takes no other signal
        raise DriverError("The driver does not answer.", hint=fix) from None
    except OSError as error:
        raise DriverError(f"The driver cannot be reached: {error.strerror} ({path}).") from None
    except ValueError:
        raise DriverError(f"What answers at {path} is not a driver.") from None
    if answer.get("ok") is True:
        return answer, connection
    connection.close()
    reason, hint = answer.get("error"), answer.get("hint")
    said = reason if isinstance(reason, str) else "The driver refuses and does not say why."
    raise DriverError(said, hint=hint if isinstance(hint, str) else None)


def _join(missing: Sequence[NotRunningError]) -> NotRunningError:
    """Returns the one of several that says most: that a stranger's folder was not asked."""
    return max(missing, key=lambda error: len(error.message))


def _ask_patiently(path: Path, question: bytes, patience_s: float) -> tuple[Reply, socket.socket]:
    """Returns the answer and the connection; while the driver is busy with others, asks again."""
    deadline = time.monotonic() + patience_s
    while time.monotonic() < deadline:
        with suppress(BlockingIOError):  # its queue is full
            answer, connection = _ask_once(path, question, patience_s)
            if not answer.get("busy"):
                return answer, connection
            connection.close()
        time.sleep(_AGAIN_S)
    raise TimeoutError


def _ask_once(path: Path, question: bytes, patience_s: float) -> tuple[Reply, socket.socket]:
    connection = connect_to(path, kind=socket.SOCK_STREAM, timeout_s=patience_s)
    try:
        with suppress(BrokenPipeError, ConnectionResetError):  # refused unread; the answer says why
            connection.sendall(question)
        _require_moving(connection)
        return read_answer(connection), connection
    except (OSError, ValueError, DriverError):
        connection.close()
        raise


def read_answer(connection: socket.socket) -> Reply:
    """Returns the next line that a driver sends.

    Raises:
        OSError: none comes in time.
        ValueError: it is no answer.
    """
    try:
        answer = json.loads(_read_line(connection))
    except RecursionError:
        raise ValueError from None
    if not isinstance(answer, dict):
        raise ValueError
    printable: Reply = make_value_printable(answer)
    return printable


def _require_moving(connection: socket.socket) -> None:
    """Makes sure that the driver's process was not stopped; it would answer only afterwards.

    Raises:
        DriverError: it was.
    """
    pid = find_stopped_peer(connection)
    if pid is not None:
        raise DriverError(
            "The driver was stopped, as by Ctrl-Z. It takes the command when it continues.",
            hint=f"To continue it: kill -CONT {pid}. To end it now and release its pad: "
            f"kill -9 {pid}",
        )


def _read_line(connection: socket.socket) -> bytes:
    """Returns a line of text, and not a byte more: bytes after it may be no text."""
    text = b""
    while len(text) <= LIMIT_BYTES:
        ahead = connection.recv(4096, socket.MSG_PEEK)
        piece = connection.recv(ahead.find(b"\n") + 1 or len(ahead)) if ahead else b""
        text += piece
        if not piece or text.endswith(b"\n"):
            break
    return text

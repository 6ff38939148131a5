"""The control socket: other processes send commands to the running driver, if they may."""

import errno
import fcntl
import json
import os
import socket
import stat
import threading
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, Final

from neurotouch_hid.client import LIMIT_BYTES, REQUEST_S, is_served, read_pid
from neurotouch_hid.closing import Closing
from neurotouch_hid.driver.admission import Guests, is_admitted
from neurotouch_hid.errors import AlreadyRunningError, DriverError
from neurotouch_hid.ipc import find_peer, listen_at, read_object
from neurotouch_hid.players import PLAYERS, find_socket, list_runtime_folders, name_command
from neurotouch_hid.status import Answer, Refusal

MAX_CLIENTS: Final = 12
"""A few more than those that stay: those that record, and those that have paused the driver."""

_BACKLOG: Final = 1024
"""Clients in the kernel's queue: a crowd of strangers must not fill it."""

_REFUSED_S: Final = 0.2
"""Time for which a refused user is refused again without asking logind, which would be slow."""

_BUSY: Final[Refusal] = {
    "ok": False,
    "error": "The driver is busy with other questions.",
    "busy": True,
}

Answerer = Callable[[dict[str, Any], int], Answer]
"""Answers a question of a user in the time that ``client`` promises; may be called from several
threads at once."""

Streams = Mapping[str, Callable[[socket.socket], object]]
"""Functions that go on sending after the answer, by command; each gets the socket and may be slow.
After a refusal none is called."""


class ControlSocket(Closing):
    """A UNIX socket for its owner, root and perhaps guests; it also keeps a second driver away.

    Clients wait in the queue until ``serve``. A lock file beside the socket belongs to the driver
    as long as it lives, however it ends; so a socket found by the holder of the lock is stale.

    Args:
        folder: where the socket is made; the folder too if it is not there.
        find_guests: the users who may ask as well, looked up for each question. Without, nobody
            else can even reach the socket.

    Attributes:
        has_guests: whether there may be such users.

    Raises:
        AlreadyRunningError: another driver uses this folder.
        DriverError: no socket can be made here.
    """

    def __init__(self, folder: Path, find_guests: Guests | None = None) -> None:
        self._path = find_socket(folder)
        self.has_guests = find_guests is not None
        self._find_guests = find_guests or frozenset
        self._places = threading.BoundedSemaphore(MAX_CLIENTS)
        self._refused: dict[int, float] = {}
        self._closed = False
        try:
            _prepare_folder(folder, open_to_all=find_guests is not None)
            self._lock = _take_lock(folder / "lock")
            try:
                self._listener = listen_at(
                    self._path,
                    kind=socket.SOCK_STREAM,
                    open_to_all=find_guests is not None,
                    backlog=_BACKLOG,
                )
                self._listener.setblocking(True)  # a thread of its own waits for clients
            except OSError:
                os.close(self._lock)
                raise
        except OSError as error:
            reason = error.strerror or str(error)
            raise DriverError(f"No control socket can be made in {folder}: {reason}.") from error

    def admits(self, uid: int) -> bool:
        """Returns True if a user may ask, see ``is_admitted``."""
        return is_admitted(uid, self._find_guests)

    def serve(self, answer: Answerer, streams: Streams | None = None) -> None:
        """Starts to answer questions, each in a thread of its own."""
        self._answer, self._streams = answer, streams or {}
        threading.Thread(target=self._accept, name="control socket", daemon=True).start()

    def close(self) -> None:
        """Removes the socket. A second call does nothing."""
        if self._closed:
            return
        self._closed = True
        self._path.unlink(missing_ok=True)
        with suppress(OSError):
            self._listener.shutdown(socket.SHUT_RDWR)  # wakes the thread that accepts
        self._listener.close()
        os.close(self._lock)

    def _accept(self) -> None:
        while not self._closed:
            try:
                client, _ = self._listener.accept()
            except OSError as error:
                if error.errno not in (errno.EMFILE, errno.ENFILE, errno.ENOMEM, errno.ENOBUFS):
                    return
                time.sleep(0.1)  # too many files are open: the next one may find a place
                continue
            uid = find_peer(client)
            if not self._admits_quickly(uid):
                _refuse(client, _fail("This driver belongs to another user."))
            elif not self._begin(client, uid):
                _refuse(client, _BUSY)

    def _admits_quickly(self, uid: int) -> bool:
        """Returns the same as ``admits``, where a refusal stands for a moment."""
        now_s = time.monotonic()
        if now_s < self._refused.get(uid, 0.0):
            return False
        if self.admits(uid):
            return True
        self._refused[uid] = now_s + _REFUSED_S
        return False

    def _begin(self, client: socket.socket, uid: int) -> bool:
        """Talks to a client in a thread; False if there is no place for it, or no thread."""
        if not self._places.acquire(blocking=False):
            return False
        try:
            threading.Thread(
                target=self._talk, args=(client, uid), name="control client", daemon=True
            ).start()
        except RuntimeError:  # this machine gives no more of them just now
            self._places.release()
            return False
        return True

    def _talk(self, client: socket.socket, uid: int) -> None:
        try:
            with client:
                question = _read_question(client)
                stream = None
                if isinstance(question, str):
                    answer: Answer = _fail(question)
                else:
                    answer = self._answer(question, uid)
                    if answer.get("ok"):
                        stream = self._streams.get(question["command"])
                client.settimeout(REQUEST_S)
                client.sendall(_encode(answer))
                if stream is not None:
                    stream(client)
        except OSError:
            pass  # the client is gone; its command has been carried out
        finally:
            self._places.release()


def refuse_second(folder: Path) -> None:
    """Refuses a second driver before anything is loaded for it.

    Only the lock that ``ControlSocket`` takes is sure: another may begin in the meantime.

    Raises:
        AlreadyRunningError: a driver listens in this folder.
    """
    if not is_served(folder):
        return
    if folder.lstat().st_uid != os.geteuid():
        raise _refuse_other_user()
    raise _name_running(folder)


def _refuse_other_user() -> AlreadyRunningError:
    """Returns the error about a driver of another user."""
    return AlreadyRunningError(
        "The driver is already running, as another user.",
        hint="See what it does: neurotouch status. If it is the service, end it: "
        "sudo systemctl stop neurotouch",
    )


def _name_running(folder: Path) -> AlreadyRunningError:
    """Returns the error that names the process of the driver in a folder."""
    players = map(int, PLAYERS)
    player = next((n for n in players if folder in list_runtime_folders(n)), 1)
    command = name_command(player)
    return AlreadyRunningError(
        f"The driver is already running (PID {read_pid(folder) or 'unknown'}).",
        hint=f"Ask it: {command} status. End it: {command} stop",
    )


def _prepare_folder(folder: Path, *, open_to_all: bool) -> None:
    """Makes the folder if need be; nobody else may reach into it unless it is open to all.

    Raises:
        AlreadyRunningError: it belongs to another user, whose driver runs.
        DriverError: it belongs to another user.
    """
    mode = 0o755 if open_to_all else 0o700
    folder.mkdir(mode=mode, exist_ok=True)
    found = folder.lstat()
    if not stat.S_ISDIR(found.st_mode) or found.st_uid != os.geteuid():
        if is_served(folder):
            raise _refuse_other_user()
        raise DriverError(f"'{folder}' is not owned by you, so no control socket is made there.")
    if stat.S_IMODE(found.st_mode) != mode:
        folder.chmod(mode)


def _take_lock(path: Path) -> int:
    """Returns a descriptor that holds the lock until it is closed; its file says who has it.

    Raises:
        AlreadyRunningError: another driver has it.
    """
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW, 0o600)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(descriptor)
        raise _name_running(path.parent) from None
    os.ftruncate(descriptor, 0)
    os.write(descriptor, f"{os.getpid()}\n".encode())
    return descriptor


def _read_question(client: socket.socket) -> dict[str, Any] | str:
    """Returns the question, or a sentence about its fault."""
    deadline = time.monotonic() + REQUEST_S
    text = b""
    while b"\n" not in text:
        left_s = deadline - time.monotonic()
        if left_s <= 0:
            return f"The question was not complete within {REQUEST_S:g} s."
        client.settimeout(left_s)
        try:
            piece = client.recv(4096)
        except TimeoutError:
            continue
        if not piece:
            break
        text += piece
        if len(text) > LIMIT_BYTES:
            return f"The question is longer than {LIMIT_BYTES // 1024} kB."
    question = read_object(text.split(b"\n", 1)[0])
    if question is None or not isinstance(question.get("command"), str):
        return "The question is no line with a JSON object that has a 'command'."
    return question


def _refuse(client: socket.socket, reply: Answer) -> None:
    with client, suppress(OSError):
        client.setblocking(False)
        client.send(_encode(reply))


def _fail(error: str) -> Refusal:
    return {"ok": False, "error": error}


def _encode(reply: Answer) -> bytes:
    return json.dumps(reply).encode() + b"\n"

"""The control socket: other processes of the same person tell the running driver what to do."""

import errno
import fcntl
import json
import os
import socket
import stat
import struct
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Any, Final, Self

from neurotouch_hid.driver import LIMIT_BYTES, REQUEST_S, Answer, find_socket
from neurotouch_hid.errors import AlreadyRunningError, DriverError

MAX_CLIENTS: Final = 8

_CREDENTIALS: Final = struct.Struct("3i")  # pid, uid, gid
_BACKLOG: Final = 64

Answerer = Callable[[dict[str, Any]], Answer]
"""Answers a question within ``REQUEST_S``; may be called from several threads at once."""


class ControlSocket:
    """A UNIX socket that only its owner and root can use; it also keeps a second driver away.

    Clients wait in the queue until ``serve``. A lock file beside the socket belongs to the driver
    as long as it lives, however it ends; so a socket found by the holder of the lock is stale.

    Args:
        folder: where the socket is made; the folder too if it is not there.

    Raises:
        AlreadyRunningError: another driver uses this folder.
        DriverError: no socket can be made here.
    """

    def __init__(self, folder: Path) -> None:
        self._path = find_socket(folder)
        self._places = threading.BoundedSemaphore(MAX_CLIENTS)
        self._closed = False
        try:
            _prepare_folder(folder)
            self._lock = _take_lock(folder / "lock")
            try:
                self._listener = _listen(self._path)
            except OSError:
                os.close(self._lock)
                raise
        except OSError as error:
            reason = error.strerror or str(error)
            raise DriverError(f"No control socket can be made in {folder}: {reason}.") from error

    def serve(self, answer: Answerer) -> None:
        """From now on questions are answered, each in a thread of its own."""
        threading.Thread(
            target=self._accept, args=(answer,), name="control socket", daemon=True
        ).start()

    def close(self) -> None:
        """Takes the socket away. Harmless when repeated."""
        if self._closed:
            return
        self._closed = True
        self._path.unlink(missing_ok=True)
        with suppress(OSError):
            self._listener.shutdown(socket.SHUT_RDWR)  # wakes the thread that accepts
        self._listener.close()
        os.close(self._lock)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def _accept(self, answer: Answerer) -> None:
        while not self._closed:
            try:
                client, _ = self._listener.accept()
            except OSError as error:
                if error.errno not in (errno.EMFILE, errno.ENFILE, errno.ENOMEM, errno.ENOBUFS):
                    return
                time.sleep(0.1)  # too many files are open: the next one may find a place
                continue
            uid = _CREDENTIALS.unpack(
                client.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _CREDENTIALS.size)
            )[1]
            if uid not in (os.geteuid(), 0):
                _refuse(client, _fail("This driver belongs to another user."))
            elif not self._places.acquire(blocking=False):
                _refuse(client, _fail("The driver is busy with other questions.", busy=True))
            else:
                threading.Thread(
                    target=self._talk, args=(client, answer), name="control client", daemon=True
                ).start()

    def _talk(self, client: socket.socket, answer: Answerer) -> None:
        try:
            with client:
                said = _read_question(client)
                reply = answer(said) if isinstance(said, dict) else _fail(said)
                client.settimeout(REQUEST_S)
                client.sendall(_encode(reply))
        except OSError:
            pass  # the client is gone; what it asked for has been done
        finally:
            self._places.release()


def _prepare_folder(folder: Path) -> None:
    """Makes the folder if need be; nobody else may reach into it.

    Raises:
        DriverError: it is somebody else's.
    """
    folder.mkdir(mode=0o700, exist_ok=True)
    found = folder.lstat()
    if not stat.S_ISDIR(found.st_mode) or found.st_uid != os.geteuid():
        raise DriverError(f"{folder} is no folder of yours, so no control socket is made there.")
    if stat.S_IMODE(found.st_mode) & 0o077:
        folder.chmod(0o700)


def _take_lock(path: Path) -> int:
    """A descriptor that holds the lock until it is closed; its file says who has it.

    Raises:
        AlreadyRunningError: another driver has it.
    """
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW, 0o600)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        pid = os.read(descriptor, 20).decode("ascii", "replace").strip()
        os.close(descriptor)
        raise AlreadyRunningError(
            f"The driver is already running (PID {pid or 'unknown'}).",
            hint=f"Ask it: neurotouch status. End it: kill {pid or 'PID'}",
        ) from None
    os.ftruncate(descriptor, 0)
    os.write(descriptor, f"{os.getpid()}\n".encode())
    return descriptor


def _listen(path: Path) -> socket.socket:
    """A listening socket at the path, instead of what a killed driver has left there."""
    listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    try:
        path.unlink(missing_ok=True)
        listener.bind(str(path))
        path.chmod(0o600)
        listener.listen(_BACKLOG)
    except OSError:
        listener.close()
        raise
    return listener


def _read_question(client: socket.socket) -> dict[str, Any] | str:
    """What is asked, or what is wrong with it."""
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
    try:
        question = json.loads(text.split(b"\n", 1)[0])
    except (ValueError, RecursionError):
        return "The question is not a line of JSON."
    if not isinstance(question, dict) or not isinstance(question.get("command"), str):
        return "The question is no JSON object with a 'command'."
    return question


def _refuse(client: socket.socket, reply: Answer) -> None:
    with client, suppress(OSError):
        client.setblocking(False)
        client.send(_encode(reply))


def _fail(error: str, **more: bool) -> Answer:
    return {"ok": False, "error": error, **more}


def _encode(reply: Answer) -> bytes:
    return json.dumps(reply).encode() + b"\n"

"""Unix sockets between the driver and the processes that watch it or command it."""

import errno
import json
import os
import socket
import stat
import struct
from pathlib import Path
from typing import Any, Final

FEED: Final = "feed"
HAND: Final = "hand"
"""What the sockets are called in a driver's folder."""

_MOST_DIGITS: Final = 15
"""Of a whole number in a message; a longer one is read as a float, which may be infinite."""

_TCP: Final = Path("/proc/net/tcp")
_ESTABLISHED: Final = "01"

_CREDENTIALS: Final = struct.Struct("3i")  # pid, uid, gid


def listen_at(
    path: Path,
    *,
    kind: socket.SocketKind = socket.SOCK_SEQPACKET,
    open_to_all: bool = False,
    backlog: int = 8,
) -> socket.socket:
    """Returns a non-blocking listening socket; it replaces one that a killed driver has left.

    Args:
        path: where; its folder's mode keeps others away.
        kind: whole messages, or a stream.
        open_to_all: every user can connect; the listener must then check each user.
        backlog: how many may wait for ``accept``.

    Raises:
        OSError: it cannot be made.
    """
    listener = socket.socket(socket.AF_UNIX, kind)
    try:
        path.unlink(missing_ok=True)
        listener.bind(str(path))
        path.chmod(0o666 if open_to_all else 0o600)
        listener.listen(backlog)
        listener.setblocking(False)
    except OSError:
        listener.close()
        raise
    return listener


class StrangerError(ConnectionRefusedError):
    """A folder, or the process that listens in it, belongs to a user who is not to be believed."""


def connect_to(
    path: Path, *, kind: socket.SocketKind = socket.SOCK_SEQPACKET, timeout_s: float = 0.0
) -> socket.socket:
    """Returns a connection to such a socket, if the user who listens there is to be believed.

    Args:
        path: the socket, in the driver's folder.
        kind: as it was made.
        timeout_s: for how long the connection may wait; 0: it never waits.

    Raises:
        StrangerError: another user may have made it.
        OSError: nobody listens there.
    """
    believed = find_believed(path.parent)
    if not believed:
        raise StrangerError(errno.ECONNREFUSED, os.strerror(errno.ECONNREFUSED))
    peer = socket.socket(socket.AF_UNIX, kind)
    try:
        peer.settimeout(timeout_s)
        peer.connect(str(path))
        if find_peer(peer) not in believed:
            raise StrangerError(errno.ECONNREFUSED, os.strerror(errno.ECONNREFUSED))
    except OSError:
        peer.close()
        raise
    return peer


def find_believed(folder: Path) -> frozenset[int]:
    """Returns the users whose word counts in a driver's folder; none in a stranger's.

    In ``/tmp`` anybody can make a folder first. So the folder must be ours or root's. The service's
    folder has another owner, but it is in ``/run``, where only root makes folders.

    Raises:
        OSError: there is no such folder, or it cannot be reached.
    """
    ours = {os.geteuid(), 0}
    found = folder.lstat()
    if not stat.S_ISDIR(found.st_mode):
        return frozenset()
    if found.st_uid in ours:
        return frozenset(ours)
    above = folder.parent.stat()
    is_made_by_root = above.st_uid == 0 and not above.st_mode & (stat.S_IWGRP | stat.S_IWOTH)
    return frozenset({*ours, found.st_uid}) if is_made_by_root else frozenset()


def find_peer(peer: socket.socket) -> int:
    """Returns the user of the process at the other end, as the kernel knows it."""
    credentials = peer.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _CREDENTIALS.size)
    uid: int = _CREDENTIALS.unpack(credentials)[1]
    return uid


def find_stopped_peer(peer: socket.socket) -> int | None:
    """Returns the process that listens at the other end, if it was stopped, as by Ctrl-Z."""
    credentials = peer.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _CREDENTIALS.size)
    pid: int = _CREDENTIALS.unpack(credentials)[0]
    try:
        state = Path(f"/proc/{pid}/stat").read_bytes().rpartition(b") ")[2][:1]
    except OSError:  # it is another machine's, or hidden from us
        return None
    return pid if state in (b"T", b"t") else None


def is_own_peer(peer: socket.socket) -> bool:
    """Returns True if the process at the other end is ours or root's."""
    return find_peer(peer) in (os.geteuid(), 0)


def read_object(text: str | bytes) -> dict[str, Any] | None:
    """Returns the JSON object that another process has sent; None if it is none.

    No whole number in it is too large for arithmetic with floats, which would raise OverflowError.
    """
    try:
        said = json.loads(text, parse_int=_read_int)
    except (ValueError, RecursionError):
        return None
    return said if isinstance(said, dict) else None


def _read_int(digits: str) -> int | float:
    return int(digits) if len(digits) <= _MOST_DIGITS else float(digits)


def find_tcp_user(end: tuple[str, int], other_end: tuple[str, int]) -> int | None:
    """Returns the user whose process has one end of a connection within this machine.

    Args:
        end: the address and port of that end, by IPv4.
        other_end: the same of the other one.

    Returns:
        The user as the kernel knows it; None if it does not say.
    """
    try:
        looked_for = [_write_end(*end[:2]), _write_end(*other_end[:2]), _ESTABLISHED]
        rows = _TCP.read_text().splitlines()[1:]
    except OSError:  # an address of another kind, or a machine without this file
        return None
    return next((int(row[7]) for row in map(str.split, rows) if row[1:4] == looked_for), None)


def _write_end(address: str, port: int) -> str:
    """Returns one end of a connection as the kernel writes it."""
    (number,) = struct.unpack("=I", socket.inet_aton(address))
    return f"{number:08X}:{port:04X}"

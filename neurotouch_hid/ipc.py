"""Unix sockets between the driver and the processes that watch it or command it."""

import os
import socket
import struct
from pathlib import Path
from typing import Final

FEED: Final = "feed"
HAND: Final = "hand"
"""What the sockets are called in a driver's folder."""

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


def connect_to(path: Path) -> socket.socket:
    """Returns a connection to such a socket that never waits.

    Raises:
        OSError: no program listens there.
    """
    peer = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    try:
        peer.setblocking(False)
        peer.connect(str(path))
    except OSError:
        peer.close()
        raise
    return peer


def find_peer(peer: socket.socket) -> int:
    """Returns the user of the process at the other end, as the kernel knows it."""
    credentials = peer.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _CREDENTIALS.size)
    uid: int = _CREDENTIALS.unpack(credentials)[1]
    return uid


def is_own_peer(peer: socket.socket) -> bool:
    """Returns True if the process at the other end is ours or root's."""
    return find_peer(peer) in (os.geteuid(), 0)

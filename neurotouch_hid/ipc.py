"""Unix sockets between the line and the processes that watch or lead a simulated hand."""

import os
import socket
import struct
from pathlib import Path
from typing import Final

FEED: Final = "feed"
HAND: Final = "hand"
"""What the sockets are called in a driver's folder."""

_CREDENTIALS: Final = struct.Struct("3i")  # pid, uid, gid


def listen_at(path: Path, *, open_to_all: bool = False) -> socket.socket:
    """A listening socket for whole messages, instead of one that a killed driver has left there.

    Args:
        path: where; its folder's mode keeps others away.
        open_to_all: let everybody reach it; then who may stay is for the listener to say.

    Raises:
        OSError: it cannot be made.
    """
    listener = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    try:
        path.unlink(missing_ok=True)
        listener.bind(str(path))
        path.chmod(0o666 if open_to_all else 0o600)
        listener.listen(8)
        listener.setblocking(False)
    except OSError:
        listener.close()
        raise
    return listener


def connect_to(path: Path) -> socket.socket:
    """A connection to such a socket that never waits.

    Raises:
        OSError: nobody listens there.
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
    """The user of the process at the other end, as the kernel knows it."""
    credentials = peer.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _CREDENTIALS.size)
    uid: int = _CREDENTIALS.unpack(credentials)[1]
    return uid


def is_own_peer(peer: socket.socket) -> bool:
    """True if the process at the other end is ours or root's."""
    return find_peer(peer) in (os.geteuid(), 0)

"""Asks Wayland compositors with a control socket for the active window."""

import json
import socket
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

from neurotouch_hid.errors import DesktopError

_PATIENCE_S: Final = 1.0
_LONGEST_BYTES: Final = 16 * 1024 * 1024  # a tree of some thousand windows

_MAGIC: Final = b"i3-ipc"
_HEADER: Final = struct.Struct("=6sII")  # magic, length of the payload, type
_GET_TREE: Final = 4


class Sway:
    """sway, or i3, by its IPC: see sway-ipc(7).

    Args:
        path: ``$SWAYSOCK``.
    """

    desktop = "sway"
    fd: int | None = None

    def __init__(self, path: str) -> None:
        self._path = path

    def names(self) -> tuple[str, ...]:
        """Returns the focused window's ``app_id``, or class and instance of an X11 program."""
        request = _HEADER.pack(_MAGIC, 0, _GET_TREE)
        with _connect(self._path, self.desktop) as connection:
            tree = _parse(_exchange_framed(connection, request, self.desktop), self.desktop)
        for node in _walk(tree):
            if node.get("focused") is True:
                inner = node.get("window_properties") or {}
                found = (node.get("app_id"), inner.get("class"), inner.get("instance"))
                return tuple(name for name in found if isinstance(name, str) and name)
        return ()

    def close(self) -> None:
        """Does nothing: nothing stays open between two calls."""


class Hyprland:
    """Hyprland by its control socket, which closes after each answer.

    Args:
        runtime: ``$XDG_RUNTIME_DIR``.
        signature: ``$HYPRLAND_INSTANCE_SIGNATURE``.
    """

    desktop = "Hyprland"
    fd: int | None = None

    def __init__(self, runtime: str, signature: str) -> None:
        self._path = str(Path(runtime) / "hypr" / signature / ".socket.sock")

    def names(self) -> tuple[str, ...]:
        """Returns the active window's class, now and as it was opened."""
        with _connect(self._path, self.desktop) as connection:
            text = _exchange(connection, b"j/activewindow", self.desktop)
        window = _parse(text, self.desktop)
        found = (window.get("class"), window.get("initialClass"))
        return tuple(dict.fromkeys(name for name in found if isinstance(name, str) and name))

    def close(self) -> None:
        """Does nothing: nothing stays open between two calls."""


def _connect(path: str, desktop: str) -> socket.socket:
    connection = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    connection.settimeout(_PATIENCE_S)
    try:
        connection.connect(path)
    except OSError as error:
        connection.close()
        raise DesktopError(
            f"The desktop {desktop} cannot be reached: {error.strerror or error}."
        ) from None
    return connection


def _exchange(connection: socket.socket, request: bytes, desktop: str) -> bytes:
    """Returns the answer up to the end of the connection."""
    text = b""
    try:
        connection.sendall(request)
        while (piece := connection.recv(65536)) and len(text) <= _LONGEST_BYTES:
            text += piece
    except OSError as error:
        raise DesktopError(
            f"The desktop {desktop} does not answer: {error.strerror or error}."
        ) from None
    return text


def _exchange_framed(connection: socket.socket, request: bytes, desktop: str) -> bytes:
    """Returns the payload of the answer."""
    try:
        connection.sendall(request)
        magic, length, _ = _HEADER.unpack(_receive(connection, _HEADER.size))
        if magic != _MAGIC or length > _LONGEST_BYTES:
            raise DesktopError(f"The answer at the socket of {desktop} is in another format.")
        return _receive(connection, length)
    except OSError as error:
        raise DesktopError(
            f"The desktop {desktop} does not answer: {error.strerror or error}."
        ) from None


def _receive(connection: socket.socket, n_bytes: int) -> bytes:
    text = b""
    while len(text) < n_bytes:
        piece = connection.recv(n_bytes - len(text))
        if not piece:
            raise ConnectionResetError("the connection has ended")
        text += piece
    return text


def _parse(text: bytes, desktop: str) -> dict[str, Any]:
    try:
        found = json.loads(text or b"{}")
    except (ValueError, RecursionError):
        raise DesktopError(f"The answer of {desktop} cannot be read.") from None
    return found if isinstance(found, dict) else {}


def _walk(node: dict[str, Any]) -> Iterator[dict[str, Any]]:
    waiting = [node]
    while waiting:
        node = waiting.pop()
        yield node
        for key in ("nodes", "floating_nodes"):
            waiting += [inner for inner in node.get(key) or () if isinstance(inner, dict)]

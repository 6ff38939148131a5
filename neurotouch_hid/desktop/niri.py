"""The active window of niri, by the stream of events at its socket."""

import json
import select
import socket
from pathlib import Path
from typing import Any, Final

from neurotouch_hid.errors import DesktopError

_PATIENCE_S: Final = 1.0
_LONGEST_BYTES: Final = 16 * 1024 * 1024  # an event that lists some thousand windows


class Niri:
    """niri by its IPC: one line of JSON for each event.

    Args:
        path: ``$NIRI_SOCKET``. A niri that was started again has another; the newest beside it is
            taken then.

    Attributes:
        desktop: name of the desktop.
        fd: becomes readable when a window changes.

    Raises:
        DesktopError: niri cannot be reached.
    """

    desktop = "niri"

    def __init__(self, path: str) -> None:
        self._received = b""
        self._app_ids: dict[int, str] = {}
        self._focused: int | None = None
        self._is_told = False  # of the windows that were open when we came
        self._peer = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM | socket.SOCK_CLOEXEC)
        self._peer.settimeout(_PATIENCE_S)
        try:
            self._peer.connect(_find_socket(Path(path)))
            self._peer.sendall(b'"EventStream"\n')
        except OSError as error:
            self._peer.close()
            raise DesktopError(
                f"The desktop niri cannot be reached: {error.strerror or error}."
            ) from None
        self.fd: int | None = self._peer.fileno()

    def names(self) -> tuple[str, ...]:
        """Returns the application id of the focused window."""
        while select.select([self._peer], [], [], 0.0 if self._is_told else _PATIENCE_S)[0]:
            self._receive()
        name = self._app_ids.get(self._focused, "") if self._focused is not None else ""
        return (name,) if name else ()

    def close(self) -> None:
        """Ends the connection."""
        self._peer.close()

    def _receive(self) -> None:
        try:
            piece = self._peer.recv(65536)
        except OSError as error:
            raise DesktopError(
                f"The desktop niri does not answer: {error.strerror or error}."
            ) from None
        if not piece or len(self._received) > _LONGEST_BYTES:
            raise DesktopError("The desktop niri has closed the connection.")
        *lines, self._received = (self._received + piece).split(b"\n")
        for line in lines:
            self._hear(line)

    def _hear(self, line: bytes) -> None:
        try:
            message = json.loads(line)
        except (ValueError, RecursionError):
            raise DesktopError("The answer of niri cannot be read.") from None
        for name, event in message.items() if isinstance(message, dict) else ():
            if name == "Err":
                raise DesktopError("This niri tells no events; it is older than 0.1.9.")
            if isinstance(event, dict):
                self._hear_event(name, event)

    def _hear_event(self, name: str, event: dict[str, Any]) -> None:
        if name == "WindowsChanged":
            self._app_ids.clear()
            self._focused = None
            self._is_told = True
            windows = event.get("windows")
            for window in windows if isinstance(windows, list) else ():
                self._add(window)
        elif name == "WindowOpenedOrChanged":
            self._add(event.get("window"))
        elif name == "WindowClosed":
            number = event.get("id")
            if isinstance(number, int):
                self._app_ids.pop(number, None)
            if number == self._focused:
                self._focused = None
        elif name == "WindowFocusChanged":
            number = event.get("id")
            self._focused = number if isinstance(number, int) else None

    def _add(self, window: object) -> None:
        """Keeps the window's application id; its title is not read."""
        if not isinstance(window, dict) or not isinstance(window.get("id"), int):
            return
        name = window.get("app_id")
        self._app_ids[window["id"]] = name if isinstance(name, str) else ""
        if window.get("is_focused") is True:
            self._focused = window["id"]
        elif self._focused == window["id"]:
            self._focused = None


def _find_socket(path: Path) -> str:
    """Returns this socket, or the newest of niri in its folder if it is gone."""
    found = [path] if path.exists() else sorted(path.parent.glob("niri.*.sock"), key=_date)
    return str(found[-1] if found else path)


def _date(path: Path) -> int:
    try:
        return path.stat().st_mtime_ns
    except OSError:
        return 0

"""Receives the newest state of the running driver, also of one that starts later."""

import socket
from contextlib import suppress
from pathlib import Path
from typing import Final

from neurotouch_hid.closing import Closing
from neurotouch_hid.ipc import FEED, connect_to
from neurotouch_hid.players import list_runtime_folders

LARGEST_BYTES: Final = 64 * 1024
MOST_HZ: Final = 60
"""So many states a second a driver sends at most."""


class Subscriber(Closing):
    """Connects to the running driver and returns its newest state; never waits.

    Args:
        player: the player number; None takes it from the environment.

    Attributes:
        peer: the connection, or None while no driver runs.
        hz: how many states a second are asked for.
    """

    def __init__(self, player: int | None = None) -> None:
        self._player = player
        self.peer: socket.socket | None = None
        self._folder: Path | None = None  # of the driver at the other end
        self.hz = 0

    def connect(self) -> socket.socket | None:
        """Connects to a driver; returns the connection, or None if none runs.

        The person's own driver takes the place of the service, as it does for commands.
        """
        for folder in list_runtime_folders(self._player):
            if folder == self._folder:
                break
            with suppress(OSError):
                peer = connect_to(folder / FEED)
                self.close()
                self.peer, self._folder = peer, folder
                self._tell()
                break
        return self.peer

    def want(self, hz: int) -> None:
        """Requests ``hz`` states a second; 0 for none."""
        if hz != self.hz:
            self.hz = hz
            self._tell()

    def take(self) -> bytes | None:
        """Returns the newest state that has arrived since the last call, or None."""
        newest = None
        while self.peer is not None:
            try:
                state = self.peer.recv(LARGEST_BYTES)
            except BlockingIOError:
                return newest
            except OSError:
                state = b""
            if not state:  # the driver has ended
                self.close()
                return newest
            newest = state
        return newest

    def close(self) -> None:
        """Disconnects; the driver then no longer sends."""
        if self.peer is not None:
            self.peer.close()
            self.peer = self._folder = None

    def _tell(self) -> None:
        if self.peer is not None:
            with suppress(OSError):  # it has ended, which the next call will notice
                self.peer.send(str(self.hz).encode())

"""The line's end of the feed: its newest state to whoever listens, and nothing it waits for."""

import os
import selectors
import socket
import threading
import time
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Final

from neurotouch_hid.closing import Closing
from neurotouch_hid.errors import DriverError
from neurotouch_hid.ipc import FEED, find_peer, listen_at
from neurotouch_hid.messages import Step
from neurotouch_hid.monitor.encoder import Sample, StateEncoder

MOST_HZ: Final = 60
MOST_LISTENERS: Final = 8
KEPT_BYTES: Final = 16 * 1024
"""Of the kernel's buffer for each listener: a few states, so that one who was asleep does not have
to catch up; the largest state is a third of it."""


class Publisher(Closing):
    """A tap that shows its Steps on a Unix socket; a context manager.

    Whoever connects says how many states a second it wants, as a number in ASCII, at any time; the
    line gives as many as the keenest asks for, 60 at most. A state that a listener has no room for
    is dropped. While nobody wants anything, the tap returns at once.

    The line's thread only leaves a shot; a thread beside it writes and sends.

    Args:
        folder: where the socket is made; the driver's own.
        observer: puts states in bytes.
        admits: which other users may watch, by uid; the service lets in who sits at the machine.
            Without, nobody else can even reach the socket.

    Raises:
        DriverError: no socket can be made there.
    """

    def __init__(
        self, folder: Path, observer: StateEncoder, admits: Callable[[int], bool] | None = None
    ) -> None:
        self._observer = observer
        self._admits = admits or (lambda uid: uid in (os.geteuid(), 0))
        self._path = folder / FEED
        try:
            self._listener = listen_at(self._path, open_to_all=admits is not None)
        except OSError as error:
            raise DriverError(
                f"The live view cannot be served: {error.strerror} ({self._path})."
            ) from error
        self._period_s = 0.0  # 0: nobody wants anything
        self._due_s = 0.0
        self._shots: deque[Sample] = deque(maxlen=1)  # the newest wins
        self._bell = os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC)
        self._done = False
        self._wants: dict[socket.socket, int] = {}
        self._thread = threading.Thread(target=self._work, name="feed", daemon=True)
        self._thread.start()

    def __call__(self, step: Step) -> None:
        """Leaves a shot of ``step`` if it is time for one."""
        self._observer.count(step)
        if not self._period_s:
            return
        now = time.monotonic()
        if now < self._due_s:
            return
        self._due_s = max(self._due_s + self._period_s, now)
        self._shots.append(self._observer.take(step))
        os.eventfd_write(self._bell, 1)

    def close(self) -> None:
        """Takes the socket away. Harmless when repeated."""
        if self._done:
            return
        self._done = True
        os.eventfd_write(self._bell, 1)
        self._thread.join()
        self._path.unlink(missing_ok=True)
        os.close(self._bell)

    def _work(self) -> None:
        with selectors.DefaultSelector() as selector:
            selector.register(self._listener, selectors.EVENT_READ)
            selector.register(self._bell, selectors.EVENT_READ)
            while not self._done:
                for key, _ in selector.select():
                    if key.fileobj is self._listener:
                        self._admit(selector)
                    elif key.fileobj == self._bell:
                        self._send()
                    elif isinstance(key.fileobj, socket.socket):
                        self._hear(key.fileobj, selector)
        self._listener.close()
        for peer in self._wants:
            peer.close()
        self._wants.clear()

    def _admit(self, selector: selectors.BaseSelector) -> None:
        with suppress(OSError):  # it has gone again, or no file is free
            peer, _ = self._listener.accept()
            if not self._admits(find_peer(peer)) or len(self._wants) >= MOST_LISTENERS:
                peer.close()
                return
            peer.setblocking(False)
            peer.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, KEPT_BYTES)
            self._wants[peer] = 0
            selector.register(peer, selectors.EVENT_READ)

    def _hear(self, peer: socket.socket, selector: selectors.BaseSelector) -> None:
        try:
            said = peer.recv(16)
        except BlockingIOError:
            return
        except OSError:
            said = b""
        if said.isdigit():
            self._wants[peer] = min(int(said), MOST_HZ)
        else:  # it has gone, or talks nonsense
            selector.unregister(peer)
            del self._wants[peer]
            peer.close()
        keenest_hz = max(self._wants.values(), default=0)
        self._period_s = 1.0 / keenest_hz if keenest_hz else 0.0

    def _send(self) -> None:
        os.eventfd_read(self._bell)
        if self._done or not self._shots:
            return
        state = self._observer.encode(self._shots.pop())
        for peer, hz in self._wants.items():
            if hz:
                with suppress(OSError):  # no room: this state is dropped; or gone, as it will say
                    peer.send(state)

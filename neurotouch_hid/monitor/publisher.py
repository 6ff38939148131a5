"""Publishes the newest state of the pipeline to its subscribers, and never waits for them."""

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
from neurotouch_hid.subscriber import MOST_HZ

MOST_SUBSCRIBERS: Final = 8
AGAIN_S: Final = 1.0
"""Interval at which it checks whether subscribers may still watch: a person may have left."""
KEPT_BYTES: Final = 16 * 1024
"""Of the kernel's buffer for each subscriber: a few states, so that one that was slow has little to
catch up; the largest state is a third of it."""


class Publisher(Closing):
    """A tap that publishes steps on a Unix socket; a context manager.

    A subscriber can request a rate at any time, in states per second, as a number in ASCII. All get
    the highest of these rates, 60 at most. If a subscriber's buffer is full, its state is dropped.
    While no subscriber requests states, the tap returns immediately.

    The pipeline's thread only takes a sample; another thread encodes and sends it.

    Args:
        folder: the driver's own; the socket is made there.
        encoder: encodes the states.
        admits: returns True for each other user, by uid, that may watch; called again every second.
            The service admits the person at the machine. If None, other users cannot reach the
            socket.

    Raises:
        DriverError: no socket can be made there.
    """

    def __init__(
        self, folder: Path, encoder: StateEncoder, admits: Callable[[int], bool] | None = None
    ) -> None:
        self._encoder = encoder
        self._admits = admits or (lambda uid: uid in (os.geteuid(), 0))
        self._path = folder / FEED
        try:
            self._listener = listen_at(self._path, open_to_all=admits is not None)
        except OSError as error:
            raise DriverError(
                f"The live view cannot be served: {error.strerror} ({self._path})."
            ) from error
        self._period_s = 0.0  # 0: no subscriber wants anything
        self._due_s = 0.0
        self._samples: deque[Sample] = deque(maxlen=1)  # the newest wins
        self._bell = os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC)
        self._done = False
        self._wants: dict[socket.socket, int] = {}
        self._users: dict[socket.socket, int] = {}
        self._look_s = 0.0
        self._thread = threading.Thread(target=self._work, name="feed", daemon=True)
        self._thread.start()

    def __call__(self, step: Step) -> None:
        """Takes a sample of ``step`` if it is time for one."""
        if not self._period_s:
            return
        now = time.monotonic()
        if now < self._due_s:
            return
        self._due_s = max(self._due_s + self._period_s, now)
        self._samples.append(self._encoder.take(step))
        os.eventfd_write(self._bell, 1)

    def close(self) -> None:
        """Removes the socket. A second call does nothing."""
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
                        self._send(selector)
                    elif isinstance(key.fileobj, socket.socket):
                        self._hear(key.fileobj, selector)
        self._listener.close()
        for peer in self._wants:
            peer.close()
        self._wants.clear()

    def _admit(self, selector: selectors.BaseSelector) -> None:
        with suppress(OSError):  # it has gone again, or no file is free
            peer, _ = self._listener.accept()
            user = find_peer(peer)
            if not self._admits(user) or len(self._wants) >= MOST_SUBSCRIBERS:
                peer.close()
                return
            peer.setblocking(False)
            peer.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, KEPT_BYTES)
            self._wants[peer], self._users[peer] = 0, user
            selector.register(peer, selectors.EVENT_READ)

    def _hear(self, peer: socket.socket, selector: selectors.BaseSelector) -> None:
        if peer not in self._wants:  # just turned away
            return
        try:
            said = peer.recv(16)
        except BlockingIOError:
            return
        except OSError:
            said = b""
        if said.isdigit():
            self._wants[peer] = min(int(said), MOST_HZ)
        else:  # it has gone, or sent no number
            self._drop(peer, selector)
        self._set_rate()

    def _drop(self, peer: socket.socket, selector: selectors.BaseSelector) -> None:
        selector.unregister(peer)
        del self._wants[peer], self._users[peer]
        peer.close()

    def _set_rate(self) -> None:
        highest_hz = max(self._wants.values(), default=0)
        self._period_s = 1.0 / highest_hz if highest_hz else 0.0

    def _turn_away(self, selector: selectors.BaseSelector) -> None:
        """Drops subscribers who may no longer watch."""
        now = time.monotonic()
        if now - self._look_s < AGAIN_S:
            return
        self._look_s = now
        admitted = {user: self._admits(user) for user in set(self._users.values())}
        for peer, user in list(self._users.items()):
            if not admitted[user]:
                self._drop(peer, selector)
        self._set_rate()

    def _send(self, selector: selectors.BaseSelector) -> None:
        os.eventfd_read(self._bell)
        if self._done or not self._samples:
            return
        self._turn_away(selector)
        state = self._encoder.encode(self._samples.pop())
        for peer, hz in self._wants.items():
            if hz:
                with suppress(OSError):  # no room: this state is dropped; or gone, as it will say
                    peer.send(state)

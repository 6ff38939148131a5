"""Sends a browser what it is told, as fast as it can take it, and hands on what it says."""

import asyncio
import json
import time
from collections.abc import Awaitable, Callable, Mapping
from contextlib import suppress
from typing import Any, Unpack

from websockets.asyncio.server import ServerConnection
from websockets.exceptions import ConnectionClosed

from neurotouch_hid.errors import DriverError
from neurotouch_hid.page.guard import Rate
from neurotouch_hid.page.messages import PageMessage
from neurotouch_hid.program_pause import ProgramPause


class Browser:
    """A browser that shows a page. A slow one misses states: only the newest state waits.

    Attributes:
        pause: of the driver, while this browser waits for a movement.
    """

    def __init__(self, socket: ServerConnection) -> None:
        self.socket = socket
        self.hz = 0
        self.rate = Rate()
        self.pause: ProgramPause | None = None
        self._state: bytes | None = None
        self._words: list[str] = []
        self._due_s = 0.0
        self._bell = asyncio.Event()

    def end_pause(self) -> None:
        """Ends the pause, if there is one; it may take as long as an answer of the driver."""
        pause, self.pause = self.pause, None
        if pause is not None:
            with suppress(DriverError):  # it has ended
                pause.end()

    def queue_state(self, state: bytes) -> None:
        """Queues the newest state, if it is time for one."""
        now = time.monotonic()
        if self.hz and now >= self._due_s:
            # A little early is in time, or 30 of 60 would become 20.
            self._due_s = max(self._due_s + 1.0 / self.hz, now - 0.5 / self.hz)
            self._state = state
            self._bell.set()

    def end_states(self) -> None:
        """Drops the state that waits: it is of a driver that has ended."""
        self._state = None

    def tell(self, **message: Unpack[PageMessage]) -> None:
        """Queues a message; none of these is dropped, and there are few."""
        self.queue_message(message)

    def queue_message(self, message: Mapping[str, Any]) -> None:
        """Queues a message of any page."""
        self._words.append(json.dumps(message, separators=(",", ":")))
        self._bell.set()

    async def talk(self, hear: Callable[[str | bytes], Awaitable[object]]) -> None:
        """Sends what is queued and hands on what comes, until the browser disconnects."""
        sender = asyncio.create_task(self.send())
        try:
            async for message in self.socket:
                if not self.rate.allows():
                    await self.socket.close(1008, "too many messages")
                    return
                await hear(message)
        except ConnectionClosed:
            pass
        finally:
            sender.cancel()
            with suppress(asyncio.CancelledError, ConnectionClosed):
                await sender

    async def send(self) -> None:
        """Sends queued messages until the browser disconnects."""
        while True:
            await self._bell.wait()
            self._bell.clear()
            words, self._words = self._words, []
            for word in words:
                await self.socket.send(word)
            state, self._state = self._state, None
            if state is not None:
                await self.socket.send(state)

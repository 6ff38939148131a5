"""A WebSocket server: one object of JSON for each state, to everyone who connects."""

import asyncio
import json
import os
import re
import threading
from contextlib import suppress
from typing import Any, Final

import numpy as np
from websockets.asyncio.server import Server, ServerConnection, broadcast, serve
from websockets.exceptions import ConnectionClosed

from neurotouch_hid.errors import StreamError
from neurotouch_hid.stream.reading import Reading
from neurotouch_hid.stream.sender import Sender

MOST_WAITING_BYTES: Final = 64 * 1024
"""A listener with more in its buffer misses states until it has caught up."""
MOST_HEARD_BYTES: Final = 1024
"""Of a message that we get; listeners have nothing to say."""
GOODBYE_S: Final = 1.0
LOCAL_PAGES: Final = re.compile(r"https?://(localhost|127\.0\.0\.1|\[::1\])(:\d+)?")


class WebSocketServer(Sender):
    """Serves states from a thread of its own; a context manager.

    A browser names the site of the page that connects. Pages of other machines are refused, so a
    site that a person visits cannot watch their hand. Other programs name no site.

    Args:
        host: address of an interface of this machine.
        port: TCP port; 0 takes a free one.
        markers: whether the displacement of each marker is sent, too.

    Raises:
        StreamError: it cannot listen there.
    """

    def __init__(self, host: str, port: int, *, markers: bool) -> None:
        self._markers = markers
        self._loop = asyncio.new_event_loop()
        self._stop = asyncio.Event()
        self._server: Server = self._open(host, port)
        host, port = self._server.sockets[0].getsockname()[:2]
        self.name = f"ws://{f'[{host}]' if ':' in host else host}:{port}"
        self._thread = threading.Thread(target=self._work, name="websocket", daemon=True)
        self._thread.start()

    def send(self, reading: Reading) -> None:
        """Sends a state to all listeners that have room for it."""
        text = json.dumps(describe(reading, markers=self._markers), separators=(",", ":"))
        self._loop.call_soon_threadsafe(self._spread, text)

    def close(self) -> None:
        """Says goodbye to all listeners and ends the server; a second call does nothing."""
        with suppress(RuntimeError):  # the loop is closed
            self._loop.call_soon_threadsafe(self._stop.set)
        self._thread.join()

    def _open(self, host: str, port: int) -> Server:
        async def open_server() -> Server:
            return await serve(
                _ignore_words,
                host,
                port,
                origins=[None, LOCAL_PAGES],
                compression=None,
                max_size=MOST_HEARD_BYTES,
                close_timeout=GOODBYE_S,
                server_header=None,
            )

        try:
            return self._loop.run_until_complete(open_server())
        except OSError as error:
            self._loop.close()
            # asyncio writes a sentence of its own; a name that is not known has no such number.
            number = error.errno or 0
            reason = os.strerror(number) if number > 0 else error.strerror
            raise StreamError(
                f"Cannot listen at {host}:{port}: {reason}.",
                hint="Give an address of this machine and a port that is free, for example "
                "websocket://127.0.0.1:8766.",
            ) from error

    def _work(self) -> None:
        async def wait() -> None:
            await self._stop.wait()
            self._server.close()
            await self._server.wait_closed()

        self._loop.run_until_complete(wait())
        self._loop.close()

    def _spread(self, text: str) -> None:
        broadcast(
            [
                each
                for each in self._server.connections
                if each.transport.get_write_buffer_size() < MOST_WAITING_BYTES
            ],
            text,
        )


def describe(reading: Reading, *, markers: bool) -> dict[str, Any]:
    """Returns a state as an object for JSON, its keys as the attributes of ``Reading``."""
    state: dict[str, Any] = {
        "t_us": reading.t_us,
        "state": reading.state,
        "simulated": reading.simulated,
        "kind": reading.kind,
        "intensity_mm": reading.intensity_mm,
        "confidence": reading.confidence,
        "movement": reading.movement,
        "moved_mm": reading.moved_mm,
        "turned_rad": reading.turned_rad,
        "scale": reading.scale,
        "contacts_mm": reading.contacts_mm,
        "axes": reading.axes,
        "buttons": reading.buttons,
    }
    if markers:
        # In float64, or each number would be written with 17 digits.
        state["markers_mm"] = reading.markers_mm.astype(np.float64).round(2).tolist()
    return state


async def _ignore_words(listener: ServerConnection) -> None:
    with suppress(ConnectionClosed):  # without a goodbye
        async for _ in listener:
            pass

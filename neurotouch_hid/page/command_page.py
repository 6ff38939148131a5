"""Shows at a page what a command in the terminal says, and hands it what a person presses there."""

import asyncio
import threading
import time
from collections import deque
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any, Final, Self

from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.ipc import read_object
from neurotouch_hid.page.browser import Browser
from neurotouch_hid.page.guard import Guard, make_token
from neurotouch_hid.page.server import Server, open_sockets

PAGES: Final = {"/": "/guide/guide.html"}
_MOST_WAITING: Final = 16
_LAST_S: Final = 2.0
"""So long a browser may take to show the last words of a command."""


class CommandPage:
    """A page of one command; a context manager, in which the page is served.

    Everything that is shown is one set of named values, sent whole whenever one has changed. So a
    browser that comes later, or comes back, shows the same.

    Args:
        keys: what a person can press, [key, label] each.
        shown: what is shown at first, by the names that ``guide.js`` knows.

    Attributes:
        url: the root of the page.
        token: its secret.

    Raises:
        PageError: the server cannot listen.
    """

    def __init__(self, keys: Sequence[tuple[str, str]], **shown: Any) -> None:
        self._shown = {"keys": [list(each) for each in keys], **shown}
        self._host = _Host(dict(self._shown))
        self.token = make_token()
        server = Server(Guard(self.token), open_sockets(None, None), self._host, pages=PAGES)
        self.url = server.url
        self._thread = threading.Thread(target=self._host.serve_with, args=(server,), daemon=True)

    def show(self, **changed: Any) -> None:
        """Shows other values in the place of those with the same names."""
        if not changed.items() <= self._shown.items():
            self._shown |= changed
            self._host.show(changed)

    def poll(self) -> str | None:
        """Returns the key that was pressed next, if one was."""
        return self._host.pressed.popleft() if self._host.pressed else None

    def __enter__(self) -> Self:
        self._thread.start()
        self._host.is_ready.wait()
        return self

    def __exit__(self, kind: object, error: object, trace: object) -> None:
        problem = error.message if isinstance(error, NeuroTouchError) else ""
        self.show(ended=True, problem=problem)
        self._host.end()
        self._thread.join()


class _Host:
    """Talks with the browsers, in a thread of its own.

    Attributes:
        pressed: keys that wait to be taken.
        is_ready: the loop runs.
    """

    def __init__(self, shown: dict[str, Any]) -> None:
        self.pressed: deque[str] = deque(maxlen=_MOST_WAITING)
        self.is_ready = threading.Event()
        self._shown, self._number = shown, 0
        self._seen: dict[Browser, int] = {}
        self._stop = asyncio.Event()

    @property
    def n_browsers(self) -> int:
        """The number of browsers."""
        return len(self._seen)

    def serve_with(self, server: Server) -> None:
        """Serves until it is ended."""

        async def serve() -> None:
            self._loop = asyncio.get_running_loop()
            self.is_ready.set()
            await server.run(self._stop)

        asyncio.run(serve())

    def show(self, changed: Mapping[str, Any]) -> None:
        """Shows other values; any thread may call it."""
        self._loop.call_soon_threadsafe(self._change, dict(changed))

    def end(self) -> None:
        """Ends the server as soon as all browsers show the last words, or soon."""
        asyncio.run_coroutine_threadsafe(self._end(), self._loop)

    async def run(self) -> None:
        """Does nothing: what changes is told by the command."""

    async def close(self) -> None:
        """Does nothing: nothing is kept."""

    async def serve(self, browser: Browser, hz: int) -> None:  # noqa: ARG002  # nothing is streamed
        """Talks with a browser, until it disconnects."""
        self._seen[browser] = -1
        try:
            self._send(browser)
            await browser.talk(partial(self._hear, browser))
        finally:
            del self._seen[browser]

    def _change(self, changed: dict[str, Any]) -> None:
        self._shown |= changed
        self._number += 1
        for browser in self._seen:
            self._send(browser)

    def _send(self, browser: Browser) -> None:
        browser.queue_message({"shown": self._shown, "number": self._number})

    async def _hear(self, browser: Browser, message: str | bytes) -> None:
        request = read_object(message) or {}
        number, key = request.get("seen"), request.get("press")
        if isinstance(number, int):
            self._seen[browser] = number
        elif isinstance(key, str) and key in [each[0] for each in self._shown["keys"]]:
            self.pressed.append(key)
        else:
            browser.queue_message(
                {"refused": "The page asks for something unknown. Load it again."}
            )

    async def _end(self) -> None:
        until_s = time.monotonic() + _LAST_S
        while any(seen < self._number for seen in self._seen.values()):
            if time.monotonic() > until_s:
                break
            await asyncio.sleep(0.02)
        self._stop.set()

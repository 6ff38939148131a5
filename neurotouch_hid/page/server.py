"""Serves the page on this machine: its files over HTTP, the pipeline's state over a WebSocket."""

import asyncio
import errno
import http
import os
import signal
import socket
import sys
from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any, Final, Protocol, cast

from websockets.asyncio.server import ServerConnection, serve
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response
from websockets.typing import Origin

from neurotouch_hid.errors import PageError
from neurotouch_hid.ipc import find_tcp_user, read_object
from neurotouch_hid.page.browser import Browser
from neurotouch_hid.page.guard import (
    HEADERS,
    LOCAL,
    MOST_BROWSERS,
    MOST_BYTES,
    SILENCE_S,
    TOKEN_S,
    Guard,
    Waiting,
)

PORT: Final = 7878
STREAM: Final = "/stream"
OPEN: Final = "/open/"
"""Followed by a ticket, a slash and a page's name."""
STATIC: Final = Path(__file__).with_name("static")
PAGES: Final = {
    "/": "/home/home.html",
    "/live": "/view/view.html",
    "/gel": "/gel/gel.html",
    "/game": "/game/game.html",
    "/sheet": "/home/sheet.html",
}
KINDS: Final = {
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".svg": "image/svg+xml",
}
SEND_BYTES: Final = 16 * 1024
"""Limit of a browser's buffer; beyond it, the newest state waits."""


class EndBySignal:
    """Makes Ctrl-C, SIGTERM and SIGHUP end a server, from now until the process ends.

    asyncio handles signals only while its loop runs; one that comes a moment earlier or later would
    raise KeyboardInterrupt in the middle of the loop's own work, which asyncio reports at length.
    Only the main thread may make one.
    """

    def __init__(self) -> None:
        self._came = False
        self._tell: Callable[[], object] = lambda: None
        numbers = [signal.SIGINT, signal.SIGTERM]
        if signal.getsignal(signal.SIGHUP) is not signal.SIG_IGN:  # as under nohup
            numbers.append(signal.SIGHUP)
        for number in numbers:
            signal.signal(number, self._note)

    def tell(self, loop: asyncio.AbstractEventLoop, stop: asyncio.Event) -> None:
        """Sets ``stop`` in a running loop when a signal arrives, or now if one has arrived."""

        def tell() -> None:
            with suppress(RuntimeError):  # the loop is closed: it ends anyway
                loop.call_soon_threadsafe(stop.set)

        self._tell = tell
        if self._came:
            stop.set()

    def _note(self, *_: object) -> None:
        self._came = True
        self._tell()


def run_until_signal(server: "Server", end: EndBySignal, *, until_stdin_ends: bool = False) -> None:
    """Serves until Ctrl-C or a signal.

    Args:
        server: the server.
        end: made before anybody was told of the server.
        until_stdin_ends: also until the standard input ends, however the program behind it ends.
    """

    async def serve() -> None:
        stop = asyncio.Event()
        end.tell(asyncio.get_running_loop(), stop)
        if until_stdin_ends:
            asyncio.get_running_loop().add_reader(sys.stdin.fileno(), stop.set)
        await server.run(stop)

    asyncio.run(serve())


def open_sockets(address: str | None, port: int | None) -> list[socket.socket]:
    """Opens listening sockets for this machine only and, if given, for a further address.

    Args:
        address: the address of an interface, or None.
        port: the port; None: the usual one, or any if that is taken.

    Raises:
        PageError: the server cannot listen there.
    """
    sockets: list[socket.socket] = []
    try:
        try:
            sockets.append(_listen("127.0.0.1", PORT if port is None else port))
        except OSError:
            if port is not None:
                raise
            sockets.append(_listen("127.0.0.1", 0))
        port = sockets[0].getsockname()[1]
        with suppress(OSError):  # a machine without IPv6, or another program has it there
            sockets.append(_listen("::1", port))
        if address is not None:
            sockets.append(_listen(address, port))
    except OSError as error:
        for each in sockets:
            each.close()
        raise _explain_refusal(error, address, port) from error
    return sockets


def _explain_refusal(error: OSError, address: str | None, port: int | None) -> PageError:
    """Returns why nothing can listen there, and what to do."""
    if error.errno == errno.EADDRNOTAVAIL:
        return PageError(
            f"This machine has no address {address}.", hint="See which it has: ip address"
        )
    if error.errno == errno.EADDRINUSE:
        return PageError(
            f"Another program uses port {port}.",
            hint="Without --port, a free port is used.",
        )
    if error.errno == errno.EACCES:
        return PageError(
            f"Only root may serve at port {port}.", hint="Use one of 1024 or more: --port 7900"
        )
    return PageError(
        f"The page cannot be served at port {port}: {error.strerror}.",
        hint="Without --port, a free port is used.",
    )


class _Line(ServerConnection):
    """A connection that is counted from its first moment, long before it says anything."""

    def __init__(self, waiting: Waiting, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self._waiting = waiting

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Begins: the other end has connected."""
        super().connection_made(transport)
        self._waiting.add(self, str(transport.get_extra_info("peername", ("",))[0]))

    def connection_lost(self, exc: Exception | None) -> None:
        """Ends: it is closed."""
        self._waiting.remove(self)
        super().connection_lost(exc)

    def drop(self) -> None:
        """Ends it at once, without a word."""
        self.transport.abort()


class Host(Protocol):
    """Talks with the browsers that have shown the token."""

    @property
    def n_browsers(self) -> int:
        """The number of browsers."""
        ...

    async def run(self) -> None:
        """Works beside the talks, if there is something to do."""
        ...

    async def serve(self, browser: Browser, hz: int) -> None:
        """Talks with a browser, until it disconnects."""
        ...

    async def close(self) -> None:
        """Ends: the server has closed its sockets."""
        ...


class Server:
    """A server of pages.

    Args:
        guard: its access rules.
        sockets: its listening sockets.
        host: talks with the browsers.
        pages: the page at each address, as a path in ``static``.
        silence_s: interval of pings to a browser; it must answer within the same time.
    """

    def __init__(
        self,
        guard: Guard,
        sockets: list[socket.socket],
        host: Host,
        *,
        pages: Mapping[str, str] = PAGES,
        silence_s: float = SILENCE_S,
    ) -> None:
        self._guard, self._sockets, self._silence_s = guard, sockets, silence_s
        for each in sockets:
            guard.open_port(each.getsockname()[1])
        self._host, self._pages = host, pages
        self._files = _read_files(pages)
        self._waiting = Waiting()

    @property
    def url(self) -> str:
        """The root of its pages on this machine."""
        host, port = self._sockets[0].getsockname()[:2]
        return f"http://{host}:{port}/"

    async def run(self, stop: asyncio.Event) -> None:
        """Serves until ``stop`` is set."""
        looking = asyncio.create_task(self._host.run())
        line = cast("type[ServerConnection]", partial(_Line, self._waiting))
        servers = [
            await serve(
                self._talk,
                sock=each,
                origins=[Origin(origin) for origin in self._guard.origins],
                process_request=self._answer,
                compression=None,  # the states hardly shrink, and it would cost time
                max_size=MOST_BYTES,
                max_queue=8,
                write_limit=SEND_BYTES,
                open_timeout=TOKEN_S,
                close_timeout=1.0,
                ping_interval=self._silence_s,
                ping_timeout=self._silence_s,
                server_header=None,
                create_connection=line,
            )
            for each in self._sockets
        ]
        try:
            await stop.wait()
        finally:
            looking.cancel()
            for server in servers:
                server.close()
            for server in servers:
                await server.wait_closed()
            await self._host.close()

    def _answer(self, connection: ServerConnection, request: Request) -> Response | None:
        """Returns a file, a refusal, or None for the stream, whose Origin is then compared."""
        hosts = request.headers.get_all("Host")
        if len(hosts) != 1 or hosts[0] not in self._guard.hosts:
            return _reply(http.HTTPStatus.MISDIRECTED_REQUEST, b"This is not your server.\n")
        if request.path == STREAM:
            if "Origin" not in request.headers:  # browsers always send it
                return _reply(http.HTTPStatus.FORBIDDEN, b"Missing Origin header\n")
            return None
        if request.path.startswith(OPEN):
            return self._open(connection, *request.path.removeprefix(OPEN).partition("/")[::2])
        if request.path not in self._files:
            return _reply(http.HTTPStatus.NOT_FOUND, b"There is no such page.\n")
        kind, content = self._files[request.path]
        reply = _reply(http.HTTPStatus.OK, content, kind)
        if hosts[0].rpartition(":")[0] not in LOCAL:
            # Without encryption browsers ignore it on any machine but their own, and complain.
            del reply.headers["Cross-Origin-Opener-Policy"]
        return reply

    def _open(self, connection: ServerConnection, ticket: str, page: str) -> Response:
        """Sends the owner's browser to a page with its secret.

        The kernel says whose browser it is: a ticket is in the arguments of the browser, where
        every user of this machine can read it.
        """
        is_known = self._guard.accepts(ticket) and f"/{page}" in self._pages
        here, there = connection.local_address, connection.remote_address
        if not is_known or find_tcp_user(there, here) != os.geteuid():
            sentence = b"Open the link that the command has printed.\n"
            return _reply(http.HTTPStatus.FORBIDDEN, sentence)
        reply = _reply(http.HTTPStatus.FOUND, b"")
        reply.headers["Location"] = self._guard.link(page)
        return reply

    async def _talk(self, connection: ServerConnection) -> None:
        """Lets in who shows the token."""
        try:
            shown = await asyncio.wait_for(connection.recv(), TOKEN_S)
            said = read_object(shown)
            if said is None or not self._guard.knows(said.get("token")):
                await connection.close(1008, "its link is wrong")
                return
            if self._host.n_browsers >= MOST_BROWSERS:
                await connection.close(1013, "too many viewers (4)")
                return
            self._waiting.remove(connection)
            hz = said.get("hz")
            await self._host.serve(Browser(connection), hz if isinstance(hz, int) else 30)
        except TimeoutError:
            await connection.close(1008, "its link is not complete")
        except ConnectionClosed:
            pass


def _listen(address: str, port: int) -> socket.socket:
    family = socket.AF_INET6 if ":" in address else socket.AF_INET
    listener = socket.socket(family, socket.SOCK_STREAM)
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        if family == socket.AF_INET6:
            listener.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_V6ONLY, 1)
        listener.bind((address, port))
        listener.listen()  # from here on no other program gets the port
    except OSError:
        listener.close()
        raise
    return listener


def _read_files(pages: Mapping[str, str]) -> dict[str, tuple[str, bytes]]:
    """Returns all files that are served, by their path in the address.

    No other file can be requested.
    """
    folders = {"shared", *(Path(path).parts[1] for path in pages.values())}
    files = {
        f"/{path.relative_to(STATIC)}": (KINDS[path.suffix], path.read_bytes())
        for folder in folders
        for path in STATIC.glob(f"{folder}/*")
        if path.suffix in KINDS
    }
    return files | {page: files[path] for page, path in pages.items()}


def _reply(
    status: http.HTTPStatus, content: bytes, kind: str = "text/plain; charset=utf-8"
) -> Response:
    headers = Headers(HEADERS)
    headers["Content-Type"] = kind
    headers["Content-Length"] = str(len(content))
    headers["Connection"] = "close"
    return Response(status.value, status.phrase, headers, content)

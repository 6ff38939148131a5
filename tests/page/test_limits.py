"""Messages that are too long or too frequent, and too many connections."""

import asyncio
import json
import socket
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, suppress
from types import SimpleNamespace

from websockets.exceptions import ConnectionClosed

from neurotouch_hid.page import guard
from neurotouch_hid.page.guard import (
    MESSAGES_PER_S,
    MOST_BROWSERS,
    MOST_BYTES,
    MOST_WAITING,
    Guard,
    Rate,
    Waiting,
    make_token,
)
from neurotouch_hid.page.hub import Hub
from neurotouch_hid.page.server import Server, open_sockets
from tests.page.connecting import enter, read_to_the_end, show_token
from tests.processes import LIMIT_S


def test_a_long_message_ends_the_line(server):
    with enter(server) as line:
        show_token(line, server.token)
        line.send("x" * (MOST_BYTES + 1))
        assert read_to_the_end(line) == 1009


def test_too_many_messages_end_the_line(server):
    with enter(server) as line:
        show_token(line, server.token)
        with suppress(ConnectionClosed):
            for _ in range(20 * int(MESSAGES_PER_S)):
                line.send('{"do": "hand"}')
        assert read_to_the_end(line) == 1008


def test_a_rate_recovers(monkeypatch):
    now_s = 100.0
    monkeypatch.setattr(guard, "time", SimpleNamespace(monotonic=lambda: now_s))
    rate = Rate(50.0)
    assert [rate.allows() for _ in range(60)].count(True) == 50
    now_s += 0.9 / 50
    assert not rate.allows()
    now_s += 0.2 / 50
    assert [rate.allows(), rate.allows()] == [True, False]


def test_four_pages_look_on_and_no_fifth(server):
    with ExitStack() as stack:
        for _ in range(MOST_BROWSERS):
            show_token(stack.enter_context(enter(server)), server.token)
        fifth = stack.enter_context(enter(server))
        fifth.send(json.dumps({"token": server.token}))
        assert read_to_the_end(fifth) == 1013


def test_who_shows_no_token_keeps_nobody_out(server):
    """The newest connection goes in; the oldest that has not shown the token goes."""
    with ExitStack() as stack:
        strangers = [
            stack.enter_context(socket.create_connection(("127.0.0.1", server.port), timeout=60))
            for _ in range(MOST_WAITING)
        ]
        owner = stack.enter_context(enter(server))
        assert show_token(owner, server.token)["hello"]
        with suppress(ConnectionResetError):
            assert strangers[0].recv(1) == b""
        for _ in range(MOST_WAITING):
            stack.enter_context(socket.create_connection(("127.0.0.1", server.port), timeout=60))
        owner.send('{"do": "nonsense"}')  # who has shown the token is not counted any more
        while "refused" not in json.loads(owner.recv(LIMIT_S)):
            pass


class Stranger:
    def __init__(self):
        self.is_dropped = False

    def drop(self):
        self.is_dropped = True


def test_the_oldest_of_the_address_with_the_most_goes():
    waiting = Waiting(most=4)
    first, *crowd = (Stranger() for _ in range(4))
    waiting.add(first, "127.0.0.1")
    for each in crowd:
        waiting.add(each, "192.0.2.9")
    late = Stranger()
    waiting.add(late, "127.0.0.1")
    assert [each.is_dropped for each in (first, *crowd, late)] == [False, True, False, False, False]
    waiting.remove(late)
    waiting.remove(late)
    waiting.add(last := Stranger(), "192.0.2.9")
    assert not any(each.is_dropped for each in (first, *crowd[1:], last))


def test_who_no_longer_answers_is_let_go():
    async def meet() -> bytes:
        guard = Guard(make_token())
        hub = Hub(edit=False, stamp=str)
        server = Server(guard, open_sockets(None, 0), hub, silence_s=0.2)
        stop = asyncio.Event()
        running = asyncio.create_task(server.run(stop))
        host = server.url.split("/")[2]
        reader, writer = await asyncio.open_connection(*host.split(":"))
        writer.write(
            f"GET /stream HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\n"
            "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
            "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n".encode()
        )
        assert (await reader.readline()).startswith(b"HTTP/1.1 101")
        said = await asyncio.wait_for(reader.read(), 60)  # the server sends pings; nothing answers
        writer.close()
        stop.set()
        await running
        return said

    # In a thread: the browser of other tests has a loop in this one.
    with ThreadPoolExecutor(1) as threads:
        assert b"\x89" in threads.submit(asyncio.run, meet()).result()

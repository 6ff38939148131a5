"""Who gets in, who does not: the eight points of the page's security, one after another."""

import asyncio
import http.client
import json
import os
import socket
import stat
import subprocess
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, suppress
from pathlib import Path
from types import SimpleNamespace

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from neurotouch_hid.errors import PageError
from neurotouch_hid.ipc import is_own_peer
from neurotouch_hid.page import guard
from neurotouch_hid.page.address import write_secret
from neurotouch_hid.page.guard import (
    HEADERS,
    MESSAGES_PER_S,
    MOST_BYTES,
    MOST_CLIENTS,
    MOST_WAITING,
    TICKET_S,
    Guard,
    Rate,
    Waiting,
    make_ticket,
    make_token,
)
from neurotouch_hid.page.server import Server, open_sockets
from tests.page.processes import LIMIT_S, View

STRANGERS = [
    "evil.example",
    "evil.example:{port}",
    "127.0.0.1",
    "127.0.0.1:1",
    "localhost.evil.example:{port}",
    "127.0.0.1:{port}.evil.example",
    "[::2]:{port}",
    "",
]


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    """A server that only looks on, with no driver."""
    running = View(tmp_path_factory.mktemp("server"))
    yield running
    running.end()


def get(view, path="/", host=None, method="GET"):
    line = http.client.HTTPConnection("127.0.0.1", view.port, timeout=60)
    line.request(method, path, headers={"Host": host or f"127.0.0.1:{view.port}"})
    answer = line.getresponse()
    content = answer.read()
    line.close()
    return answer.status, dict(answer.getheaders()), content


def enter(view, **options):
    """A connection to the stream that has not shown a token."""
    origin = f"http://127.0.0.1:{view.port}"
    return connect(f"ws://127.0.0.1:{view.port}/stream", **{"origin": origin, **options})


def show_token(line, token, **more):
    line.send(json.dumps({"token": token, "hz": 0, **more}))
    return json.loads(line.recv(LIMIT_S))


# 1. Only this machine, unless somebody says exactly where and with which token.


def test_it_listens_on_this_machine_only(server):
    found = []
    for family in ("tcp", "tcp6"):
        table = Path(f"/proc/{server.process.pid}/net/{family}").read_text()
        for row in table.splitlines()[1:]:
            address, state = row.split()[1], row.split()[3]
            if state == "0A" and int(address.rsplit(":", 1)[1], 16) == server.port:
                found.append(address.rsplit(":", 1)[0])
    loopback = {"0100007F", "00000000000000000000000001000000"}
    assert "0100007F" in found
    assert set(found) <= loopback


def test_other_machines_need_a_token_of_their_own(server):
    done = server.call("view", "--listen", "192.0.2.1")
    assert done.returncode == 2
    assert "--token-file" in done.stderr


def test_a_token_that_others_can_read_is_refused(server, tmp_path):
    secret = tmp_path / "token"
    secret.write_text(make_token())
    secret.chmod(0o644)
    done = server.call("view", "--listen", "127.0.0.2", "--token-file", str(secret))
    assert done.returncode == 1
    assert "Other users can read" in done.stderr
    secret.chmod(0o600)
    secret.write_text("short")
    done = server.call("view", "--listen", "127.0.0.2", "--token-file", str(secret))
    assert done.returncode == 1
    assert "token of at least" in done.stderr


@pytest.mark.parametrize("address", ["0.0.0.0", "::", "example.org", "224.0.0.1", ""])
def test_an_address_that_is_no_interface_is_refused(address):
    with pytest.raises(PageError):
        Guard(make_token(), address)


def test_a_named_address_is_served_by_its_name_only(tmp_path):
    secret = tmp_path / "token"
    secret.write_text(make_token())
    secret.chmod(0o600)
    view = View(tmp_path / "far", "--listen", "127.0.0.2", "--token-file", str(secret))
    try:
        assert view.token == secret.read_text()
        line = http.client.HTTPConnection("127.0.0.2", view.port, timeout=60)
        line.request("GET", "/")
        assert line.getresponse().status == 200
        assert get(view, host=f"127.0.0.3:{view.port}")[0] == 421
    finally:
        view.end()


# 2. Another name for this machine is not answered.


@pytest.mark.parametrize("host", STRANGERS)
@pytest.mark.parametrize("path", ["/", "/stream"])
def test_a_foreign_host_is_misdirected(server, host, path):
    with socket.create_connection(("127.0.0.1", server.port), timeout=60) as line:
        line.sendall(
            f"GET {path} HTTP/1.1\r\nHost: {host.format(port=server.port)}\r\n"
            f"Origin: http://{host.format(port=server.port)}\r\n"
            "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
            "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n".encode()
        )
        assert line.recv(100).startswith(b"HTTP/1.1 421 ")


def test_two_hosts_are_none(server):
    with socket.create_connection(("127.0.0.1", server.port), timeout=60) as line:
        own = f"127.0.0.1:{server.port}"
        line.sendall(f"GET / HTTP/1.1\r\nHost: {own}\r\nHost: evil.example\r\n\r\n".encode())
        assert line.recv(100).startswith(b"HTTP/1.1 421 ")


@pytest.mark.parametrize("name", ["127.0.0.1", "localhost", "[::1]"])
def test_its_own_names_are_answered(server, name):
    assert get(server, host=f"{name}:{server.port}")[0] == 200


# 3. Another site's page gets no stream, and nobody does without the token.


@pytest.mark.parametrize(
    "origin", ["http://evil.example", "null", "https://127.0.0.1:{port}", "http://127.0.0.1:1"]
)
def test_a_foreign_origin_is_forbidden(server, origin):
    with (
        pytest.raises(InvalidStatus) as refused,
        enter(server, origin=origin.format(port=server.port)),
    ):
        pass
    assert refused.value.response.status_code == 403


def test_no_origin_is_forbidden_too(server):
    with pytest.raises(InvalidStatus) as refused, enter(server, origin=None):
        pass
    assert refused.value.response.status_code == 403


@pytest.mark.parametrize(
    "first", ['{"token": "wrong"}', "{}", "no json", "[]", '{"token": null}', '{"do": "undo"}']
)
def test_without_the_token_the_line_is_closed(server, first):
    with enter(server) as line:
        line.send(first)
        with pytest.raises(ConnectionClosed) as closed:
            line.recv(LIMIT_S)
    assert closed.value.rcvd.code == 1008


def test_who_says_nothing_is_not_waited_for_long(server):
    with enter(server) as line, pytest.raises(ConnectionClosed) as closed:
        line.recv(60)
    assert closed.value.rcvd.code == 1008


def test_the_token_is_new_each_time_and_not_in_what_is_served(server):
    assert make_token() != make_token()
    for path in ("/", "/game", "/gel", "/shared/wire.js"):
        assert server.token.encode() not in get(server, path)[2]


# 4. and 6. No other site may read anything; the page may load nothing from elsewhere.


@pytest.mark.parametrize("path", ["/", "/gel", "/game", "/shared/style.css", "/nothing", "/stream"])
def test_every_answer_carries_the_rules(server, path):
    _, headers, _ = get(server, path)
    for name, value in HEADERS.items():
        assert headers[name] == value
    assert not [name for name in headers if name.lower().startswith("access-control")]


def test_the_policy_allows_own_files_only():
    policy = dict(
        part.strip().split(" ", 1) for part in HEADERS["Content-Security-Policy"].split(";")
    )
    assert policy["default-src"] == "'none'"
    assert policy["script-src"] == policy["style-src"] == policy["connect-src"] == "'self'"
    assert policy["frame-ancestors"] == policy["base-uri"] == "'none'"


def test_no_page_names_anything_elsewhere(server):
    import re

    from neurotouch_hid.page.server import STATIC

    for path in STATIC.glob("*/*"):
        text = path.read_text()
        found = re.findall(r"(?:https?:)?//[a-z][\w.-]*\.[a-z]+", text)
        assert [each for each in found if "w3.org" not in each] == [], path.name
        if path.suffix == ".html":
            assert "<style" not in text
            assert not re.search(r"<script(?![^>]*\bsrc=)", text)
            assert not re.search(r"\son\w+=", text)
        if path.suffix == ".js":
            assert "innerHTML" not in text  # what a profile is called is text, never markup
            assert "insertAdjacentHTML" not in text


@pytest.mark.parametrize(
    "path",
    ["/../guard.py", "/%2e%2e/guard.py", "/static/../hub.py", "//etc/passwd", "/view/view.html?x"],
)
def test_nothing_else_is_served(server, path):
    assert get(server, path)[0] == 404


# 5. Read-only, unless it was asked for; never input, never other files.


@pytest.mark.parametrize(
    "wish",
    [
        {"do": "set", "key": "pinch", "mark": "on_mm", "value": 3},
        {"do": "undo"},
        {"do": "pause"},
        {"do": "resume"},
        {"do": "write", "pad": {"buttons": ["a"]}},
        {"do": "press", "button": "a"},
        {},
        [],
    ],
)
def test_a_page_without_edit_can_do_nothing(server, wish):
    with enter(server) as line:
        show_token(line, server.token)
        line.send(json.dumps(wish))
        while "refused" not in (said := json.loads(line.recv(LIMIT_S))):
            pass
        assert said["refused"]


def test_an_editing_page_names_no_file(view, driver, folder):
    before = {path: path.read_bytes() for path in folder.rglob("*.yaml")}
    refused = 0
    with enter(view) as line:
        show_token(line, view.token, hz=5)
        wait_for_about(line)
        for wish in (
            {"key": "../../user.slots", "mark": "on_mm", "value": 3},
            {"key": "pinch", "mark": "extends", "value": 3},
            {"key": "name", "mark": "on_mm", "value": 3},
            {"key": "pinch", "mark": "on_mm", "value": "3; rm"},
            {"key": "pinch", "mark": "on_mm", "value": 1e999},
            {"key": "pinch", "mark": "on_mm", "value": 99},
            {"key": "push", "mark": "points", "value": [["a", "b"]]},
            {"key": "pinch", "file": "/etc/passwd", "mark": "off_mm", "value": 9},
        ):
            line.send(json.dumps({"do": "set", **wish}))
            while True:
                if not isinstance(said := line.recv(LIMIT_S), str):
                    continue
                said = json.loads(said)
                assert "saved" not in said, wish
                if "refused" in said:
                    refused += 1
                    break
    assert refused == 8
    assert {path: path.read_bytes() for path in folder.rglob("*.yaml")} == before


def wait_for_about(line):
    while not isinstance((said := line.recv(LIMIT_S)), str) or not json.loads(said).get("about"):
        pass


def test_what_a_page_says_moves_no_real_driver(view, driver):
    """A driver that plays something else than the mouse's gel has nobody to hear a hand."""
    assert not (driver.folder / "run" / "hand").exists()
    with enter(view) as line:
        show_token(line, view.token)
        line.send(json.dumps({"do": "hand", "down": True, "push_x_mm": 9}))
        line.send(json.dumps({"do": "nonsense"}))
        while "refused" not in json.loads(line.recv(LIMIT_S)):
            pass
    assert driver.process.poll() is None


# 7. Not too long, not too often, not too many.


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
        for _ in range(MOST_CLIENTS):
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
        server = Server(guard, open_sockets(None, 0), stamp=str, silence_s=0.2)
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
        said = await asyncio.wait_for(reader.read(), 60)  # pings, and nobody who answers them
        writer.close()
        stop.set()
        await running
        return said

    # In a thread: the browser of other tests has a loop in this one.
    with ThreadPoolExecutor(1) as threads:
        assert b"\x89" in threads.submit(asyncio.run, meet()).result()


def read_to_the_end(line) -> int:
    """The code with which the server closes."""
    try:
        while True:
            line.recv(LIMIT_S)
    except ConnectionClosed as closed:
        return closed.rcvd.code


# A browser that is started is told no secret: everybody can read its arguments.


def test_a_started_browser_is_told_a_ticket_and_finds_the_page(tmp_path):
    programs = tmp_path / "bin"
    programs.mkdir()
    opener = programs / "xdg-open"
    opener.write_text(f'#!/bin/sh\necho "$@" > {tmp_path}/told\n')
    opener.chmod(0o755)
    options = {"DISPLAY": ":9", "PATH": f"{programs}:{os.environ['PATH']}"}
    view = View(tmp_path / "opened", "--open", **options)
    try:
        view.wait(lambda: (tmp_path / "told").exists() and (tmp_path / "told").read_text())
        told = (tmp_path / "told").read_text().strip()
        assert view.token not in told
        assert told.startswith(view.root)
        path = "/" + told.removeprefix(view.root)
        status, headers, content = get(view, path)
        assert (status, headers["Location"]) == (302, f"/#k={view.token}")
        assert content == b""
        assert get(view, path + "game")[1]["Location"] == f"/game#k={view.token}"
        assert get(view, path + "nothing")[0] == 403
    finally:
        view.end()


def test_a_ticket_ends_and_cannot_be_made_up(monkeypatch):
    now_s = 100.0
    monkeypatch.setattr(guard, "time", SimpleNamespace(monotonic=lambda: now_s))
    token = make_token()
    mine, ticket = Guard(token), make_ticket(token)
    assert mine.accepts(ticket)
    until, _, signature = ticket.partition("-")
    for false in (
        *("", "-", "1-", until, f"{until}-", f"{int(until) + 1}-{signature}", f"{ticket}0"),
        *(f"é-{signature}", f"{until}-é", f"٣-{signature}", make_ticket(make_token())),
    ):
        assert not mine.accepts(false), false
    now_s += TICKET_S + 1.0
    assert not mine.accepts(ticket)


GET_AS_NOBODY = """\
import os, socket, sys
os.setgid(65534)
os.setuid(65534)
with socket.create_connection(("127.0.0.1", int(sys.argv[1]))) as line:
    host = f"127.0.0.1:{sys.argv[1]}"
    line.sendall(f"GET {sys.argv[2]} HTTP/1.1\\r\\nHost: {host}\\r\\n\\r\\n".encode())
    print(line.makefile().read())
"""


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can be somebody else for a moment")
def test_another_users_browser_gets_nothing_for_a_ticket(server):
    path = f"/open/{make_ticket(server.token)}/"
    said = subprocess.run(
        ["/usr/bin/python3", "-c", GET_AS_NOBODY, str(server.port), path],
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    assert said.startswith("HTTP/1.1 403 ")
    assert server.token not in said
    assert get(server, path)[0] == 302


# 8. What other programs of this person need is theirs alone.


def test_the_address_file_is_the_owners_alone(server):
    path = server.folder / "run" / "page.json"
    found = path.stat()
    assert stat.S_IMODE(found.st_mode) == 0o600
    assert found.st_uid == os.geteuid()
    assert json.loads(path.read_text())["token"] == server.token


def test_no_secret_is_written_to_a_file_of_another_user(tmp_path, monkeypatch):
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path / "run"))
    (tmp_path / "run").mkdir()
    (tmp_path / "read-by-all").touch(0o666)
    (tmp_path / "run/token").symlink_to(tmp_path / "read-by-all")
    assert write_secret("token", "x").stat().st_mode & 0o777 == 0o600
    assert (tmp_path / "read-by-all").read_text() == ""
    (tmp_path / "run/late").symlink_to(tmp_path / "read-by-all")
    with monkeypatch.context() as patch:
        patch.setattr(Path, "unlink", lambda *_, **__: None)  # it was made a moment later
        with pytest.raises(FileExistsError):
            write_secret("late", "x")
    assert (tmp_path / "read-by-all").read_text() == ""
    (tmp_path / "link").symlink_to(tmp_path / "run")
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path / "link"))
    with pytest.raises(PermissionError):
        write_secret("token", "x")


def test_the_feed_is_the_owners_alone(driver):
    path = driver.folder / "run" / "feed"
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert stat.S_IMODE(path.parent.stat().st_mode) == 0o700


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can be somebody else for a moment")
def test_another_users_process_is_told_apart():
    here, there = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    child = os.fork()
    if child == 0:
        try:
            os.setuid(65534)
            own, other = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
            socket.send_fds(there, [b"."], [own.fileno(), other.fileno()])
        finally:
            os._exit(0)
    os.waitpid(child, 0)
    here.settimeout(5.0)  # what it sent is there
    _, descriptors, _, _ = socket.recv_fds(here, 1, 2)
    for descriptor in descriptors:
        with socket.socket(fileno=descriptor) as stranger:
            assert not is_own_peer(stranger)
    assert is_own_peer(here)
    here.close()
    there.close()


def test_a_second_page_gets_another_port_unless_one_was_asked_for():
    first = open_sockets(None, 0)
    port = first[0].getsockname()[1]
    with pytest.raises(PageError):
        open_sockets(None, port)
    for each in first:
        each.close()

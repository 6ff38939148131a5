"""Nobody gets data without the token, and no other user learns it."""

import json
import os
import socket
import stat
from pathlib import Path
from types import SimpleNamespace

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus

from neurotouch_hid.ipc import is_own_peer
from neurotouch_hid.page import guard
from neurotouch_hid.page.address import write_secret
from neurotouch_hid.page.guard import (
    TICKET_S,
    Guard,
    make_ticket,
    make_token,
)
from tests.page.connecting import enter, get
from tests.processes import LIMIT_S, View, run_command


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
    said = run_command("/usr/bin/python3", "-c", GET_AS_NOBODY, server.port, path).stdout
    assert said.startswith("HTTP/1.1 403 ")
    assert server.token not in said
    assert get(server, path)[0] == 302


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

"""Which machine may connect, and by which name: this one, unless somebody says exactly where."""

import http.client
import socket
from pathlib import Path

import pytest

from neurotouch_hid.errors import PageError
from neurotouch_hid.page.guard import (
    Guard,
    make_token,
)
from neurotouch_hid.page.server import open_sockets
from tests.page.connecting import get
from tests.processes import View

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


def test_a_second_page_gets_another_port_unless_one_was_asked_for():
    first = open_sockets(None, 0)
    port = first[0].getsockname()[1]
    with pytest.raises(PageError):
        open_sockets(None, port)
    for each in first:
        each.close()


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

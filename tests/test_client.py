"""What goes over the line to a driver and back, and that no line is left open."""

import json
import socket
import threading
from pathlib import Path
from types import SimpleNamespace

import pytest

from neurotouch_hid import client
from neurotouch_hid.driver.control_socket import ControlSocket
from neurotouch_hid.errors import DriverError

PATIENCE_S = 10.0


@pytest.fixture
def line(monkeypatch):
    """The client's end of a line, and what a driver has written on it."""
    ours, theirs = socket.socketpair()

    def connect(*_, timeout_s, **__):
        ours.settimeout(timeout_s)
        return ours

    monkeypatch.setattr(client, "connect_to", connect)
    with ours, theirs:
        yield SimpleNamespace(ours=ours, theirs=theirs)


def is_closed(end: socket.socket) -> bool:
    return end.fileno() == -1


def test_an_answer_ends_with_its_line_and_a_stream_follows(line):
    line.theirs.sendall(b'{"ok": true, "source": "sim:tour"}\n\n{"packets"')
    answer, connection = client.open_stream("record")
    assert answer == {"ok": True, "source": "sim:tour"}
    assert connection.recv(100) == b'\n{"packets"'
    assert connection.gettimeout() is None
    assert line.theirs.recv(100) == b'{"command": "record"}\n'


def test_after_an_answer_the_line_is_closed(line):
    line.theirs.sendall(b'{"ok": true}\n')
    assert client.ask("status") == {"ok": True}
    assert is_closed(line.ours)


def test_after_a_refusal_the_line_is_closed(line):
    line.theirs.sendall(b'{"ok": false, "error": "No.", "hint": "Later."}\n')
    with pytest.raises(DriverError, match=r"^No\.$") as caught:
        client.open_stream("record")
    assert caught.value.hint == "Later."
    assert is_closed(line.ours)


@pytest.mark.parametrize("said", ["[" * 200_000, "[]", "{", "1"])
def test_after_nonsense_the_line_is_closed(line, said):
    writing = threading.Thread(target=line.theirs.sendall, args=(f"{said}\n".encode(),))
    writing.start()
    with pytest.raises(DriverError, match="is not a driver"):
        client.ask("status")
    writing.join()
    assert is_closed(line.ours)


@pytest.mark.parametrize(("done", "is_done"), [(True, True), (False, False), (1, False)])
def test_a_driver_says_whether_it_has_been_done(line, done, is_done):
    line.theirs.sendall(json.dumps({"ok": True, "text": "Paused.", "done": done}).encode() + b"\n")
    (reached,) = client.ask_every("pause", [1])[:1]
    assert (reached.text, reached.is_done) == ("Paused.", is_done)


def test_two_drivers_are_asked_at_once(tmp_path, monkeypatch):
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path / "run"))
    both_asked = threading.Barrier(2, timeout=PATIENCE_S)

    def answer(*_):
        both_asked.wait()
        return {"ok": True, "text": "Stopped."}

    folders = [folder for player in (1, 2) for folder in client.list_runtime_folders(player)]
    with ControlSocket(folders[0]) as one, ControlSocket(folders[1]) as other:
        one.serve(answer)
        other.serve(answer)
        reached = client.ask_every("panic", [1, 2])
    assert [(each.player, each.text) for each in reached] == [(1, "Stopped."), (2, "Stopped.")]


@pytest.fixture
def clock(monkeypatch):
    """Time that passes only while somebody sleeps."""
    clock = SimpleNamespace(now_s=0.0, slept=0)

    def sleep(seconds):
        clock.now_s += seconds
        clock.slept += 1

    time = SimpleNamespace(monotonic=lambda: clock.now_s, sleep=sleep)
    monkeypatch.setattr(client, "time", time)
    monkeypatch.setattr(client, "_AGAIN_S", 0.5)
    monkeypatch.setattr(client, "is_served", lambda _: clock.now_s < clock.ends_s)
    return clock


@pytest.mark.parametrize("ends_s", [0.0, 3.0, client.ENDING_S + 0.5])
def test_a_driver_may_take_its_time_to_end(clock, ends_s):
    clock.ends_s = ends_s
    client.wait_until_ended(Path("/nowhere"))
    assert clock.now_s == ends_s
    assert clock.slept == 2 * ends_s


def test_a_driver_that_does_not_end_is_an_error_that_names_its_process(clock, tmp_path):
    clock.ends_s = client.ENDING_S + 1.0
    (tmp_path / "lock").write_text("1234\n")
    with pytest.raises(DriverError, match="has not ended within 10 s") as caught:
        client.wait_until_ended(tmp_path)
    assert caught.value.hint.endswith("To end it at once: kill -9 1234")


def test_a_driver_runs_that_answers(monkeypatch):
    monkeypatch.setattr(client, "ask_status", dict)
    assert client.is_driver_running() is True

    def refuse():
        raise DriverError("This driver belongs to another user.")

    monkeypatch.setattr(client, "ask_status", refuse)
    assert client.is_driver_running() is False

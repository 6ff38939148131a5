"""Which drivers a command reaches, whom it believes, and what it says about it."""

import json
import os
import subprocess
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from neurotouch_hid import client
from neurotouch_hid.cli.shared.send_without_click import send_command
from neurotouch_hid.client import ask, ask_every, ask_status, is_served
from neurotouch_hid.driver.control_socket import ControlSocket
from neurotouch_hid.errors import DriverError, NotRunningError
from neurotouch_hid.ipc import FEED, StrangerError, connect_to, find_believed
from neurotouch_hid.players import find_socket
from neurotouch_hid.subscriber import Subscriber

NOBODY = 65534
as_root = pytest.mark.skipif(os.geteuid() != 0, reason="only root can be somebody else")

LISTEN_AS_NOBODY = """\
import json, os, socket, sys
os.setgid(65534)
os.setuid(65534)
listener = socket.socket(socket.AF_UNIX, getattr(socket, sys.argv[3]))
listener.bind(sys.argv[1])
os.chmod(sys.argv[1], 0o777)
listener.listen()
print("ready", flush=True)
while True:
    client, _ = listener.accept()
    client.sendall(sys.argv[2].encode() + b"\\n")
    client.close()
"""


@contextmanager
def listen_as_nobody(path: Path, answer: dict, kind: str = "SOCK_STREAM"):
    program = ["/usr/bin/python3", "-c", LISTEN_AS_NOBODY, str(path), json.dumps(answer), kind]
    with subprocess.Popen(program, stdout=subprocess.PIPE) as process:
        try:
            assert process.stdout.readline() == b"ready\n"
            yield
        finally:
            process.kill()


@pytest.fixture
def own(tmp_path, monkeypatch) -> Path:
    """The folder of this user's driver; beside it is that of the service."""
    monkeypatch.delenv("RUNTIME_DIRECTORY")
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    monkeypatch.setattr("neurotouch_hid.players.SERVICE_FOLDER", tmp_path / "service")
    real = Path.is_dir  # a session of who runs the tests is nobody's business
    monkeypatch.setattr(
        Path, "is_dir", lambda path: not path.is_relative_to("/run/user") and real(path)
    )
    return tmp_path / "neurotouch"


@pytest.fixture
def public():
    """A folder as /tmp is, which everybody can write."""
    with TemporaryDirectory() as top:
        Path(top).chmod(0o1777)
        yield Path(top)


def serve(folder: Path, heard: list, answer: dict) -> ControlSocket:
    made = ControlSocket(folder)

    def reply(question, _uid):
        heard.append((folder.name, question["command"]))
        return dict(answer)

    made.serve(reply)
    return made


STOPPED = {"ok": True, "done": True, "text": "Stopped."}


@pytest.mark.parametrize("command", ["pause", "resume", "panic", "reload"])
def test_the_own_driver_does_not_hide_the_service(own, capsys, command):
    heard = []
    with serve(own, heard, STOPPED), serve(own.parent / "service", heard, STOPPED):
        assert send_command(command) == 0
    assert sorted(heard) == [("neurotouch", command), ("service", command)]
    assert capsys.readouterr().out == "Your driver: Stopped.\nThe service: Stopped.\n"


def test_stop_waits_for_each_that_ends(own, capsys):
    ending = {}

    def end(question, _uid):
        ending["own"].close()
        return {"ok": True, "text": "It has ended."}

    refusal = {"ok": False, "error": "Only an administrator can end it."}
    with serve(own.parent / "service", [], refusal), ControlSocket(own) as ending["own"]:
        ending["own"].serve(end)
        assert send_command("stop") == 8
        assert not is_served(own)
    said = capsys.readouterr()
    assert said.out == "Your driver: It has ended.\n"
    assert said.err == "Error: The service: Only an administrator can end it.\n"


def test_one_that_refuses_keeps_no_other_from_the_command(own, capsys):
    heard = []
    refusal = {"ok": False, "error": "No.", "hint": "Sit down there."}
    with serve(own, heard, refusal), serve(own.parent / "service", heard, STOPPED):
        assert send_command("panic") == 8
        assert send_command("panic", as_json=True) == 8
    assert heard.count(("service", "panic")) == 2
    said = capsys.readouterr()
    assert said.err == "Error: Your driver: No.\nFix: Sit down there.\n"
    first, *rows = said.out.splitlines()
    assert first == "The service: Stopped."
    assert [json.loads(row)["status"] for row in rows] == ["FAILED", "OK"]


def test_one_that_does_not_answer_keeps_no_other_waiting(own, capsys, monkeypatch):
    monkeypatch.setattr(client, "PATIENCE_S", 0.3)
    heard = []
    with ControlSocket(own), serve(own.parent / "service", heard, STOPPED):
        assert send_command("panic") == 8
    assert heard == [("service", "panic")]
    assert "Error: Your driver: The driver does not answer." in capsys.readouterr().err


def test_stop_says_how_to_end_a_driver_that_still_starts(own, capsys, monkeypatch):
    """Its socket is there while it compiles, for a minute or more, and the command waits in it."""
    monkeypatch.setattr(client, "PATIENCE_S", 0.3)
    with ControlSocket(own):
        assert send_command("stop") == 8
    assert capsys.readouterr().err == (
        "Error: Your driver: The driver does not answer.\n"
        "Fix: If it still starts, it takes the command when it is ready. "
        f"To end it now: kill -9 {os.getpid()}\n"
    )


def test_every_player_is_reached_although_the_first_refuses(own, capsys):
    heard = []
    second = own.with_name("neurotouch-2")
    service = own.parent / "service-2"
    refusal = {"ok": False, "error": "No."}
    with serve(own, heard, refusal), serve(second, heard, STOPPED), serve(service, heard, STOPPED):
        assert send_command("panic") == 8
    assert sorted(heard) == [
        ("neurotouch", "panic"),
        ("neurotouch-2", "panic"),
        ("service-2", "panic"),
    ]
    said = capsys.readouterr()
    assert said.err == "Error: Player 1, your driver: No.\n"
    assert said.out == "Player 2, your driver: Stopped.\nPlayer 2, the service: Stopped.\n"


@pytest.mark.parametrize(
    ("place", "name"), [("neurotouch", "Your driver"), ("service", "The service")]
)
def test_every_command_says_whom_it_has_reached(own, capsys, place, name):
    with serve(own.with_name(place), [], STOPPED):
        for command in ("pause", "resume", "panic", "reload"):
            assert send_command(command) == 0
            assert capsys.readouterr().out == f"{name}: Stopped.\n"


def test_without_a_driver_it_says_so_once(own, capsys):
    assert send_command("panic") == 8
    assert capsys.readouterr().err.count("No driver is running.") == 1


# Whom a command believes.


@as_root
def test_what_a_stranger_has_put_into_tmp_is_no_driver(public, monkeypatch, capsys):
    folder = public / "neurotouch-1000"
    folder.mkdir()
    os.chown(folder, NOBODY, NOBODY)
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(folder))
    with (
        listen_as_nobody(find_socket(folder), STOPPED),
        listen_as_nobody(folder / FEED, {}, "SOCK_SEQPACKET"),
    ):
        assert send_command("panic") == 8
        with pytest.raises(NotRunningError, match="belongs to another user, so it was not asked"):
            ask_status()
        assert not is_served(folder)
        assert Subscriber().connect() is None
    said = capsys.readouterr()
    assert said.out == ""
    assert f"'{folder}' belongs to another user" in said.err


@as_root
def test_a_stranger_who_listens_in_the_own_folder_is_not_believed(public, monkeypatch):
    folder = public / "neurotouch"
    folder.mkdir()
    folder.chmod(0o777)
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(folder))
    with listen_as_nobody(find_socket(folder), STOPPED):
        with pytest.raises(NotRunningError):
            ask("panic")
        assert not is_served(folder)
    with listen_as_nobody(folder / FEED, {}, "SOCK_SEQPACKET"), pytest.raises(StrangerError):
        connect_to(folder / FEED)


@as_root
def test_the_services_user_is_believed_where_only_root_makes_folders(monkeypatch):
    with TemporaryDirectory() as top:
        Path(top).chmod(0o755)
        folder = Path(top) / "neurotouch"
        folder.mkdir()
        os.chown(folder, NOBODY, NOBODY)
        monkeypatch.setenv("RUNTIME_DIRECTORY", str(folder))
        with listen_as_nobody(find_socket(folder), STOPPED):
            assert ask("panic")["text"] == "Stopped."
        Path(top).chmod(0o777)
        assert find_believed(folder) == frozenset()


def test_a_link_in_place_of_a_folder_is_not_believed(tmp_path):
    (tmp_path / "real").mkdir()
    (tmp_path / "link").symlink_to("real")
    assert find_believed(tmp_path / "real")
    assert not find_believed(tmp_path / "link")


# What an answer may lack.


@pytest.mark.parametrize("answer", [{}, {"state": 7}, {"errors": [{}]}, {"fatigue": [1]}])
def test_a_status_without_its_keys_is_one_sentence(own, answer):
    with serve(own, [], {"ok": True, **answer}), pytest.raises(DriverError, match="answer lacks '"):
        ask_status()


def test_an_answer_without_its_text_is_one_sentence(own):
    with serve(own, [], {"ok": True}):
        (reached,) = ask_every("panic", [1])
    assert reached.error.message == "The driver's answer lacks 'text'."


@pytest.mark.parametrize("answer", [{}, {"ok": 1}, {"ok": False, "error": ["x"], "hint": 7}])
def test_a_refusal_without_its_reason_is_one_sentence(own, answer):
    with serve(own, [], answer), pytest.raises(DriverError, match="does not say why") as caught:
        ask("panic")
    assert caught.value.hint is None


def test_nothing_in_an_answer_moves_the_cursor(own):
    evil = "\x1b]0;owned\a\u202e\udc80\x9b"
    with serve(own, [], {"ok": True, "text": evil, "more": [{evil: evil}]}):
        answer = ask("panic")
    assert answer["text"].isprintable()
    assert all(key.isprintable() for key in answer["more"][0])
    with serve(own, [], {"ok": False, "error": evil, "hint": evil}):
        with pytest.raises(DriverError) as caught:
            ask("panic")
        assert caught.value.message.isprintable()
        assert caught.value.hint.isprintable()

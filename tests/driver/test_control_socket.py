"""The control socket: one line in, one line out, and nobody can hurt it."""

import json
import os
import socket
import stat
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from neurotouch_hid import client as driver
from neurotouch_hid.client import LIMIT_BYTES, REQUEST_S, ask
from neurotouch_hid.driver import control_socket as control
from neurotouch_hid.driver.control_socket import MAX_CLIENTS, ControlSocket
from neurotouch_hid.errors import AlreadyRunningError, DriverError, NotRunningError
from neurotouch_hid.players import find_runtime_folder, find_socket
from tests.processes import run_command

LIMIT_S = 60.0


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path / "neurotouch"))
    return tmp_path / "neurotouch"


@pytest.fixture
def patient(monkeypatch):
    """A machine that stands still for a moment makes nobody give up."""
    monkeypatch.setattr(control, "REQUEST_S", LIMIT_S)
    monkeypatch.setattr(driver, "PATIENCE_S", LIMIT_S)


@pytest.fixture
def served(folder, patient):
    """A socket that repeats what it was asked."""
    with ControlSocket(folder) as made:
        made.serve(lambda question, _uid: {"ok": True, "heard": question})
        yield find_socket(folder)


def exchange(path: Path, *pieces: bytes, end: bool = True) -> dict:
    """What the driver says to these bytes."""
    with socket.socket(socket.AF_UNIX) as line:
        line.settimeout(LIMIT_S)
        line.connect(str(path))
        try:
            for piece in pieces:
                line.sendall(piece)
            if end:
                line.shutdown(socket.SHUT_WR)
        except (BrokenPipeError, ConnectionResetError):
            pass  # refused before all was said
        text = b""
        while not text.endswith(b"\n"):
            piece = line.recv(65536)
            assert piece, "closed without an answer"
            text += piece
    return json.loads(text)


def test_a_profile_may_take_its_time_to_load(folder, monkeypatch):
    monkeypatch.setattr(driver, "PATIENCE_S", 0.2)
    with ControlSocket(folder) as made, ThreadPoolExecutor(1) as asker:
        gate = threading.Event()

        def answer(question, _uid):
            gate.wait(LIMIT_S)
            return {"ok": True}

        made.serve(answer)
        loading = asker.submit(ask, "reload")
        with pytest.raises(DriverError, match="does not answer"):
            ask("status")
        gate.set()
        assert loading.result() == {"ok": True}


def test_a_machine_that_gives_no_more_threads_for_a_moment_silences_no_later_question(
    served, monkeypatch
):
    start, refusals = threading.Thread.start, [RuntimeError("can't start new thread")] * 20

    def refuse(thread):
        if thread.name == "control client" and refusals:
            raise refusals.pop()
        start(thread)

    monkeypatch.setattr(threading.Thread, "start", refuse)
    for _ in range(20):
        assert exchange(served, b'{"command": "status"}\n')["busy"] is True
    assert exchange(served, b'{"command": "status"}\n')["ok"] is True


def test_question_gets_the_answer_to_it(served):
    assert ask("use", profile="racing")["heard"] == {"command": "use", "profile": "racing"}


def test_only_the_owner_can_reach_the_socket(served):
    assert stat.S_IMODE(served.stat().st_mode) == 0o600
    assert stat.S_IMODE(served.parent.stat().st_mode) == 0o700


def test_folder_open_to_others_is_closed_to_them(folder):
    folder.mkdir()
    folder.chmod(0o777)
    with ControlSocket(folder):
        assert stat.S_IMODE(folder.stat().st_mode) == 0o700


def test_link_in_place_of_the_folder_is_refused(folder, tmp_path):
    (tmp_path / "elsewhere").mkdir()
    folder.symlink_to(tmp_path / "elsewhere")
    with pytest.raises(DriverError, match="is not owned by you"):
        ControlSocket(folder)


def test_second_driver_is_told_the_pid_of_the_first_which_goes_on(served):
    with pytest.raises(AlreadyRunningError, match=rf"PID {os.getpid()}\b") as caught:
        ControlSocket(served.parent)
    assert caught.value.exit_code == 75
    assert caught.value.hint == "Ask it: neurotouch status. End it: neurotouch stop"
    assert ask("status")["ok"]


def test_stale_socket_of_a_killed_driver_is_replaced(folder):
    code = (
        "import os, sys; from pathlib import Path\n"
        "from neurotouch_hid.driver.control_socket import ControlSocket\n"
        "control = ControlSocket(Path(sys.argv[1])); os._exit(9)"
    )
    subprocess.run([sys.executable, "-c", code, str(folder)], check=False)
    assert find_socket(folder).exists()
    with pytest.raises(NotRunningError):
        ask("status")
    with ControlSocket(folder) as made:
        made.serve(lambda question, _uid: {"ok": True})
        assert ask("status")["ok"]
    assert not find_socket(folder).exists()


def test_without_a_driver_the_sentence_says_how_to_start_it(folder):
    with pytest.raises(NotRunningError, match="No driver is running") as caught:
        ask("pause")
    assert caught.value.exit_code == 8
    assert "neurotouch run" in caught.value.hint


@pytest.mark.parametrize(
    ("said", "sentence"),
    [
        (b"\n", "no line with a JSON object"),
        (b"pause\n", "no line with a JSON object"),
        (b"\xff\xfe\x00\n", "no line with a JSON object"),
        (b"[" * 60_000 + b"\n", "no line with a JSON object"),
        (b"1" * 60_000 + b"\n", "no line with a JSON object"),
        (b'["pause"]\n', "no line with a JSON object"),
        (b'{"command": 7}\n', "no line with a JSON object"),
        (b"{}\n", "no line with a JSON object"),
        (b"", "no line with a JSON object"),
        (b"x" * (LIMIT_BYTES + 1), "longer than 1024 kB"),
        (b'{"command": "' + b"x" * LIMIT_BYTES + b'"}\n', "longer than 1024 kB"),
        (b"x" * 5_000_000, "longer than 1024 kB"),
    ],
)
def test_nonsense_is_refused_with_a_sentence(served, said, sentence):
    answer = exchange(served, said)
    assert answer["ok"] is False
    assert sentence in answer["error"]
    assert ask("status")["ok"]


@given(said=st.binary(max_size=300))
def test_any_bytes_get_an_answer(said):
    # A folder of its own: hypothesis does not run a test's fixtures again for each example.
    folder = find_runtime_folder().with_name("any-bytes")
    with ControlSocket(folder) as made:
        made.serve(lambda question, _uid: {"ok": True, "heard": question})
        assert isinstance(exchange(find_socket(folder), said)["ok"], bool)


def test_slow_question_is_given_up_after_its_second(served, monkeypatch):
    monkeypatch.setattr(control, "REQUEST_S", REQUEST_S)
    with socket.socket(socket.AF_UNIX) as line:
        line.settimeout(LIMIT_S)
        line.connect(str(served))
        begun = time.monotonic()
        dripping = threading.Event()

        def drip():
            while not dripping.wait(0.05):
                try:
                    line.send(b" ")
                except OSError:
                    return

        thread = threading.Thread(target=drip)
        thread.start()
        answer = json.loads(line.recv(65536))
        dripping.set()
        thread.join()
    assert "not complete" in answer["error"]
    assert time.monotonic() - begun > 0.9


def test_more_clients_than_places_are_told_to_wait_and_ask_waits(served):
    silent = [socket.socket(socket.AF_UNIX) for _ in range(MAX_CLIENTS)]
    try:
        for line in silent:
            line.connect(str(served))
        refused = [exchange(served, b'{"command": "status"}\n') for _ in range(3)]
        assert {answer.get("busy") for answer in refused} == {True}
        with ThreadPoolExecutor(1) as asker:
            asked = asker.submit(ask, "panic")
            time.sleep(0.3)
            assert not asked.done()  # keeps asking until one of the silent ones has gone
            silent[0].close()
            assert asked.result()["ok"]
    finally:
        for line in silent:
            line.close()


def test_client_that_leaves_before_the_answer_does_no_harm(served):
    for _ in range(3 * MAX_CLIENTS):
        with socket.socket(socket.AF_UNIX) as line:
            line.connect(str(served))
            with suppress(BrokenPipeError, ConnectionResetError):  # refused before it was said
                line.sendall(b'{"command": "status"}\n')
    assert ask("status")["ok"]


@pytest.mark.skipif(os.geteuid() != 0, reason="needs root, to become another user")
def test_another_user_is_refused_even_where_the_files_would_let_them_in(tmp_path, served):
    for path in (served, served.parent):
        path.chmod(0o777)
    code = (
        "import os, socket, sys\n"
        "line = socket.socket(socket.AF_UNIX)\n"
        "os.chdir(sys.argv[1]); os.setgid(65534); os.setuid(65534)\n"
        "line.connect('control')\n"
        'try: line.sendall(b\'{"command": "panic"}\\n\')\n'
        "except OSError: pass\n"  # refused before it was said
        "print(line.recv(65536).decode())"
    )
    done = run_command(sys.executable, "-c", code, served.parent)
    answer = json.loads(done.stdout)
    assert answer["ok"] is False
    assert "another user" in answer["error"]


def test_no_folder_to_make_it_in_is_an_error_that_says_so(tmp_path):
    with pytest.raises(DriverError, match="No control socket can be made"):
        ControlSocket(tmp_path / "missing" / "neurotouch")


def test_what_is_no_driver_is_called_so(folder):
    folder.mkdir()
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(str(find_socket(folder)))
        listener.listen()

        def babble():
            client, _ = listener.accept()
            with client:
                client.sendall(b"hello\n")

        thread = threading.Thread(target=babble)
        thread.start()
        with pytest.raises(DriverError, match="not a driver"):
            ask("status")
        thread.join()


def test_folder_is_the_services_or_that_of_the_session(monkeypatch):
    monkeypatch.setenv("XDG_RUNTIME_DIR", "/run/user/7")
    monkeypatch.setenv("RUNTIME_DIRECTORY", "/run/neurotouch:/run/other")
    assert find_runtime_folder() == Path("/run/neurotouch")
    monkeypatch.delenv("RUNTIME_DIRECTORY")
    assert find_runtime_folder() == Path("/run/user/7/neurotouch")
    monkeypatch.setenv("XDG_RUNTIME_DIR", "relative")
    assert find_runtime_folder().is_absolute()


ASK_AS_NOBODY = """\
import contextlib, os, socket, sys
os.setgid(65534)
os.setuid(65534)
line = socket.socket(socket.AF_UNIX)
line.connect(sys.argv[1])
with contextlib.suppress(OSError):  # refused before it was said
    line.sendall(b'{"command": "pause"}\\n')
    line.shutdown(socket.SHUT_WR)
print(line.makefile().readline())
"""


def ask_as_nobody(path: Path) -> dict:
    said = run_command("/usr/bin/python3", "-c", ASK_AS_NOBODY, path)
    return json.loads(said.stdout)


@pytest.mark.skipif(os.getuid() != 0, reason="only root can ask as somebody else")
@pytest.mark.parametrize(("guests", "welcome"), [({65534}, True), ({12345}, False), ((), False)])
def test_a_service_answers_its_guests_and_nobody_else(guests, welcome):
    with TemporaryDirectory() as top:  # pytest's own folders let nobody in
        Path(top).chmod(0o755)
        folder = Path(top) / "neurotouch"
        with ControlSocket(folder, lambda: guests) as made:
            made.serve(lambda _question, _uid: {"ok": True})
            assert stat.S_IMODE(folder.stat().st_mode) == 0o755
            answer = ask_as_nobody(find_socket(folder))
            assert answer["ok"] is welcome
            assert welcome or "another user" in answer["error"]
            assert exchange(find_socket(folder), b'{"command": "pause"}\n')["ok"]  # always


CROWD_AS_NOBODY = """\
import os, socket, sys
os.setgid(65534)
os.setuid(65534)
lines = []
for _ in range(300):
    line = socket.socket(socket.AF_UNIX)
    line.settimeout(60)
    line.connect(sys.argv[1])
    lines.append(line)
print(sum(b"another user" in line.recv(1000) for line in lines))
"""


@pytest.mark.skipif(os.getuid() != 0, reason="only root can ask as somebody else")
def test_a_crowd_of_strangers_is_refused_without_asking_who_sits_there_each_time():
    with TemporaryDirectory() as top:
        Path(top).chmod(0o755)
        folder = Path(top) / "neurotouch"
        looked = []

        def find_guests():
            looked.append(time.monotonic())
            return ()

        with ControlSocket(folder, find_guests) as made:
            program = ["/usr/bin/python3", "-c", CROWD_AS_NOBODY, str(find_socket(folder))]
            with subprocess.Popen(program, stdout=subprocess.PIPE, text=True) as crowd:
                made.serve(lambda _question, _uid: {"ok": True})
                assert exchange(find_socket(folder), b'{"command": "panic"}\n')["ok"]
                assert crowd.communicate(timeout=LIMIT_S)[0] == "300\n"
        pauses_s = [later - one for one, later in pairwise(looked)]
        assert all(pause_s >= 0.2 for pause_s in pauses_s)


def test_a_stream_follows_the_answer_unless_it_is_a_refusal(folder, patient):
    with ControlSocket(folder) as made:
        made.serve(
            lambda question, _uid: {"ok": "please" in question, "error": "Ask nicely."},
            {"record": lambda client: client.sendall(b"packets")},
        )
        with pytest.raises(DriverError, match="nicely"):
            driver.open_stream("record")
        assert exchange(find_socket(folder), b'{"command": "record"}\n')["ok"] is False
        with socket.socket(socket.AF_UNIX) as line:
            line.settimeout(LIMIT_S)
            line.connect(str(find_socket(folder)))
            line.sendall(b'{"command": "record", "please": 1}\n')
            with line.makefile("rb") as said:
                assert json.loads(said.readline())["ok"] is True
                assert said.read() == b"packets"


def test_a_second_driver_is_refused_before_it_has_loaded_anything(served, folder):
    with pytest.raises(AlreadyRunningError, match=rf"PID {os.getpid()}"):
        control.refuse_second(folder)


def test_the_only_driver_is_not_refused(folder):
    control.refuse_second(folder)


def test_right_after_the_start_of_the_machine_nobody_counts_as_refused(folder, monkeypatch):
    with ControlSocket(folder) as made:
        monkeypatch.setattr(control, "time", SimpleNamespace(monotonic=lambda: 0.5))
        assert made._admits_quickly(os.geteuid())


def test_guests_cannot_reach_the_lock(folder):
    with ControlSocket(folder, frozenset):
        assert stat.S_IMODE((folder / "lock").stat().st_mode) == 0o600
        assert stat.S_IMODE(find_socket(folder).stat().st_mode) == 0o666


@pytest.mark.skipif(os.getuid() != 0, reason="only root can give a folder away")
def test_root_is_told_of_the_driver_that_another_user_runs(folder):
    with ControlSocket(folder, frozenset):
        os.chown(folder, 65534, 65534)  # as systemd gives the service its folder
        with pytest.raises(AlreadyRunningError, match="as another user"):
            ControlSocket(folder)
        os.chown(folder, 0, 0)

"""``neurotouch session`` beside a service: settings reach it, and its sounds come back.

The driver plays as the service does, the session is a process of its own. Where root runs the tests
they are different users.
"""

import os
import signal
import socket
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

import pytest

from neurotouch_hid.cli.session import AGAIN_S, _Link
from neurotouch_hid.client import ask, ask_status
from neurotouch_hid.errors import DriverError, NotRunningError
from neurotouch_hid.ipc import FEED, listen_at
from neurotouch_hid.players import find_socket
from tests.processes import LIMIT_S, PROGRAM, run_command
from tests.repeated import find_tour, offer_repeated
from tests.waiting import wait_until

IS_ROOT = os.getuid() == 0
SERVICE, PERSON = (61003, 61004) if IS_ROOT else (os.getuid(), os.getuid())
PLAY = """
import sys
from pathlib import Path
from neurotouch_hid.driver import Driver, DriverOptions
from neurotouch_hid.driver.people import People
from neurotouch_hid.process.signals import stop_on_signals

source, seats, people = sys.argv[1:]
seated = lambda: tuple(int(line) for line in Path(seats).read_text().split())
options = DriverOptions(source=source, device="memory", copilot="")
people = People(Path(people), find_seated=seated)
with Driver(options, guests=seated, people=people) as driver:
    driver.run(stop=stop_on_signals())
"""


def become(user: int) -> tuple[str, ...]:
    """What starts a program as another user, who may read this installation."""
    if not IS_ROOT:
        return ()
    rights = ("--inh-caps=+dac_override", "--ambient-caps=+dac_override")
    return ("setpriv", f"--reuid={user}", f"--regid={user}", "--clear-groups", *rights)


class Place:
    """Folders that all users of a test reach, and the programs in them."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.values = folder / "home/neurotouch/user.yaml"
        for name in ("run", "state", "machine", "home/neurotouch", "bin"):
            (folder / name).mkdir(parents=True)
        folder.chmod(0o755)
        for name in ("run", "state"):
            os.chown(folder / name, SERVICE, SERVICE)
        (folder / "played").touch(0o666)
        (folder / "played").chmod(0o666)
        player = folder / "bin/pw-play"
        player.write_text(
            f"#!/bin/sh\n/bin/cat /dev/stdin > /dev/null\necho $PPID >> {folder}/played\n"
        )
        player.chmod(0o755)
        self.seat(PERSON)

    def seat(self, *users: int) -> None:
        (self.folder / "seated").write_text("".join(f"{user}\n" for user in users))

    def count_sounds(self, process: subprocess.Popen) -> int:
        return (self.folder / "played").read_text().split().count(str(process.pid))

    @contextmanager
    def start(self, *command: str, user: int, home: str = "home"):
        process = subprocess.Popen(
            [*become(user), *command],
            env={
                **os.environ,
                "PATH": f"{self.folder}/bin:{os.environ['PATH']}",
                "XDG_CONFIG_HOME": str(self.folder / home),
                **offer_repeated(self.folder / "packages"),
            },
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        )
        try:
            yield process
        finally:
            process.terminate()
            _, process.said = process.communicate(timeout=LIMIT_S)

    @contextmanager
    def serve(self):
        seated, people = str(self.folder / "seated"), str(self.folder / "state/people")
        command = (sys.executable, "-c", PLAY, f"repeated:{find_tour()}", seated, people)
        with self.start(*command, user=SERVICE, home="machine") as process:
            wait_until(is_running)
            yield process

    @contextmanager
    def connect(self):
        with self.start(*PROGRAM, "session", user=PERSON) as process:
            yield process
            assert process.poll() is None
        assert process.returncode == 0
        assert process.said == ""


def is_running() -> bool:
    try:
        return bool(ask_status())
    except DriverError:
        return False


def go_on() -> None:
    """Waits until the driver has played some seconds more, with several movements."""
    until = ask_status()["slices"] + 700
    wait_until(lambda: ask_status()["slices"] > until)


@pytest.fixture
def place(monkeypatch, tmp_path):
    folder = Path(f"/tmp/nt-session-{os.getpid()}")
    made = Place(folder)
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(folder / "run"))
    monkeypatch.setenv("XDG_CONFIG_HOME", str(folder / "home"))
    yield made
    subprocess.run(["rm", "-rf", folder], check=True)


def test_settings_and_sounds_go_between_the_service_and_the_session(place):
    with place.serve() as service, place.connect() as session:
        place.values.write_text("version: 1\nfeedback: {sound: tones}\nslots: [racing]\n")
        wait_until(lambda: ask_status()["profile"] == "racing")
        assert "person at the machine" in ask_status()["settings"]
        assert "played in the session of the person" in ask_status()["sound"]
        wait_until(lambda: place.count_sounds(session))
        second = run_command(*become(PERSON), *PROGRAM, "session", code=75)
        assert "already runs" in second.stderr
        maps = Path(f"/proc/{session.pid}/maps").read_text()
        assert "numpy" in maps
        assert "llvmlite" not in maps  # numba
        assert place.count_sounds(service) == 0


def test_a_restarted_service_is_heard_again(place):
    place.values.write_text("version: 1\nfeedback: {sound: tones}\n")
    with place.connect() as session:
        with place.serve() as service:
            wait_until(lambda: place.count_sounds(session))
            service.send_signal(signal.SIGKILL)
            service.wait(LIMIT_S)
        n_before = place.count_sounds(session)
        with place.serve():
            wait_until(lambda: place.count_sounds(session) > n_before)


@pytest.mark.skipif(not IS_ROOT, reason="only root becomes other users")
def test_a_person_who_leaves_the_seat_hears_nothing_until_the_return(place):
    place.values.write_text("version: 1\nfeedback: {sound: tones}\n")
    with place.serve(), place.connect() as session:
        wait_until(lambda: place.count_sounds(session))
        place.seat()
        go_on()
        n_before = place.count_sounds(session)
        go_on()
        assert place.count_sounds(session) == n_before
        place.seat(PERSON)
        wait_until(lambda: place.count_sounds(session) > n_before)


def test_a_driver_of_the_person_is_heard_once(place):
    place.values.write_text("version: 1\nfeedback: {sound: tones}\n")
    source = f"repeated:{find_tour()}"
    run = (*PROGRAM, "run", "--source", source, "--device", "memory", "--show", "nothing")
    os.chown(place.folder / "run", PERSON, PERSON)
    with place.start(*run, user=PERSON) as driver, place.connect() as session:
        wait_until(is_running)
        wait_until(lambda: "numpy" in Path(f"/proc/{session.pid}/maps").read_text())
        n_before = place.count_sounds(driver)
        wait_until(lambda: place.count_sounds(driver) > n_before + 5)
        assert place.count_sounds(session) == 0
        ask("stop")


def test_who_wants_no_sound_asks_the_service_for_no_states(place):
    place.values.write_text("version: 1\nslots: [racing]\n")
    with place.serve(), place.connect() as session:
        wait_until(lambda: ask_status()["profile"] == "racing")
        assert "numpy" not in Path(f"/proc/{session.pid}/maps").read_text()


class Files:
    """A person's files, a driver that seems to be there, and a clock that a test sets."""

    def __init__(self, folder: Path) -> None:
        self.values = folder / "neurotouch/user.yaml"
        (folder / "neurotouch/profiles").mkdir(parents=True)
        (folder / "control").touch()
        self.answers, self.asked = [], 0
        self.link = _Link(1, self.hand_over, str)

    def hand_over(self, player: int) -> bool:
        assert player == 1
        self.asked += 1
        if not self.answers:
            raise NotRunningError("No driver is running.")
        return self.answers.pop(0)

    def look(self, *moments_s: float) -> int:
        self.asked = 0
        for now_s in moments_s:
            self.link.look(now_s)
        return self.asked


@pytest.fixture
def files(tmp_path, monkeypatch):
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path))
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    made = Files(tmp_path)
    yield made
    made.link.close()


def test_settings_are_handed_over_at_the_start_and_after_each_change(files):
    files.answers = [True] * 4
    assert files.look(0, 1, 2, 3) == 1
    files.values.write_text("version: 1\n")
    assert files.look(4, 5, 6) == 1
    profile = files.values.parent / "profiles/mine.yaml"
    profile.write_text("version: 1\nname: mine\n")
    assert files.look(7, 8) == 1
    profile.unlink()
    assert files.look(9, 10) == 1


def test_what_was_not_taken_is_handed_over_again_but_ever_more_rarely(files):
    assert files.look(*range(100)) == len([0, 2, 6, 14, 30, 62])
    assert files.look(*range(100, 300)) == len([122, 182, 242])
    files.values.write_text("version: 1\n")  # another try at once
    assert files.look(300) == 1
    files.answers = [True]
    assert files.look(300 + AGAIN_S, 303, 304, 305, 400) == 1


def test_without_a_driver_nothing_is_handed_over_until_one_comes(files, tmp_path):
    (tmp_path / "control").unlink()
    assert files.look(0, 1, 2) == 0
    (tmp_path / "control").touch()
    files.answers = [True]
    assert files.look(3, 4) == 1


def test_values_with_errors_are_said_and_the_sounds_stay(files, monkeypatch):
    said = []
    monkeypatch.setattr(files.link, "_announce", said.append)
    files.values.write_text("version: 1\nfeedback: {sound: tones}\n")
    files.look(0)
    assert files.link._sound.feedback.sound == "tones"
    files.values.write_text("version: 1\nfeedback: {sound: noise}\n")
    files.look(1, 2)
    assert files.link._sound.feedback.sound == "tones"
    (sentence,) = said
    assert "user.yaml" in sentence


def test_the_machines_values_apply_to_who_has_none(files, tmp_path, monkeypatch):
    (tmp_path / "machine").mkdir()
    (tmp_path / "machine/user.yaml").write_text("version: 1\nfeedback: {sound: speech}\n")
    monkeypatch.setenv("CONFIGURATION_DIRECTORY", str(tmp_path / "machine"))
    files.look(0)
    assert files.link._sound.feedback.sound == "speech"


def test_a_driver_of_the_person_goes_before_the_service(tmp_path, monkeypatch):
    own, service = tmp_path / "own/neurotouch", tmp_path / "service"
    monkeypatch.delenv("RUNTIME_DIRECTORY", raising=False)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(own.parent))
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    monkeypatch.setattr("neurotouch_hid.players.SERVICE_FOLDER", service)
    values = tmp_path / "neurotouch/user.yaml"
    for folder in (own, service, values.parent):
        folder.mkdir(parents=True)
    values.write_text("version: 1\nfeedback: {sound: tones}\n")

    def find_place() -> Path | None:
        return None if link.peer is None else Path(link.peer.getpeername()).parent

    with _Link(1, lambda _: True, str) as link, listen_at(service / FEED):
        link.look(0)
        assert find_place() == service
        (own / "control").touch()  # left behind by one that was killed
        link.look(1)
        assert find_place() == service
        with (
            listen_at(own / FEED),
            listen_at(find_socket(own), kind=socket.SOCK_STREAM),
        ):
            link.look(2)
            assert link.peer is None
            link.look(10_000_000)
            assert find_place() == own

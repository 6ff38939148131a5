"""A pause that a program has begun ends with its connection, and no other does."""

import socket
import subprocess
import sys
import threading
import time

import pytest

from neurotouch_hid.client import ask
from neurotouch_hid.driver import program_pauses
from neurotouch_hid.driver.commands import Commands
from neurotouch_hid.driver.control_socket import ControlSocket
from neurotouch_hid.driver.packet_feed import PacketFeed
from neurotouch_hid.driver.program_pauses import MAX_PAUSES, ProgramPauses
from neurotouch_hid.driver.surroundings import Surroundings
from neurotouch_hid.errors import DriverError
from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.players import find_runtime_folder
from neurotouch_hid.profile import UserSettings, load_profile
from neurotouch_hid.program_pause import ProgramPause
from neurotouch_hid.runtime import Pipeline, PipelineControl
from tests.waiting import wait_until

PROFILE, USER = load_profile("default"), UserSettings()


@pytest.fixture
def control(tmp_path, monkeypatch):
    """A driver that listens, and whose pipeline takes commands all the time."""
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path / "neurotouch"))
    monkeypatch.setattr(program_pauses, "_WAIT_S", 60.0)
    control = PipelineControl(Pipeline.build(PROFILE, GestureConfig(), user=USER), USER)
    pauses, ended = ProgramPauses(control), threading.Event()
    commands = Commands(control, None, PacketFeed(), pauses, None, Surroundings(), dict, None)

    def apply():
        while not ended.is_set():
            control.apply_commands()
            time.sleep(0.001)

    thread = threading.Thread(target=apply)
    thread.start()
    with ControlSocket(find_runtime_folder()) as served:
        served.serve(commands.answer, {"pause_while_connected": pauses.serve})
        yield control
    ended.set()
    thread.join()


def test_it_is_paused_until_the_last_program_has_ended(control):
    first, second = ProgramPause(), ProgramPause()
    assert (first.state, second.state) == ("paused", "paused")
    assert first.end() == "Still paused, until another program has ended too."
    assert control.mapping.state == "paused"
    assert second.end() == "Resumed. The next gesture counts."
    assert control.mapping.state == "running"


def test_the_pause_of_a_killed_program_ends(control):
    code = "from time import sleep; from neurotouch_hid.program_pause import ProgramPause; "
    code += "pause = ProgramPause(); sleep(60)"
    with subprocess.Popen([sys.executable, "-c", code]) as program:
        wait_until(lambda: control.mapping.state == "paused")
        program.kill()
    wait_until(lambda: control.mapping.state == "running")


@pytest.mark.parametrize(
    ("before", "meanwhile", "state", "words"),
    [
        ((), ("panic",), "panic", "Stopped by panic"),
        (("panic",), (), "panic", "Stopped by panic"),
        ((), ("panic", "pause"), "panic", "Stopped by panic"),
        ((), ("pause",), "paused", "Still paused. Go on with: neurotouch resume"),
        (("pause",), (), "paused", "Still paused. Go on with: neurotouch resume"),
        ((), ("resume",), "running", "Resumed"),
        ((), ("resume", "pause"), "paused", "Still paused. Go on"),
        ((), ("panic", "resume"), "running", "Resumed"),
    ],
)
def test_what_a_person_has_commanded_stays(control, before, meanwhile, state, words):
    for command in before:
        ask(command)
    pause = ProgramPause()
    for command in meanwhile:
        ask(command)
    assert pause.end().startswith(words)
    assert control.mapping.state == state


def test_other_values_of_the_person_meanwhile_do_not_make_it_a_person_s_pause(control):
    pause = ProgramPause()
    control.switch(PROFILE, UserSettings(filter="strong")).done.result(60)
    assert control.mapping.state == "paused"
    pause.end()
    assert control.mapping.state == "running"


def test_commands_find_a_place_beside_all_pauses(control):
    pauses = [ProgramPause() for _ in range(MAX_PAUSES)]
    with pytest.raises(DriverError, match="Too many programs have paused the driver: 4"):
        ProgramPause()
    assert ask("panic")["done"]
    for pause in pauses:
        assert pause.end().startswith("St")
    assert control.mapping.state == "panic"


def test_a_panic_in_between_drops_the_pause_and_its_end(control, monkeypatch):
    monkeypatch.setattr(program_pauses, "_WAIT_S", 0.0)
    monkeypatch.setattr(control, "apply_commands", lambda: None)  # the source is silent
    time.sleep(0.05)
    pause = ProgramPause()
    assert pause.state is None
    control.submit("panic")
    assert "when data resumes" in pause.end()
    monkeypatch.undo()
    wait_until(lambda: control.mapping.state == "panic")
    control.submit("resume").done.result(60)
    assert control.mapping.state == "running"


def test_the_gesture_that_pauses_does_not_end_it(control):
    """A program asks for movements, and one may be this gesture."""
    mapping = control.mapping
    pause = ProgramPause()
    mapping._apply("pause")
    assert mapping.state == "paused"
    mapping._apply("panic")
    assert pause.end().startswith("Stopped by panic")


def test_a_program_that_leaves_before_its_answer_leaves_no_pause(control):
    for _ in range(20):
        with socket.socket(socket.AF_UNIX) as line:
            line.connect(str(find_runtime_folder() / "control"))
            line.sendall(b'{"command": "pause_while_connected"}\n')
    pause = ProgramPause()
    pause.end()
    wait_until(lambda: control.mapping.state == "running")

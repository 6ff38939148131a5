"""A driver that runs, and everything one can say to it from outside."""

import json
import os
import pty
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from neurotouch_hid.client import ask
from neurotouch_hid.driver_state import read_head
from neurotouch_hid.monitor.cue import CueKind
from neurotouch_hid.monitor.tone import make_wave
from neurotouch_hid.subscriber import Subscriber
from tests.processes import PROGRAM, Process, make_environment, run_command, run_neurotouch
from tests.repeated import find_tour, offer_repeated
from tests.waiting import LIMIT_S, wait_until

HEAVY = ("click", "numpy", "numba", "cv2", "pydantic", "ruamel", "evdev", "asyncio", "threading")

RUN = [*PROGRAM, "run", "--source", "sim:tour", "--device", "memory"]


class Driver(Process):
    """``neurotouch run`` with a trace."""

    def __init__(self, folder: Path) -> None:
        self.trace = folder / "trace.jsonl"
        command = ("run", "--source", f"repeated:{find_tour()}", "--device", "memory")
        super().__init__(
            folder,
            *(*command, "--show", "nothing", "--trace", str(self.trace)),
            ready="Gamepad ready",
            PATH=f"{folder / 'bin'}:{os.environ['PATH']}",
            **offer_repeated(folder / "packages"),
        )

    def do(self, *arguments: str) -> str:
        done = self.call(*arguments)
        assert done.returncode == 0, done.stderr
        return done.stdout

    def order(self, command: str, begin: str) -> None:
        """Gives an order until it has taken effect: the driver may be held up for a moment."""
        self.wait(lambda: (said := self.do(command)).startswith(begin) or "lready" in said)

    def status(self) -> dict:
        return json.loads(self.do("status", "--json"))

    def end(self) -> list[dict]:
        """Ends it, with nothing pressed; what it did slice by slice."""
        self.process.terminate()
        assert self.process.wait(LIMIT_S) == 0, self.said
        assert "The pad is neutral." in self.said
        assert "Traceback" not in self.said
        assert not (self.folder / "run" / "control").exists()
        return [json.loads(line) for line in self.trace.read_text().splitlines()]


@pytest.fixture(scope="module")
def start(tmp_path_factory):
    """Starts drivers; none outlives its tests."""
    started = []

    def start_driver() -> Driver:
        folder = tmp_path_factory.mktemp("live")
        profiles = folder / "config" / "neurotouch" / "profiles"
        profiles.mkdir(parents=True)
        (profiles / "mine.yaml").write_text(profile("a"))
        (profiles.parent / "user.yaml").write_text("version: 1\nslots: [mine]\n")
        started.append(Driver(folder))
        return started[-1]

    yield start_driver
    for driver in started:
        driver.process.kill()
        driver.process.wait()


@pytest.fixture(scope="module")
def shared(start):
    """A driver that several tests ask, in any order."""
    return start()


def profile(button: str) -> str:
    gestures = ("push", "pinch", "zoom", "twist_cw", "twist_ccw")
    lines = [f"  - {{when: {{gesture: {kind}}}, do: {{button: {button}}}}}" for kind in gestures]
    return "\n".join(["version: 1", "name: mine", "bindings:", *lines, ""])


def find_pressed(trace: list[dict]) -> set[str]:
    return {name for record in trace for name, value in record["pad"].items() if value}


def test_pause_resume_and_panic_from_the_command_line(start):
    driver = start()
    assert driver.status()["state"] == "running"
    driver.order("pause", "Your driver: Paused")
    assert driver.status()["state"] == "paused"
    driver.order("resume", "Your driver: Resumed")
    assert driver.status()["state"] == "running"
    driver.order("panic", "Your driver: Stopped")
    assert driver.do("pause").startswith("Your driver: Already stopped by panic")
    driver.do("reload")
    driver.process.send_signal(signal.SIGHUP)
    driver.wait(lambda: driver.said.count("has been reloaded") == 2)
    assert driver.status()["state"] == "panic"
    stopped = driver.status()["slices"]
    driver.wait(lambda: driver.status()["slices"] > stopped + 400)  # whole gestures go by
    status = driver.status()
    assert status["state"] == "panic"
    assert status["markers_tracked"] > 170
    trace = driver.end()
    assert find_pressed(trace[stopped:]) == set()
    assert {record["gesture"] for record in trace[stopped:]} != {"none"}


def test_saved_profile_holds_and_a_wrong_one_does_not(start):
    driver = start()
    driver.wait(lambda: driver.status()["slices"] > 300)
    first = driver.status()["slices"]
    file = driver.folder / "config/neurotouch/profiles/mine.yaml"
    file.write_text(profile("b"))
    driver.wait(lambda: "has been reloaded" in driver.said)
    file.write_text(profile("bb"))
    driver.wait(lambda: "goes on as it was" in driver.said)
    assert "mine.yaml:4:" in driver.said
    (error,) = driver.status()["errors"]
    assert "mine.yaml:4:" in error["error"]
    refused = driver.call("reload")
    assert (refused.returncode, "mine.yaml:4:" in refused.stderr) == (8, True)
    slices = driver.status()["slices"]
    driver.wait(lambda: driver.status()["slices"] > slices + 400)
    trace = driver.end()
    assert find_pressed(trace[:first]) == {"a"}
    assert find_pressed(trace[slices:]) == {"b"}


def test_gel_goes_to_the_next_favourite(start):
    driver = start()
    folder = driver.folder / "config/neurotouch"
    (folder / "user.yaml").write_text("version: 1\nslots: [mine, racing]\n")
    gel = profile("a").replace("{button: a}", "{command: next_profile}")
    (folder / "profiles" / "mine.yaml").write_text(gel)
    driver.wait(lambda: driver.status()["profile"] == "racing")
    driver.wait(lambda: "The profile 'racing' is in use." in driver.said)
    driver.end()


def test_sound_comes_as_soon_as_the_person_wants_it(start):
    driver = start()
    heard = driver.folder / "heard"
    player = driver.folder / "bin" / "pw-play"
    player.parent.mkdir()
    player.write_text(f'#!/bin/sh\ncat "$1" > {heard}\n')
    player.chmod(0o755)
    user = driver.folder / "config/neurotouch/user.yaml"
    user.write_text("version: 1\nslots: [mine]\nfeedback: {sound: tones, volume: {press: 0}}\n")
    driver.wait(lambda: "has been reloaded" in driver.said)
    driver.do("panic")
    driver.wait(lambda: driver.status()["sound"] == "tones through pw-play")
    driver.end()
    assert heard.read_bytes() == make_wave(CueKind.PANIC, 80)


def test_status_has_one_fact_on_each_line_and_the_state_first(shared):
    driver = shared
    driver.order("resume", "Your driver: Resumed")
    driver.wait(lambda: driver.status()["markers_tracked"] > 170 and driver.status()["stage_ms"])
    plain = driver.do("status").splitlines()
    assert plain[0] == "OK: running"
    assert not any(line.startswith(("events", "time in", "process")) for line in plain)
    every = driver.do("status", "--verbose").splitlines()
    assert len(every) > len(plain)
    facts = dict(line.split(": ", 1) for line in every)
    assert facts["source"] == "SIMULATED repeated:tour"
    assert facts["pad"] == "memory"
    assert facts["profile"] == "mine"
    assert facts["layer"] == "base"
    assert re.search(r", 17\d of 177 markers tracked$", facts["gel"])
    assert facts["events"].endswith("0 lost")
    assert {"time in tracker", "time in gesture", "time in profile"} <= set(facts)
    assert "chord" in facts["keyboard"]
    assert facts["sound"] == "none"
    driver.order("panic", "Your driver: Stopped")
    assert driver.do("status").startswith("WARNING: stopped by panic")


def test_the_command_alone_says_in_words_what_runs_and_what_comes_next(shared):
    driver = shared
    driver.order("resume", "Your driver: Resumed")
    driver.wait(lambda: driver.status()["gel"]["found"])
    said = driver.do().splitlines()
    assert said == [
        "The driver runs, with the profile mine.",
        "source: SIMULATED repeated:tour",
        "pad: memory",
        "gel: found",
        "Next: neurotouch view --edit --open",
        "All commands: neurotouch --help",
    ]
    for order, words in (("pause", "is paused"), ("panic", "is stopped by panic")):
        driver.order(order, "Your driver: ")
        first, *_, following, _ = driver.do().splitlines()
        assert first == f"The driver {words}, with the profile mine."
        assert following == "Next: neurotouch resume"
    driver.order("resume", "Your driver: Resumed")


def test_status_tells_the_last_ignored_gesture(start):
    driver = start()
    mine = profile("a").replace("}, do:", ", accept_ms: 5000}, do:")
    (driver.folder / "config/neurotouch/profiles/mine.yaml").write_text(mine)
    driver.wait(lambda: driver.status()["ignored"] is not None)
    said = driver.do("status")
    assert re.search(r"\nlast ignored: \w.* -> button a, because lasted \d+ ms <", said)
    driver.end()


def test_second_driver_is_refused_and_the_first_goes_on(shared):
    done = shared.call(*RUN[len(PROGRAM) :])
    assert done.returncode == 75
    assert f"PID {shared.process.pid}" in done.stderr
    assert shared.status()["pid"] == shared.process.pid


def test_computation_beside_the_driver_is_allowed(shared):
    done = shared.call("run", "--source", "sim:push", "--device", "memory", "--speed", "max")
    assert done.returncode == 0, done.stderr


def test_stop_ends_the_driver_and_says_so_when_it_has_ended(start):
    driver = start()
    assert driver.do("stop") == "Your driver: Ended. The pad is neutral.\n"
    assert not (driver.folder / "run" / "control").exists()
    assert driver.process.wait(LIMIT_S) == 0
    assert driver.said.rstrip().endswith("The pad is neutral.")


def test_killed_driver_leaves_no_obstacle(start):
    driver = start()
    driver.process.kill()
    driver.process.wait()
    done = driver.call("pause")
    assert done.returncode == 8
    assert "No driver is running" in done.stderr
    again = Driver(driver.folder)
    assert again.status()["state"] == "running"
    again.end()


@pytest.mark.parametrize("command", ["pause", "resume", "reload", "status"])
def test_without_a_driver_each_command_says_so(command, tmp_path):
    done = run_neurotouch(command, code=8, env=make_environment(tmp_path))
    assert done.stderr == (
        "Error: No driver is running.\nFix: Start it: neurotouch run. "
        "Without a camera: neurotouch demo\n"
    )
    assert done.stdout == ""


@pytest.mark.parametrize("json_", [(), ("--json",)])
def test_stop_and_panic_without_a_driver_claim_nothing(json_, tmp_path):
    def call(command):
        return run_neurotouch(command, *json_, code=None, env=make_environment(tmp_path))

    done = call("stop")
    assert done.returncode == 0, done.stderr
    assert "No driver is running. There is nothing to end." in done.stdout
    done = call("panic")
    said = done.stdout + done.stderr
    assert done.returncode == 8
    assert "No driver is running. Nothing was reached or released." in said
    assert "If a button is still held, another program holds it." in said
    assert "Start it" not in said
    assert "Stopped" not in said


@pytest.mark.parametrize("order", ["pause", "resume", "panic", "stop"])
def test_orders_import_next_to_nothing(order, tmp_path):
    code = (
        f"import sys; sys.argv[1:] = ['{order}']\n"
        "from neurotouch_hid.__main__ import main\n"
        "try: main()\n"
        f"finally: print([name for name in {HEAVY!r} if name in sys.modules], len(sys.modules))"
    )
    done = run_command(
        sys.executable,
        "-c",
        code,
        code=0 if order == "stop" else 8,
        env=make_environment(tmp_path),
    )
    found, n_modules = done.stdout.splitlines()[-1].rsplit(" ", 1)
    assert found == "[]"
    assert int(n_modules) < 120


def test_closing_the_terminal_ends_the_driver(tmp_path):
    environment = make_environment(tmp_path)
    log = tmp_path / "stderr.txt"
    pid, terminal = pty.fork()
    if pid == 0:
        descriptor = os.open(log, os.O_WRONLY | os.O_CREAT)
        os.dup2(descriptor, 2)
        signal.signal(signal.SIGHUP, signal.SIG_DFL)  # also where the tests run under nohup
        os.execve(RUN[0], [*RUN, "--show", "nothing"], environment)
    try:
        wait_until(lambda: log.exists() and "Gamepad ready" in log.read_text())
        os.kill(pid, signal.SIGHUP)  # the terminal is still there: this means reload
        wait_until(lambda: "has been reloaded" in log.read_text())
        os.close(terminal)
        ended = wait_until(lambda: any(ended := os.waitpid(pid, os.WNOHANG)) and ended)
    except BaseException:
        os.kill(pid, signal.SIGKILL)
        raise
    assert os.waitstatus_to_exitcode(ended[1]) == 0
    assert "The pad is neutral." in log.read_text()


def test_profiles_are_still_changed_when_the_terminal_has_gone(tmp_path, monkeypatch):
    """As of a driver in the background that its shell no longer knows."""
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path / "run"))
    terminal, line = pty.openpty()
    with subprocess.Popen(
        [*RUN, "--show", "nothing"], stderr=line, start_new_session=True
    ) as process:
        try:
            os.close(line)
            said = b""
            while b"Gamepad ready" not in said:
                said += os.read(terminal, 4096)
            os.close(terminal)
            for name in ("flight", "racing"):
                ask("use", profile=name)
                wait_until(lambda name=name: ask("status")["profile"] == name)
        finally:
            process.kill()


def test_those_who_look_on_are_told_on_when_the_profile_has_become_a_link_to_itself(
    tmp_path, monkeypatch
):
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path / "run"))
    file = tmp_path / "mine.yaml"
    file.write_text(profile("a"))
    listener = Subscriber()
    listener.want(10)
    with subprocess.Popen(
        [*RUN, "--show", "nothing", "--profile", str(file)], stderr=subprocess.DEVNULL
    ) as process:
        try:
            told = None
            deadline = time.monotonic() + LIMIT_S
            while told != "":
                assert time.monotonic() < deadline
                time.sleep(0.05)
                listener.connect()
                state = listener.take()
                if state is not None:
                    told = read_head(state)["slow"]["file"]
                if told == str(file) and not file.is_symlink():
                    file.unlink()
                    file.symlink_to(file)
        finally:
            process.kill()
            listener.close()

"""The commands around the page: what they print, and how they end."""

import json
import os
import re
import signal
import subprocess
import time

import pytest

from neurotouch_hid.cli.demo_page import open_page
from neurotouch_hid.page.address import read_address
from tests.page.processes import LIMIT_S, PROGRAM


@pytest.mark.parametrize("command", ["view", "monitor", "game", "demo"])
def test_each_has_help_with_examples(command):
    done = subprocess.run([*PROGRAM, command, "--help"], capture_output=True, text=True, check=True)
    assert "Examples:" in done.stdout


def test_the_monitor_needs_a_driver(tmp_path):
    done = subprocess.run(
        [*PROGRAM, "monitor", "--plain"],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "RUNTIME_DIRECTORY": str(tmp_path)},
    )
    assert done.returncode == 8
    assert done.stderr == "Error: No driver is running.\nFix: Start it: neurotouch run\n"


def test_the_monitor_tells_lines(driver):
    begins = ("hand: ", "health: 17", "latency: camera window 10 ms, tracker ")
    deadline = time.monotonic() + LIMIT_S
    with subprocess.Popen(
        [*PROGRAM, "monitor", "--plain"],
        stdout=subprocess.PIPE,
        text=True,
        env=driver.environment,
    ) as monitor:
        lines = []
        while not all(any(line.startswith(begin) for line in lines) for begin in begins):
            lines.append(monitor.stdout.readline())
            assert lines[-1]
            assert time.monotonic() < deadline, lines
        monitor.send_signal(signal.SIGINT)
    assert lines[0].startswith("driver: running, profile mine, layer base, source SIMULATED")
    assert "\x1b" not in "".join(lines)


def test_the_monitor_ends_by_itself(driver):
    done = driver.call("monitor", "--plain", "--seconds", "0.5")
    assert done.returncode == 0, done.stderr
    assert "has ended" not in done.stderr  # the driver goes on


def test_the_monitor_tells_json(driver):
    with subprocess.Popen(
        [*PROGRAM, "monitor", "--json"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=driver.environment,
    ) as monitor:
        states = [json.loads(monitor.stdout.readline()) for _ in range(4)]
        monitor.send_signal(signal.SIGINT)
        assert monitor.wait(LIMIT_S) == 130
        assert "Traceback" not in monitor.stderr.read()
    assert {"say", "gesture", "pad", "actions", "slow"} <= set(states[0])
    assert [state["n"] for state in states] == sorted({state["n"] for state in states})


def test_the_game_finds_the_page_that_is_served(view):
    done = view.call("game", "--no-open")
    assert done.returncode == 0, done.stderr
    assert done.stdout == f"Spacecraft: {view.page('game')}\n"


def test_a_demo_says_its_links_and_takes_its_page_along(tmp_path):
    done = subprocess.run(
        [*PROGRAM, "demo", "--seconds", "1"],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "RUNTIME_DIRECTORY": str(tmp_path / "run")},
    )
    assert done.returncode == 0, done.stderr
    link = re.search(r"Watch it here: (http://127\.0\.0\.1:\d+/#k=[\w-]+)", done.stderr)[1]
    game = re.search(r"Play the spacecraft: (\S+)", done.stderr)[1]
    assert game == link.replace("/#", "/game#")
    assert done.stderr.rstrip().endswith("neurotouch game")
    assert not (tmp_path / "run" / "page.json").exists()


def test_a_page_that_hangs_ends_with_its_demo_and_leaves_no_address(tmp_path, monkeypatch):
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path / "run"))
    monkeypatch.setattr("neurotouch_hid.cli.demo_page._PATIENCE_S", 0.2)
    with open_page(""):
        pid = read_address().pid
        os.kill(pid, signal.SIGSTOP)
    with pytest.raises(ProcessLookupError):
        os.kill(pid, 0)
    assert list((tmp_path / "run").iterdir()) == []


def test_a_mouse_needs_its_page(tmp_path):
    done = subprocess.run(
        [*PROGRAM, "demo", "--mouse", "--no-page"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 2

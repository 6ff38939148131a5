"""The commands around the page: what they print, and how they end."""

import http.client
import json
import os
import re
import signal
import subprocess
import time
from pathlib import Path
from urllib.parse import urljoin, urlsplit

import pytest

from neurotouch_hid.cli.shared.demo_page import open_page
from neurotouch_hid.page.address import read_address
from tests.processes import LIMIT_S, PROGRAM, make_environment, run_neurotouch, start_neurotouch
from tests.waiting import wait_until

ROOT = Path(__file__).parents[2]


def test_the_monitor_waits_for_a_driver_as_long_as_it_may(tmp_path):
    words = ("monitor", "--plain", "--seconds", "0.5")
    done = run_neurotouch(*words, code=8, env=make_environment(tmp_path))
    assert done.stderr == (
        "No driver is running; waiting for one (Ctrl-C stops). Start it: neurotouch run. "
        "Without a camera: neurotouch demo\n"
        "Error: No driver has started.\nFix: Start it: neurotouch run. "
        "Without a camera: neurotouch demo\n"
    )


def test_the_monitor_shows_a_driver_that_starts_later(tmp_path):
    environment = make_environment(tmp_path)
    with start_neurotouch("monitor", "--plain", env=environment) as monitor:
        assert "waiting for one" in monitor.stderr.readline()
        options = ("--source", "sim:push", "--device", "memory", "--show", "nothing")
        run_neurotouch("run", *options, env=environment)
        said, _ = monitor.communicate(timeout=LIMIT_S)
    assert monitor.returncode == 0
    assert said.startswith("driver: running")


def test_the_monitor_tells_lines(driver):
    begins = ("hand: ", "health: 17", "latency: time slice 10 ms, tracker ")
    deadline = time.monotonic() + LIMIT_S
    with start_neurotouch("monitor", "--plain", env=driver.environment, stderr=None) as monitor:
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
    with start_neurotouch("monitor", "--json", env=driver.environment) as monitor:
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


def test_the_game_alone_serves_a_page_that_may_pause(tmp_path, monkeypatch):
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path / "run"))
    with subprocess.Popen([*PROGRAM, "game", "--no-open"], stdout=subprocess.PIPE) as process:
        try:
            assert b"/game#k=" in process.stdout.readline()
            assert read_address().may_edit
        finally:
            process.terminate()


def test_a_demo_says_its_links_and_takes_its_page_along(tmp_path):
    done = run_neurotouch("demo", "--seconds", "1", env=make_environment(tmp_path))
    link = re.search(r"Watch it here: (http://127\.0\.0\.1:\d+/#k=[\w-]+)", done.stderr)[1]
    game = re.search(r"Play the spacecraft: (\S+)", done.stderr)[1]
    assert game == link.replace("/#", "/game#")
    assert done.stderr.rstrip().endswith("The pad is neutral.")
    assert not (tmp_path / "run" / "page.json").exists()


def test_a_page_that_hangs_ends_with_its_demo_and_leaves_no_address(tmp_path, monkeypatch):
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path / "run"))
    monkeypatch.setattr("neurotouch_hid.cli.shared.demo_page._PATIENCE_S", 0.2)
    with open_page(""):
        pid = read_address().pid
        os.kill(pid, signal.SIGSTOP)
    with pytest.raises(ProcessLookupError):
        os.kill(pid, 0)
    assert list((tmp_path / "run").iterdir()) == []


def test_a_mouse_needs_its_page(tmp_path):
    run_neurotouch("demo", "--mouse", "--no-page", code=2)


def test_the_icon_opens_the_page_that_is_served_already(tmp_path, monkeypatch):
    shown = tmp_path / "shown"
    browser = tmp_path / "bin" / "xdg-open"
    browser.parent.mkdir()
    browser.write_text(f'#!/bin/sh\necho "$1" >> {shown}\n')
    browser.chmod(0o755)
    environment = make_desktop(browser)
    entry = (ROOT / "packaging/desktop/neurotouch-hid.desktop").read_text()
    arguments = re.search(r"^Exec=neurotouch (view .*)$", entry, re.MULTILINE)[1].split()
    assert "Terminal=false" in entry
    with start_neurotouch(*arguments, env=environment, stderr=None) as first:
        try:
            link = first.stdout.readline().split(": ", 1)[1].strip()
            second = run_neurotouch(*arguments, env=environment)
            found = [follow(each) for each in shown.read_text().split()]
        finally:
            first.terminate()
    assert second.stdout == f"Page: {link}\n"
    assert found == [link, link]


def test_the_page_is_served_while_xdg_open_is_the_browser(tmp_path):
    shown, browser = tmp_path / "shown", tmp_path / "bin/xdg-open"
    browser.parent.mkdir()
    # Under sway or i3 xdg-open starts the browser and waits for its end.
    browser.write_text(
        f'#!/bin/sh\necho "$$ $1" > {shown}.part && mv {shown}.part {shown}\nexec sleep 60\n'
    )
    browser.chmod(0o755)
    environment = make_desktop(browser)
    with start_neurotouch("view", "--open", env=environment, stderr=None) as process:
        try:
            link = process.stdout.readline().split(": ", 1)[1].strip()
            wait_until(shown.exists)
            pid, opened = shown.read_text().split()
            assert follow(opened) == link
        finally:
            process.terminate()
    os.kill(int(pid), signal.SIGTERM)  # the browser has outlived the page


def make_desktop(browser: Path) -> dict[str, str]:
    """The environment of a desktop on which this program opens links."""
    path = f"{browser.parent}:{os.environ['PATH']}"
    return make_environment(browser.parents[1]) | {"DISPLAY": ":9", "PATH": path}


def follow(link: str) -> str:
    """Where a browser gets to that was started with a link."""
    assert "#k=" not in link
    address = urlsplit(link)
    line = http.client.HTTPConnection(address.netloc, timeout=LIMIT_S)
    line.request("GET", address.path)
    location = line.getresponse().getheader("Location")
    line.close()
    return urljoin(link, location)


def test_without_a_browser_the_game_says_so_in_one_line(tmp_path):
    environment = {name: value for name, value in os.environ.items() if "DISPLAY" not in name}
    environment["RUNTIME_DIRECTORY"] = str(tmp_path / "run")
    with start_neurotouch("game", env=environment) as process:
        said = process.stderr.readline()
        process.kill()
    assert said == "No browser can be opened from here: open the link yourself.\n"


def test_on_a_desktop_the_name_alone_opens_the_page(tmp_path):
    shown, browser = tmp_path / "shown", tmp_path / "bin/xdg-open"
    browser.parent.mkdir()
    browser.write_text(f'#!/bin/sh\necho "$1" > {shown}.part && mv {shown}.part {shown}\n')
    browser.chmod(0o755)
    terminal, inside = os.openpty()
    environment = make_desktop(browser) | {"TERM": "xterm"}
    environment.pop("NT_ACCESSIBLE", None)
    with subprocess.Popen(PROGRAM, env=environment, stdout=inside, stderr=inside) as process:
        os.close(inside)
        wait_until(lambda: shown.exists() or process.poll() is not None)
        process.send_signal(signal.SIGINT)
        process.wait(LIMIT_S)
    said = os.read(terminal, 10_000).decode()
    os.close(terminal)
    assert "No camera found" in said
    link = shown.read_text()
    assert link.startswith("http://127.0.0.1:")
    assert link.partition("open/")[0] in said
    assert "#k=" not in link  # every user can read it among the browser's arguments

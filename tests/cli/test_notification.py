"""Without a terminal, a person is told on the desktop why nothing happens."""

import os
import re
import shutil
import socket
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from jeepney import HeaderFields, MessageType, message_bus, new_method_return
from jeepney.io.blocking import DBusConnection, Proxy, open_dbus_connection

from tests.desktop.programs import session_bus
from tests.processes import PROGRAM, make_environment, start_neurotouch

LIMIT_S = 60.0
SERVICE = "org.freedesktop.Notifications"
ENTRY = Path(__file__).parents[2] / "packaging/desktop/neurotouch-hid.desktop"
ACTIONS = re.findall(r"^Exec=neurotouch (?!view)(.*)$", ENTRY.read_text(), re.MULTILINE)


@pytest.fixture
def environment(tmp_path) -> Iterator[dict[str, str]]:
    """That of a desktop with a session bus, on which no program opens links."""
    for program in ("busctl", "dbus-daemon"):
        if shutil.which(program) is None:
            pytest.skip(f"{program} is not installed (Debian: apt install systemd dbus-daemon)")
    opener = tmp_path / "bin/xdg-open"
    opener.parent.mkdir()
    opener.write_text("#!/bin/sh\nexit 3\n")
    opener.chmod(0o755)
    with session_bus() as address:
        yield {
            **make_environment(tmp_path),
            "DBUS_SESSION_BUS_ADDRESS": address,
            "DISPLAY": ":9",
            "PATH": f"{opener.parent}:{os.environ['PATH']}",
        }


@pytest.fixture
def service(environment) -> Iterator[DBusConnection]:
    """Stands for the program that shows notifications."""
    with open_dbus_connection(environment["DBUS_SESSION_BUS_ADDRESS"]) as connection:
        assert Proxy(message_bus, connection).RequestName(SERVICE) == (1,)
        yield connection


def take_message(service: DBusConnection, limit_s: float = LIMIT_S) -> tuple:
    """Waits for a notification, and answers as the specification says; returns its arguments."""
    while True:
        message = service.receive(timeout=limit_s)
        if message.header.message_type is MessageType.method_call:
            break
    assert message.header.fields[HeaderFields.member] == "Notify"
    assert message.header.fields[HeaderFields.interface] == SERVICE
    assert message.header.fields[HeaderFields.path] == "/org/freedesktop/Notifications"
    service.send(new_method_return(message, "u", (1,)))
    return message.body


def start(environment: dict[str, str], *arguments: str) -> subprocess.Popen:
    return subprocess.Popen(
        [*PROGRAM, *arguments],
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )


def test_no_browser_is_told_on_the_desktop_without_the_secret(environment, service):
    with start(environment, "view", "--open", "--edit") as page:
        name, replaces, _, title, text, actions, hints, expires_ms = take_message(service)
        page.terminate()
    assert (name, replaces, actions, hints) == ("NeuroTouch", 0, [], {})
    assert expires_ms == 0  # who reads slowly has time
    assert "no browser opens" in title
    assert "Install one" in text
    assert "http" not in title + text


def test_a_page_that_cannot_be_served_is_told_too(environment, service):
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = str(other.getsockname()[1])
        with start(environment, "view", "--open", "--port", port) as page:
            title, text = take_message(service)[3:5]
            assert page.wait(LIMIT_S) == 1
    assert title == "NeuroTouch cannot start"
    assert port in text


@pytest.mark.parametrize("action", ACTIONS)
def test_the_icons_menu_tells_that_no_driver_runs(environment, service, action):
    with start(environment, *action.split()) as command:
        title, text = take_message(service)[3:5]
        assert command.wait(LIMIT_S) == 8
    assert title == "NeuroTouch cannot do this"
    assert text.startswith("No driver is running. ")
    assert len(ACTIONS) == 3


def test_a_script_shows_no_message(environment, service):
    with start(environment, "panic") as command:
        assert command.wait(LIMIT_S) == 8
    with pytest.raises(TimeoutError):
        take_message(service, limit_s=0.5)


def test_without_a_service_the_page_is_served_all_the_same(environment):
    with start_neurotouch("view", "--open", env=environment, stdout=None) as page:
        assert "No browser can be opened" in page.stderr.readline()
        assert page.poll() is None
        page.terminate()

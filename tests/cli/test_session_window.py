"""``neurotouch session`` tells a service which profile the window in front has."""

import os
import time

import pytest

from neurotouch_hid.cli.session import _Link
from neurotouch_hid.cli.session_window import WindowTeller, find_desktop
from neurotouch_hid.client import ask_status
from tests.cli.test_session import place  # noqa: F401  # a fixture
from tests.desktop.test_follower import Desktop
from tests.waiting import wait_until

APPLICATIONS = "version: 1\napplications: [{window: game, profile: racing}]\n"
NOBODY = "told by 'neurotouch session'"


def test_a_service_follows_the_windows_of_who_sits_there(place):  # noqa: F811
    desktop, own = Desktop(), os.getuid()
    file = place.values.with_name("driver.yaml")
    file.write_text(APPLICATIONS)
    place.seat(own)
    with place.serve(), WindowTeller(1, str, lambda: desktop) as teller:

        def wait_for(key: str, words: str) -> None:
            """Waits as the session does, which looks about once a second."""

            def look() -> bool:
                teller.look(time.monotonic())
                return words in ask_status()[key]

            wait_until(look)

        assert NOBODY in ask_status()["desktop"]
        desktop.front = ("Game",)
        wait_for("profile", "racing")
        wait_for("desktop", "Game is in front (Test)")
        desktop.front = ("editor",)
        wait_for("profile", "default")
        desktop.front = ("Game",)
        wait_for("profile", "racing")
        place.seat(own + 1)  # who leaves is not believed any more
        wait_for("profile", "default")
        wait_for("desktop", NOBODY)
        place.seat(own)
        wait_for("profile", "racing")
        file.unlink()  # now the session tells nothing, and the service forgets it soon
        wait_for("profile", "default")
        assert desktop.closed == 1


@pytest.fixture
def teller(tmp_path, monkeypatch):
    """A teller without any driver; and what it has said and opened."""
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path))
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    monkeypatch.setenv("CONFIGURATION_DIRECTORY", str(tmp_path / "machine"))
    (tmp_path / "neurotouch").mkdir()
    (tmp_path / "machine").mkdir()
    said, desktop = [], Desktop()
    with WindowTeller(1, said.append, lambda: desktop) as made:
        yield made, tmp_path, said, desktop


def test_a_file_with_errors_is_said_once(teller):
    made, folder, said, _ = teller
    (folder / "neurotouch/driver.yaml").write_text("version: 1\napplications: [{window: game}]\n")
    made.look(0.0)
    made.look(1.0)
    (sentence,) = said
    assert "no profile follows a window" in sentence
    assert "driver.yaml" in sentence


def test_the_session_looks_at_the_file(teller):
    _, folder, _, _ = teller
    said = []
    with _Link(1, lambda _: True, said.append) as link:
        (folder / "neurotouch/driver.yaml").write_text("version: 1\napplications: game\n")
        link.look(0.0)
    assert "no profile follows a window" in said[0]


def test_the_machine_s_applications_apply_to_who_has_none(teller):
    made, folder, _, desktop = teller
    (folder / "machine/driver.yaml").write_text(APPLICATIONS)
    made.look(0.0)
    (folder / "neurotouch/driver.yaml").write_text("version: 1\n")
    made.look(1.0)
    assert desktop.closed == 1  # the person's own file counts, and names none


def test_a_desktop_that_starts_after_the_session_is_found(tmp_path, monkeypatch):
    systemctl = tmp_path / "systemctl"
    systemctl.write_text(
        "#!/bin/sh\nprintf 'LANG=C\\nWAYLAND_DISPLAY=wayland-1\\nSWAYSOCK=/run/sway.sock\\n'\n"
    )
    systemctl.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    assert find_desktop({"HOME": "/home/x"}) == {
        "HOME": "/home/x",
        "WAYLAND_DISPLAY": "wayland-1",
        "SWAYSOCK": "/run/sway.sock",
    }
    assert find_desktop({"DISPLAY": ":0"}) == {"DISPLAY": ":0"}
    systemctl.unlink()
    assert find_desktop({}) == {}

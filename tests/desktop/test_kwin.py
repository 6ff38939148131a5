"""The real KWin without a screen: profiles follow its windows, and it may be started again."""

import os
import shutil
import time
from pathlib import Path

import pytest

from neurotouch_hid.desktop import Follower, follower, open_window
from neurotouch_hid.desktop.session_bus import find_kwin_script
from neurotouch_hid.errors import DesktopError
from tests.desktop.programs import (
    Compositor,
    Program,
    find_without_rights,
    session_bus,
    skip,
)
from tests.waiting import wait_until

pytest.importorskip("jeepney")
SCRIPT = Path(__file__).parents[2] / "packaging/windows/kwin-windows.js"
FAST_ENOUGH_S = 0.3


@pytest.fixture
def desktop(tmp_path, monkeypatch):
    """A KWin of this test's own; the driver's environment."""
    program = find_without_rights("kwin_wayland", tmp_path)
    if program is None or shutil.which("dbus-daemon") is None:
        skip("KWin is not installed (Debian: apt install kwin-wayland dbus-daemon)")
    runtime = tmp_path / "runtime"
    runtime.mkdir(mode=0o700)
    with session_bus() as address:
        environment = {
            **{key: os.environ[key] for key in ("PATH", "LANG") if key in os.environ},
            "HOME": str(tmp_path),
            "XDG_RUNTIME_DIR": str(runtime),
            "DBUS_SESSION_BUS_ADDRESS": address,
            "WAYLAND_DISPLAY": "wayland-nt",
            "XDG_CURRENT_DESKTOP": "KDE",
            "KWIN_COMPOSE": "Q",
            "QT_FORCE_STDERR_LOGGING": "1",
        }
        monkeypatch.setenv("DBUS_SESSION_BUS_ADDRESS", address)
        command = [program, "--virtual", "--no-lockscreen", "--socket", "wayland-nt"]
        compositor = Compositor(command, environment, tmp_path / "kwin.log")
        yield compositor
        compositor.end()


@pytest.fixture
def installed(desktop):
    """The same, where 'neurotouch setup --windows' has been."""
    script = find_kwin_script(desktop.environment)
    script.parent.mkdir(parents=True)
    shutil.copy(SCRIPT, script)
    return desktop


def open_patiently(environment):
    """Connects as the follower does: KWin's socket is there a moment before its bus name."""
    deadline = time.monotonic() + 30.0
    while True:
        try:
            return open_window(environment)
        except DesktopError:
            if time.monotonic() > deadline:
                raise
            time.sleep(0.1)


def test_active_window_is_told_and_nothing_is_left_in_kwin(installed):
    window = open_patiently(installed.environment)
    game = Program(installed.environment, "org.example.game")
    wait_until(lambda: window.names()[:1] == ("org.example.game",))
    editor = Program(installed.environment, "org.example.editor")
    wait_until(lambda: window.names()[:1] == ("org.example.editor",))
    editor.close()
    wait_until(lambda: window.names()[:1] == ("org.example.game",))
    game.close()
    wait_until(lambda: window.names() == ())
    assert list((Path(installed.environment["XDG_RUNTIME_DIR"])).glob("*.js"))
    window.close()
    assert not list((Path(installed.environment["XDG_RUNTIME_DIR"])).glob("*.js"))


def test_profile_follows_in_time_and_after_a_restart_of_kwin(installed, monkeypatch):
    monkeypatch.setattr(follower, "AGAIN_S", 0.2)
    told: list[tuple[float, str | None]] = []
    follow = Follower(
        {"org.example.game": "racing"},
        lambda: open_window(installed.environment),
        lambda name: told.append((time.monotonic(), name)),
    )
    try:
        wait_until(lambda: "no window" in follow.describe(), follow.describe)
        game = Program(installed.environment, "org.example.game")
        wait_until(lambda: told, follow.describe)
        assert told[0][1] == "racing"
        wait_until(lambda: game.active_s is not None)
        print(f"followed after {told[0][0] - game.active_s:.3f} s")
        assert told[0][0] - game.active_s <= FAST_ENOUGH_S

        installed.end()
        wait_until(lambda: "KDE" in follow.describe() and "front" not in follow.describe())
        game.close()
        installed.start()
        wait_until(lambda: "no window" in follow.describe(), follow.describe)
        game = Program(installed.environment, "org.example.game")
        wait_until(lambda: "game" in follow.describe(), follow.describe)
        wait_until(lambda: told[-1][1] == "racing")
        game.close()
    finally:
        follow.close()


def test_without_the_script_it_says_how_to_install_it(desktop):
    with pytest.raises(DesktopError) as caught:
        open_window(desktop.environment)
    assert "setup --windows" in caught.value.hint

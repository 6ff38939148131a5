"""The real GNOME Shell without a screen, with our extension, installed as a person installs it."""

import os
import re
import shutil
import subprocess
import time
from pathlib import Path

import pytest
from click.testing import CliRunner

from neurotouch_hid.cli import setup
from neurotouch_hid.desktop import Follower, follower, open_window
from neurotouch_hid.errors import DesktopError
from tests.desktop.programs import Compositor, Program, session_bus
from tests.processes import run_command
from tests.waiting import wait_until

pytest.importorskip("jeepney")
FAST_ENOUGH_S = 0.3
OLDEST = 45  # its extensions are modules; those of 44 and earlier are not


def find_version() -> int:
    if shutil.which("gnome-shell") is None:
        return 0
    said = run_command("gnome-shell", "--version")
    found = re.search(r"(\d+)", said.stdout)
    return int(found[1]) if found else 0


@pytest.fixture
def environment(tmp_path, monkeypatch):
    """A person's environment under GNOME, on a session bus of this test's own."""
    if shutil.which("gsettings") is None or shutil.which("dbus-daemon") is None:
        pytest.skip("gsettings or dbus-daemon is not installed")
    if find_version() < OLDEST:
        pytest.skip("GNOME Shell 45 or later is not installed (Debian 13: apt install gnome-shell)")
    (tmp_path / "runtime").mkdir(mode=0o700)
    with session_bus() as address:
        environment = {
            **{key: os.environ[key] for key in ("PATH", "LANG") if key in os.environ},
            "HOME": str(tmp_path),
            "XDG_CONFIG_HOME": str(tmp_path / ".config"),
            "XDG_RUNTIME_DIR": str(tmp_path / "runtime"),
            "DBUS_SESSION_BUS_ADDRESS": address,
            # It does not start without one; this one has none of the system's services.
            "DBUS_SYSTEM_BUS_ADDRESS": address,
            "GSETTINGS_BACKEND": "keyfile",
            "WAYLAND_DISPLAY": "wayland-nt",
            "XDG_CURRENT_DESKTOP": "GNOME",
        }
        monkeypatch.setenv("DBUS_SESSION_BUS_ADDRESS", address)
        yield environment


def run_setup(environment, *options: str) -> None:
    names = dict.fromkeys(("XDG_DATA_HOME", "DISPLAY"))
    done = CliRunner().invoke(
        setup.command, ["--windows", "--yes", *options], env={**names, **environment}
    )
    assert done.exit_code == 0, done.output


def list_files(folder: Path) -> list[str]:
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())


@pytest.fixture
def shell(environment, tmp_path):
    """A GNOME Shell with our extension installed."""
    run_setup(environment)
    command = ["gnome-shell", "--no-x11", "--headless", "--virtual-monitor", "640x480"]
    shell = Compositor(
        [*command, "--wayland-display", environment["WAYLAND_DISPLAY"]],
        environment,
        tmp_path / "shell.log",
    )
    yield shell
    shell.end()


def leave_overview(shell: Compositor) -> None:
    """Leaves the overview, with which a session begins, as a person does.

    GNOME Shell 50 brings no window to the front before.
    """
    to = ["gdbus", "call", "--session", "--dest", "org.gnome.Shell"]
    to += ["--object-path", "/org/gnome/Shell", "--method", "org.freedesktop.DBus.Properties.Set"]
    what = ["org.gnome.Shell", "OverviewActive", "<false>"]
    subprocess.run([*to, *what], env=shell.environment, check=True, stdout=subprocess.DEVNULL)


def test_profile_follows_in_time_and_after_a_restart_of_the_shell(shell, monkeypatch):
    monkeypatch.setattr(follower, "AGAIN_S", 0.2)
    told: list[tuple[float, str | None]] = []
    follow = Follower(
        {"org.example.game": "racing"},
        lambda: open_window(shell.environment),
        lambda name: told.append((time.monotonic(), name)),
    )
    try:
        wait_until(lambda: "no window" in follow.describe(), follow.describe)
        leave_overview(shell)
        game = Program(shell.environment, "org.example.game")
        wait_until(lambda: told, follow.describe)
        assert told[0][1] == "racing"
        wait_until(lambda: game.active_s is not None)
        print(f"followed after {told[0][0] - game.active_s:.3f} s")
        assert told[0][0] - game.active_s <= FAST_ENOUGH_S
        game.close()
        wait_until(lambda: told[-1][1] is None, follow.describe)

        shell.end()
        wait_until(lambda: "GNOME" in follow.describe() and "front" not in follow.describe())
        # A shell that crashes within its first minute switches all extensions off with this file.
        (Path(shell.environment["XDG_RUNTIME_DIR"]) / "gnome-shell-disable-extensions").unlink(
            missing_ok=True
        )
        shell.start()
        wait_until(lambda: "no window" in follow.describe(), follow.describe)
        leave_overview(shell)
        game = Program(shell.environment, "org.example.game")
        wait_until(lambda: told[-1][1] == "racing", follow.describe)
        game.close()
    finally:
        follow.close()


def test_extension_is_switched_off_and_gone_after_uninstalling(shell, tmp_path):
    deadline = time.monotonic() + 30.0
    while True:
        try:
            open_window(shell.environment).close()
            break
        except DesktopError:
            assert time.monotonic() < deadline
            time.sleep(0.1)
    run_setup(shell.environment, "--uninstall")
    with pytest.raises(DesktopError, match="GNOME does not tell"):
        open_window(shell.environment)
    assert not [each for each in list_files(tmp_path) if "neurotouch" in each]
    said = run_command(
        "gsettings", "get", "org.gnome.shell", "enabled-extensions", env=shell.environment
    )
    assert said.stdout.strip() == "@as []"


def test_extension_that_does_not_run_yet_is_explained(shell):
    """As between installing it and the next login."""
    subprocess.run(
        ["gsettings", "reset", "org.gnome.shell", "enabled-extensions"],
        env=shell.environment,
        check=True,
    )

    def tell() -> str:
        try:
            open_window(shell.environment).close()
        except DesktopError as error:
            return f"{error.message} {error.hint}"
        return ""

    wait_until(lambda: "Log out" in tell(), tell)

"""Other programs, found by running or installing something that is called like them."""

import shutil
import subprocess
import time
from contextlib import contextmanager

import pytest

from neurotouch_hid.doctor import programs
from neurotouch_hid.doctor.finding import CheckStatus
from tests.waiting import wait_until


@contextmanager
def running(tmp_path, name, *, script=False):
    """A real process of this name; as a script, its name is that of the file."""
    program = tmp_path / name
    if script:
        program.write_text("import time\ntime.sleep(60)\n")
        command = [shutil.which("python3"), str(program)]
    else:
        shutil.copy(shutil.which("sleep"), program)
        command = [str(program), "60"]
    process = subprocess.Popen(command)
    try:
        yield process
    finally:
        process.kill()
        process.wait()


def look_until(check, status):
    """What the check says once it says so; a process needs a moment to take its name."""
    return wait_until(lambda: (finding := check()).status is status and finding, check)


def test_steam(tmp_path):
    with running(tmp_path, "steam"):
        assert "twice" in look_until(programs.check_steam, CheckStatus.WARNING).sentence
    look_until(programs.check_steam, CheckStatus.OK)


@pytest.mark.parametrize(
    ("name", "script", "shown"),
    [("keyd", False, "keyd"), ("input-remapper-service", True, "input-remapper")],
)
def test_a_remapper_is_named(tmp_path, name, script, shown):
    with running(tmp_path, name, script=script) as process:
        finding = look_until(programs.check_remappers, CheckStatus.WARNING)
        assert f"{shown} (PID {process.pid})" in finding.sentence


def test_a_file_that_is_called_so_is_no_remapper(tmp_path):
    """An editor with keyd's source open."""
    (tmp_path / "keyd").touch()
    shutil.copy(shutil.which("tail"), tmp_path / "editor")
    process = subprocess.Popen([tmp_path / "editor", "keyd", "-f"], cwd=tmp_path)
    try:
        time.sleep(0.2)
        assert process.poll() is None
        assert programs.check_remappers().status is CheckStatus.OK
    finally:
        process.kill()
        process.wait()


@pytest.fixture
def flatpaks(tmp_path):
    def install(app, devices):
        folder = tmp_path / "flatpak/app" / app / "current/active"
        folder.mkdir(parents=True)
        (folder / "metadata").write_text(f"[Application]\nname={app}\n\n[Context]\n{devices}\n")

    return install


def look(tmp_path):
    return programs.check_sandboxes((tmp_path / "flatpak",), tmp_path / "snap", tmp_path / "home")


@pytest.mark.parametrize("devices", ["devices=all;", "devices=dri;input;"])
def test_a_sandbox_with_devices_is_open(tmp_path, flatpaks, devices):
    flatpaks("com.valvesoftware.Steam", devices)
    assert look(tmp_path).status is CheckStatus.OK


@pytest.mark.parametrize("devices", ["devices=dri;", "sockets=x11;", "garbage"])
def test_a_sandbox_without_is_named_with_its_command(tmp_path, flatpaks, devices):
    flatpaks("org.mozilla.firefox", devices)
    finding = look(tmp_path)
    assert finding.status is CheckStatus.WARNING
    assert "Firefox" in finding.sentence
    assert finding.commands == ("flatpak override --user --device=all org.mozilla.firefox",)


def test_what_the_person_has_given_counts(tmp_path, flatpaks):
    flatpaks("org.mozilla.firefox", "devices=dri;")
    overrides = tmp_path / "home/.local/share/flatpak/overrides"
    overrides.mkdir(parents=True)
    (overrides / "org.mozilla.firefox").write_text("[Context]\ndevices=all;\n")
    assert look(tmp_path).status is CheckStatus.OK


def test_a_snap(tmp_path):
    (tmp_path / "snap/firefox").mkdir(parents=True)
    assert look(tmp_path).commands == ("sudo snap connect firefox:joystick",)


def test_gnome_that_filters_keys(tmp_path, monkeypatch):
    (tmp_path / "gsettings").write_text(
        '#!/bin/sh\n[ "$3" = slowkeys-enable ] && echo true || echo false\n'
    )
    (tmp_path / "gsettings").chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=":")
    monkeypatch.setenv("XDG_CURRENT_DESKTOP", "ubuntu:GNOME")
    finding = programs.check_desktop()
    assert finding.status is CheckStatus.WARNING
    assert "slow keys switched on" in finding.sentence


def test_kde_that_filters_keys(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("XDG_CURRENT_DESKTOP", "KDE")
    assert programs.check_desktop().status is CheckStatus.OK
    (tmp_path / ".config").mkdir()
    (tmp_path / ".config/kaccessrc").write_text("[Keyboard]\nBounceKeys=true\nSlowKeys=false\n")
    assert "bounce keys switched on" in programs.check_desktop().sentence

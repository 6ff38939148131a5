"""``neurotouch setup`` says what it will do before it does it; tests/system has it do it."""

import os
import shutil
import subprocess
import sys
from pathlib import Path
from textwrap import dedent

import pytest
from click.testing import CliRunner, Result

from neurotouch_hid.cli import setup
from neurotouch_hid.driver import Driver
from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.gesture.elastic.kernels.recognize import recognize
from neurotouch_hid.source.davis.kernels.decode import decode
from neurotouch_hid.source.simulator.kernels.sensor import run_sensor
from tests.waiting import wait_until

ROOT = Path(__file__).parents[2]


def run(*options: str, answer: str = "", path: Path | None = None) -> Result:
    """Runs it, with the programs in this folder in place of the system's."""
    env = {"PATH": str(path)} if path else {}
    return CliRunner().invoke(setup.command, options, input=answer, env=env)


@pytest.fixture
def programs(tmp_path, monkeypatch) -> Path:
    """A folder of programs that note how they are called, in place of the system's."""
    monkeypatch.setattr(setup, "UDEV", tmp_path)
    noted = tmp_path / "noted"
    for name in ("udevadm", "sudo", "sh"):
        program = tmp_path / "bin" / name
        program.parent.mkdir(exist_ok=True)
        program.write_text(f'#!/bin/sh\nfor w in {name} "$@"; do echo "$w"; done >> {noted}\n')
        program.chmod(0o755)
    return program.parent


def test_a_dry_run_says_each_file_and_each_command():
    said = run("--dry-run")
    assert said.exit_code == 0
    for file in ("70-neurotouch-uinput.rules", "70-neurotouch-camera.rules", "neurotouch.conf"):
        assert file in said.output
    assert "modprobe uinput" in said.output
    assert "udevadm control --reload" in said.output


def test_what_it_runs_is_what_it_said(programs):
    said = run("--yes", path=programs)
    assert said.exit_code == 0, said.output
    shown = said.output.partition("as root:\n")[2].partition("Then the program")[0]
    noted = (programs.parent / "noted").read_text()
    start = noted.index("install")
    assert noted[start:] == dedent(shown)
    assert noted[:start].split() in (["sh", "-euc"], ["sudo", "sh", "-euc"])


def test_it_compiles_what_a_first_start_would(programs):
    said = run("--yes", path=programs)
    assert said.output.endswith("half a minute or more) ...\nDone. Check with: neurotouch doctor\n")
    assert recognize.n_variants
    assert decode.n_variants
    assert run_sensor.n_variants  # of a demo


@pytest.mark.parametrize(
    ("options", "uid"), [(("--dry-run",), 1000), (("--yes", "--uninstall"), 1000), (("--yes",), 0)]
)
def test_it_compiles_only_for_the_person_who_will_play(
    programs, folders, monkeypatch, options, uid
):
    (folders[1] / "neurotouch.conf").touch()
    monkeypatch.setenv("SUDO_UID", "1000")
    monkeypatch.setattr(setup.os, "geteuid", lambda: uid)
    monkeypatch.setattr(Driver, "compile", lambda _: pytest.fail("compiled"))
    said = run(*options, path=programs)
    assert said.exit_code == 0, said.output


def test_what_cannot_be_compiled_now_is_left_to_the_first_start(programs, monkeypatch):
    def refuse(_: Driver) -> None:
        raise NeuroTouchError("The gel's file is damaged.")

    monkeypatch.setattr(Driver, "compile", refuse)
    said = run("--yes", path=programs)
    assert said.exit_code == 0, said.output
    assert "is damaged. This will be done at the first start instead.\nDone." in said.output


def test_root_reads_no_file_of_ours_and_the_text_is_shown(tmp_path):
    shown = run("--dry-run").output.partition("as root:\n")[2].partition("Then the program")[0]
    assert str(ROOT) not in shown
    copies = dedent(shown).partition("modprobe")[0].replace("/etc/", f"{tmp_path}/etc/")
    subprocess.run(["sh", "-euc", copies], check=True)
    for source in (
        ROOT / "udev/70-neurotouch-uinput.rules",
        ROOT / "udev/70-neurotouch-camera.rules",
        ROOT / "packaging/modules-load.d/neurotouch.conf",
    ):
        (installed,) = tmp_path.rglob(source.name)
        assert installed.read_bytes() == source.read_bytes()
        assert installed.stat().st_mode & 0o777 == 0o644


@pytest.fixture
def person(tmp_path, monkeypatch) -> Path:
    """The data folder of a person who is not root; its path needs every kind of quoting."""
    monkeypatch.setattr(os, "geteuid", lambda: 1000)
    programs = tmp_path / r'my $programs \ "new"' / "bin"
    programs.mkdir(parents=True)
    (programs / "neurotouch").write_text(
        '#!/bin/sh\necho "$*" > "$STARTED.part" && mv "$STARTED.part" "$STARTED"\n'
    )
    (programs / "neurotouch").chmod(0o755)
    monkeypatch.setattr(sys, "prefix", str(programs.parent))
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    monkeypatch.setenv("XDG_DATA_DIRS", str(tmp_path / "system"))
    return tmp_path / "data"


def test_a_person_gets_an_entry_in_the_menu_and_can_take_it_back(person, folders, programs):
    entry = person / "applications/neurotouch-hid.desktop"
    assert str(entry) in run("--dry-run").output
    assert not entry.exists()
    assert run("--yes", path=programs).exit_code == 0
    lines = entry.read_text().splitlines()
    started = [line.partition("=")[2] for line in lines if line.startswith("Exec=")]
    assert len(started) == 4
    assert not [line for line in started if line.startswith("neurotouch")]
    told = run("--uninstall", "--yes")
    assert told.exit_code == 0
    assert str(entry) in told.output
    assert "as root" not in told.output
    assert not person.joinpath("applications").exists()


def test_the_entry_is_valid_and_starts_this_installation(person, programs, tmp_path):
    check, gio = shutil.which("desktop-file-validate"), shutil.which("gio")
    if check is None or gio is None:
        pytest.skip("needs Debian's packages desktop-file-utils and libglib2.0-bin")
    assert run("--yes", path=programs).exit_code == 0
    entry = person / "applications/neurotouch-hid.desktop"
    subprocess.run([check, str(entry)], check=True)
    environment = {**os.environ, "STARTED": str(tmp_path / "started")}
    subprocess.run([gio, "launch", str(entry)], env=environment, check=True, timeout=60)
    wait_until((tmp_path / "started").exists)
    assert (tmp_path / "started").read_text() == "view --open --edit\n"
    # Once pipx has removed the program, the menu leaves the entry out.
    (try_exec,) = (line for line in entry.read_text().splitlines() if line.startswith("TryExec="))
    named = try_exec.partition("=")[2].replace("\\\\", "\\")
    assert named == str(Path(sys.prefix, "bin", "neurotouch"))


def test_where_a_package_has_brought_the_entry_setup_adds_none(person, programs):
    brought = person.parent / "system/applications/neurotouch-hid.desktop"
    brought.parent.mkdir(parents=True)
    brought.touch()
    assert "neurotouch-hid.desktop" not in run("--dry-run").output


def test_root_gets_no_entry(person, monkeypatch):
    monkeypatch.setattr(os, "geteuid", lambda: 0)
    assert "neurotouch-hid.desktop" not in run("--dry-run").output


@pytest.fixture
def folders(tmp_path, monkeypatch) -> list[Path]:
    """Folders in place of those in /etc."""
    found = [tmp_path / "etc/udev", tmp_path / "etc/modules"]
    for name, folder in zip(("_RULES", "_MODULES"), found, strict=True):
        folder.mkdir(parents=True)
        monkeypatch.setattr(setup, name, folder)
    return found


def test_only_what_is_there_is_removed(folders):
    nothing = CliRunner().invoke(setup.command, ["--uninstall", "--yes"])
    assert nothing.exit_code == 0
    assert nothing.output == "Setup has installed nothing here, so there is nothing to remove.\n"
    there = folders[1] / "neurotouch.conf"
    there.touch()
    told = CliRunner().invoke(setup.command, ["--uninstall", "--dry-run"]).output
    assert f"rm -f {there}\n" in told
    assert "70-neurotouch" not in told


def test_it_can_all_be_taken_back(folders):
    installed = CliRunner().invoke(setup.command, ["--dry-run"]).output
    for source, target in setup._list_files().items():
        target.write_bytes(source.read_bytes())
    removed = CliRunner().invoke(setup.command, ["--uninstall", "--dry-run"]).output
    assert installed.count(f"  {folders[0].parent}/") == 3
    for line in installed.splitlines():
        if line.startswith(f"  {folders[0].parent}/"):
            assert line.strip() in removed
            assert line.strip() in next(x for x in removed.splitlines() if "rm -f" in x)


@pytest.mark.parametrize("answer", ["n\n", ""])
def test_without_a_yes_nothing_is_done(programs, answer):
    said = run(answer=answer, path=programs)
    assert said.exit_code != 0
    assert not (programs.parent / "noted").exists()


def test_where_no_udev_runs_it_says_so(programs, monkeypatch):
    monkeypatch.setattr(setup, "UDEV", programs / "not-there")
    said = run("--yes", path=programs)
    assert str(said.exception).startswith("No udev runs here")
    assert not (programs.parent / "noted").exists()


def test_where_the_service_has_the_rights_nothing_is_installed(programs, monkeypatch):
    monkeypatch.setattr(setup, "has_service", lambda: True)
    said = run("--yes", path=programs)
    assert "its service has all the rights" in str(said.exception)
    assert not (programs.parent / "noted").exists()


def test_a_command_that_fails_is_not_hidden(programs):
    for name in ("sh", "sudo"):
        (programs / name).write_text("#!/bin/sh\nexit 3\n")
    said = run("--yes", path=programs)
    assert "exit code 3" in str(said.exception)
    assert "Done" not in said.output

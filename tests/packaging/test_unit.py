"""The service's unit, as systemd reads it."""

import os
import re
import shlex
import shutil
import subprocess
from pathlib import Path

import click
import pytest

from neurotouch_hid.errors import DriverError, ProfileError
from neurotouch_hid.players import find_runtime_folder, find_socket, list_players
from tests.processes import run_command

ROOT = Path(__file__).parents[2]
UNIT = ROOT / "packaging/systemd/neurotouch.service"
SESSION = ROOT / "packaging/systemd/neurotouch-session.service"
DROP_INS = sorted((ROOT / "packaging/systemd").glob("*/*.conf"))
THRESHOLD = 10
"""Of 100 points of exposure."""

needs_systemd = pytest.mark.skipif(
    not shutil.which("systemd-analyze"), reason="systemd-analyze is not installed"
)


def analyze(*arguments: str) -> subprocess.CompletedProcess[str]:
    return run_command("systemd-analyze", *arguments, code=None)


def find_version() -> int:
    return int(analyze("--version").stdout.split()[1])


@needs_systemd
@pytest.mark.parametrize("drop_in", [None, *DROP_INS], ids=lambda path: path.name if path else "-")
def test_systemd_finds_nothing_wrong(tmp_path, drop_in):
    for word, since in (("OpenFile", 253), ("RestartSteps", 254)):
        if drop_in is not None and word in drop_in.read_text() and find_version() < since:
            pytest.skip(f"{word}= is known from systemd {since} on")
    unit = tmp_path / UNIT.name
    # The program and the user are not on this machine.
    unit.write_text(re.sub(r"/usr/bin/neurotouch.*", "/bin/true", UNIT.read_text()))
    if drop_in is not None:
        folder = tmp_path / f"{UNIT.name}.d"
        folder.mkdir()
        shutil.copy(drop_in, folder)
    done = analyze("verify", "--man=no", str(unit))
    # systemd looks into every other unit of the machine as well.
    said = [line for line in done.stderr.splitlines() if str(tmp_path) in line]
    assert not said


def make_template() -> str:
    """The unit of another player, as the package's build makes it."""
    script = UNIT.parent / "players.sed"
    done = run_command("sed", "-f", script, UNIT)
    return done.stdout


@needs_systemd
def test_systemd_finds_nothing_wrong_with_another_players(tmp_path):
    unit = tmp_path / "neurotouch@.service"
    unit.write_text(re.sub(r"/usr/bin/neurotouch.*", "/bin/true", make_template()))
    done = analyze("verify", "--man=no", str(tmp_path / "neurotouch@2.service"))
    assert not [line for line in done.stderr.splitlines() if str(tmp_path) in line]


def test_another_player_has_folders_of_their_own_and_the_same_limits():
    ours, theirs = UNIT.read_text().splitlines(), make_template().splitlines()
    changed = [line for line in theirs if line not in ours]
    assert "RuntimeDirectory=neurotouch-%i" in changed
    assert "StateDirectory=neurotouch-%i" in changed
    assert "Environment=NEUROTOUCH_PLAYER=%i" in changed
    assert "WantedBy=multi-user.target" in changed
    assert "After=neurotouch.service" in changed  # not both at once
    assert len(changed) == 8


@pytest.mark.parametrize("player", [1, 2])
def test_a_reload_of_one_players_service_leaves_the_others_alone(tmp_path, monkeypatch, player):
    """``ExecReload`` runs in the environment of the unit."""
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path / "neurotouch"))
    for each in (1, 2):
        folder = find_runtime_folder(each)
        folder.mkdir()
        find_socket(folder).touch()
    text = UNIT.read_text() if player == 1 else make_template().replace("%i", "2")
    for name, value in re.findall(r"(NEUROTOUCH_\w+)=(\S+)", text):
        monkeypatch.setenv(name, value)
    assert list_players() == [player]


@needs_systemd
def test_systemd_finds_nothing_wrong_with_the_unit_of_a_session(tmp_path):
    unit = tmp_path / SESSION.name
    unit.write_text(re.sub(r"/usr/bin/neurotouch.*", "/bin/true", SESSION.read_text()))
    done = analyze("verify", "--man=no", "--user", str(unit))
    assert not [line for line in done.stderr.splitlines() if str(tmp_path) in line]


def test_a_session_leaves_alone_what_others_need():
    text = SESSION.read_text()
    assert "KillMode=process" in text  # spd-say may have started everybody's speech server
    assert "ConditionUser=!@system" in text  # the login screen is at the seat too
    assert "RestartPreventExitStatus=75" in text
    assert "WantedBy=default.target" in text


@needs_systemd
def test_the_exposure_is_small(tmp_path):
    unit = shutil.copy(UNIT, tmp_path)  # away from the drop-ins, of which one is for others
    done = analyze("security", "--offline=true", f"--threshold={THRESHOLD}", str(unit))
    assert done.returncode == 0, done.stdout[-300:]


def test_what_would_make_it_deaf_or_blind_is_not_there():
    text = UNIT.read_text()
    for wrong in ("PrivateNetwork=yes", "PrivateDevices=yes", "MemoryDenyWriteExecute=yes"):
        assert wrong not in text
    assert re.search(r"^RestrictAddressFamilies=.*AF_NETLINK", text, re.MULTILINE)


def test_those_who_come_to_the_socket_can_be_told_apart():
    assert "PrivateUsers=yes" not in UNIT.read_text()


def test_it_is_never_stranded():
    text = UNIT.read_text()
    assert "StartLimitIntervalSec=0" in text
    assert "Restart=always" in text


def test_a_fault_that_a_restart_cannot_mend_is_not_tried_again_and_others_ever_more_slowly():
    text = UNIT.read_text()
    lasting = {click.UsageError.exit_code, ProfileError.exit_code, DriverError.exit_code}
    (codes,) = re.findall(r"^RestartPreventExitStatus=(.*)$", text, re.MULTILINE)
    assert {int(code) for code in codes.split()} == lasting
    slower = (UNIT.parent / "neurotouch.service.d/restart-ever-later.conf").read_text()
    assert re.search(r"^RestartSteps=\d+\nRestartMaxDelaySec=60$", slower, re.MULTILINE)


def test_nobody_gets_uinput_by_a_group():
    text = UNIT.read_text() + "".join(path.read_text() for path in DROP_INS)
    assert "SupplementaryGroups" not in text
    assert "Group=" not in text


LENDING = [path for path in DROP_INS if "setfacl -m" in path.read_text()]
FAKE_SETFACL = """#!/bin/sh
case "$1" in -m) touch "$3";; -x) rm "$3";; esac
"""


class Lent:
    """Runs the commands around the starts of players as systemd does, with files of its own."""

    def __init__(self, drop_in: Path, folder: Path) -> None:
        (folder / "dev").mkdir()
        (folder / "run").mkdir()
        (folder / "setfacl").write_text(FAKE_SETFACL)
        (folder / "setfacl").chmod(0o755)
        self.folder = folder
        (self.node,) = set(
            re.findall(r"/dev/(u\w+)", "".join(re.findall(".*setfacl.*", drop_in.read_text())))
        )
        self.lines = re.findall(r"^Exec(\w+)=\+-?(.*setfacl.*)$", drop_in.read_text(), re.MULTILINE)

    def run(self, phase: str, player: str) -> None:
        (line,) = (line for name, line in self.lines if name == phase)
        line = line.replace("%n", f"neurotouch{player}.service")
        line = line.replace("/run/", f"{self.folder}/run/").replace(
            "/dev/u", f"{self.folder}/dev/u"
        )
        path = f"{self.folder}:{os.environ['PATH']}"
        done = run_command(*shlex.split(line), env={"PATH": path})
        assert done.stdout + done.stderr == ""

    @property
    def may_open(self) -> bool:
        return (self.folder / "dev" / self.node).exists()


@pytest.mark.parametrize("drop_in", LENDING, ids=lambda path: path.name)
def test_a_right_that_is_lent_is_taken_back(tmp_path, drop_in):
    lent = Lent(drop_in, tmp_path)
    lent.run("StartPre", "")
    assert lent.may_open
    lent.run("StartPost", "")
    assert not lent.may_open
    lent.run("StopPost", "")
    assert not lent.may_open
    lent.run("StartPre", "")  # a start that fails
    lent.run("StopPost", "")
    assert not lent.may_open
    assert list((tmp_path / "run").iterdir()) == [tmp_path / f"run/neurotouch-{lent.node}.lock"]


@pytest.mark.parametrize("drop_in", LENDING, ids=lambda path: path.name)
def test_players_that_start_at_once_do_not_take_the_right_from_each_other(tmp_path, drop_in):
    lent = Lent(drop_in, tmp_path)
    lent.run("StartPre", "@2")
    lent.run("StartPre", "@3")
    lent.run("StartPost", "@2")
    assert lent.may_open
    lent.run("StopPost", "@2")
    assert lent.may_open
    lent.run("StartPre", "@2")
    lent.run("StartPost", "@3")
    assert lent.may_open
    lent.run("StartPost", "@2")
    assert not lent.may_open


def test_descriptors_are_handed_over_by_the_name_that_is_asked_for():
    text = (UNIT.parent / "neurotouch.service.d/uinput-handed-over.conf").read_text()
    handed = re.findall(r"^OpenFile=(.*)$", text, re.MULTILINE)
    assert handed == ["/dev/uinput:uinput"] * 3  # pad, keyboard, mouse

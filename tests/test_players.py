"""Where the files and sockets of each player are, and which players there are."""

import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from neurotouch_hid import players
from neurotouch_hid.driver.gel_file import choose_gel
from neurotouch_hid.errors import DriverError, ProfileError

USER = 61_999
"""Has no folder in /run/user."""
SERVICE = Path("/run/neurotouch")
NOBODY = "os.environ.pop('HOME', None); pwd.getpwuid = lambda _: {}['no such user']"


@pytest.fixture(autouse=True)
def _bare(monkeypatch):
    """A user of whom the environment says nothing."""
    for name in ("NEUROTOUCH_PLAYER", "RUNTIME_DIRECTORY", "XDG_RUNTIME_DIR", "XDG_CONFIG_HOME"):
        monkeypatch.delenv(name, raising=False)
    be(monkeypatch, USER)


def be(monkeypatch, user):
    """Only to this module: others of this process make files."""
    known = SimpleNamespace(environ=os.environ, path=os.path, getuid=lambda: user)
    monkeypatch.setattr(players, "os", known)


def test_the_environment_names_the_player(monkeypatch):
    assert players.find_player() == 1
    for number in (1, 2, 3, 4):
        monkeypatch.setenv("NEUROTOUCH_PLAYER", str(number))
        assert players.find_player() == number


@pytest.mark.parametrize("text", ["0", "5", " ", "one", "12"])
def test_another_name_is_an_error(monkeypatch, text):
    monkeypatch.setenv("NEUROTOUCH_PLAYER", text)
    with pytest.raises(DriverError, match="must be one of 1, 2, 3, 4, not"):
        players.find_player()


def test_an_empty_name_is_none(monkeypatch, tmp_path):
    """As ``run`` takes it, and as a unit file sets it."""
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    monkeypatch.setenv("NEUROTOUCH_PLAYER", "")
    assert players.find_player() == 1
    assert players.list_players() == [1]


def test_the_players_are_those_with_a_socket_or_the_first(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    assert players.list_players() == [1]
    for player in (2, 4):
        folder = players.find_runtime_folder(player)
        folder.mkdir()
        players.find_socket(folder).touch()
    assert players.list_players() == [2, 4]
    monkeypatch.setenv("NEUROTOUCH_PLAYER", "3")
    assert players.list_players() == [3]


def test_a_folder_that_root_has_closed_has_no_socket(monkeypatch, tmp_path):
    closed = tmp_path / "closed"
    closed.mkdir(mode=0o000)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(closed / "run"))
    if os.getuid() == 0:  # who may enter every folder
        os.seteuid(USER)
    try:
        assert players.list_players() == [1]
    finally:
        os.seteuid(os.getuid())


def test_each_player_has_values_of_their_own(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    own = tmp_path / "neurotouch"
    assert players.find_user_file() == players.find_user_file(1) == own / "user.yaml"
    assert players.find_user_file(2) == own / "player-2/user.yaml"
    assert players.find_user_file(2, tmp_path) == tmp_path / "player-2/user.yaml"
    monkeypatch.setenv("NEUROTOUCH_PLAYER", "3")
    assert players.find_user_file() == own / "player-3/user.yaml"
    assert players.find_user_file(1, tmp_path) == tmp_path / "user.yaml"


@pytest.mark.parametrize("given", ["relative", ""])
def test_a_relative_folder_of_settings_is_ignored(monkeypatch, given):
    monkeypatch.setenv("XDG_CONFIG_HOME", given)
    assert players.find_config_folder() == Path.home() / ".config/neurotouch"


def test_a_user_without_a_home_is_told_what_to_set(monkeypatch):
    """As in a container that runs for a number which no list of users has."""
    monkeypatch.delenv("HOME")
    monkeypatch.setattr("pwd.getpwuid", lambda _: {}["no such user"])
    for look in (players.find_config_folder, players.find_user_file):
        with pytest.raises(ProfileError, match="home folder is not known") as caught:
            look()
        assert caught.value.hint.startswith("Set the variable HOME")
    code = "import neurotouch_hid.stream.lsl"  # looks for files of the home when it is loaded
    subprocess.run([sys.executable, "-c", f"import pwd, os\n{NOBODY}\n{code}"], check=True)
    monkeypatch.setenv("XDG_CONFIG_HOME", "/elsewhere")
    assert players.find_config_folder() == Path("/elsewhere/neurotouch")
    with pytest.raises(ProfileError, match=r"~nobody-here/own\.yaml"):
        choose_gel("~nobody-here/own.yaml", "sim:push")


def test_systemd_may_give_several_folders(monkeypatch):
    monkeypatch.setenv("CONFIGURATION_DIRECTORY", "/a:/b")
    assert players.find_machine_folder() == Path("/a")
    monkeypatch.setenv("CONFIGURATION_DIRECTORY", "")
    assert players.find_machine_folder() == Path("/etc/neurotouch")
    monkeypatch.setenv("RUNTIME_DIRECTORY", "/c:/d")
    assert players.list_runtime_folders() == [Path("/c")]
    assert players.list_runtime_folders(2) == [Path("/c-2")]


def test_a_driver_is_looked_for_in_the_users_folders_and_last_as_a_service(monkeypatch, tmp_path):
    in_tmp = Path(f"/tmp/neurotouch-{USER}")
    assert players.list_runtime_folders() == [in_tmp, SERVICE]
    assert players.list_runtime_folders(2) == [
        in_tmp.with_name(f"{in_tmp.name}-2"),
        Path("/run/neurotouch-2"),
    ]
    monkeypatch.setenv("XDG_RUNTIME_DIR", "relative")
    assert players.list_runtime_folders() == [in_tmp, SERVICE]
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    assert players.list_runtime_folders() == [tmp_path / "neurotouch", SERVICE]
    assert players.find_runtime_folder() == tmp_path / "neurotouch"
    monkeypatch.setenv("NEUROTOUCH_PLAYER", "4")
    assert players.find_runtime_folder() == tmp_path / "neurotouch-4"
    assert players.find_runtime_folder(1) == tmp_path / "neurotouch"


def test_the_session_folder_counts_even_if_the_environment_does_not_name_it(monkeypatch):
    session = Path(f"/run/user/{USER}")
    is_dir = Path.is_dir
    monkeypatch.setattr(Path, "is_dir", lambda path: path == session or is_dir(path))
    assert players.list_runtime_folders() == [session / "neurotouch", SERVICE]
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(session))
    assert players.list_runtime_folders() == [session / "neurotouch", SERVICE]


def test_root_has_no_folder_in_tmp(monkeypatch):
    be(monkeypatch, 0)
    monkeypatch.setattr(Path, "is_dir", lambda path: False)
    assert players.list_runtime_folders() == [SERVICE]


def test_the_services_of_all_players_are_known(tmp_path):
    assert players.is_service_folder(SERVICE)
    assert players.is_service_folder(Path("/run/neurotouch-2"))
    assert players.is_service_folder(Path("/run/neurotouch-4"))
    assert not players.is_service_folder(Path("/run/neurotouch-5"))
    assert not players.is_service_folder(tmp_path)


def test_how_a_driver_is_started_depends_on_what_is_installed(monkeypatch, tmp_path):
    monkeypatch.setattr(players, "SERVICE_UNIT", tmp_path / "unit")
    assert players.explain_start().startswith("Start it: neurotouch run.")
    (tmp_path / "unit").touch()
    assert players.explain_start().startswith("Plug the camera in, or: sudo systemctl start")

"""Where profiles are found: installed, in a checkout, in the user's folder."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from neurotouch_hid.cli.ui.completing import complete_profile
from neurotouch_hid.errors import DriverError, ProfileError
from neurotouch_hid.handover import collect_settings
from neurotouch_hid.players import explain_start, find_user_file
from neurotouch_hid.profile import check_profile, list_profiles, load_profile
from neurotouch_hid.profile.editing import Store, make_profile
from neurotouch_hid.profile.reading.library import (
    find_profile,
    find_shipped_folder,
    find_user_folder,
    list_misnamed,
)

TEXT = "version: 1\nname: {}\nbindings:\n  - {{when: push, do: {{stick: left}}}}\n"


@pytest.fixture(autouse=True)
def user_folder(tmp_path, monkeypatch) -> Path:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    folder = tmp_path / "config" / "neurotouch" / "profiles"
    folder.mkdir(parents=True)
    return folder


def test_in_a_checkout_they_lie_beside_the_package() -> None:
    assert (find_shipped_folder() / "default.yaml").is_file()


def test_an_installed_package_carries_them(tmp_path) -> None:
    package = tmp_path / "site-packages" / "neurotouch_hid"
    (tmp_path / "site-packages" / "profiles").mkdir(parents=True)  # somebody else's
    packaged = package / "data" / "profiles"
    packaged.mkdir(parents=True)
    assert find_shipped_folder(package) == packaged


def test_a_checkout_is_told_from_an_installation(tmp_path) -> None:
    assert find_shipped_folder(tmp_path / "neurotouch_hid") == tmp_path / "profiles"


def test_the_users_own_hides_the_shipped_one(user_folder: Path) -> None:
    assert find_profile("default") == find_shipped_folder() / "default.yaml"
    (user_folder / "default.yaml").write_text(TEXT.format("default"))
    assert find_profile("default") == user_folder / "default.yaml"


def test_the_file_s_name_counts_and_another_one_in_it_is_told(user_folder: Path, tmp_path) -> None:
    (user_folder / "wrongname.yaml").write_text(TEXT.format("other-name"))
    assert load_profile("wrongname").name == "wrongname"
    (fault,) = check_profile("wrongname").faults
    assert (fault.code, fault.severity) == ("NT214", "warning")
    assert fault.hint == "write 'name: wrongname', or rename the file"
    elsewhere = tmp_path / "elsewhere.yaml"  # found by its path, so it may be called anything
    elsewhere.write_text(TEXT.format("other-name"))
    assert load_profile(elsewhere).name == "other-name"
    assert not check_profile(elsewhere).faults


def test_a_file_whose_name_is_none_is_told_with_a_free_one(user_folder: Path) -> None:
    for name in ("Übung X.yaml", "ubung-x.yaml", "mine.yml", "日本.yaml", ".x.yaml", "fine.yaml"):
        (user_folder / name).write_text(TEXT.format("x"))
    assert {path.name: free.name for path, free in list_misnamed().items()} == {
        "mine.yml": "mine.yaml",
        "Übung X.yaml": "ubung-x-2.yaml",
        "日本.yaml": "profile.yaml",
    }


@contextmanager
def closed_folder(mode: int) -> Iterator[Path]:
    """A person's folder of profiles for whoever has only these rights; root has all."""
    with TemporaryDirectory(dir="/tmp") as home, pytest.MonkeyPatch.context() as patch:
        Path(home).chmod(0o755)  # pytest's own is closed to strangers
        patch.setenv("XDG_CONFIG_HOME", home)
        patch.setenv("CONFIGURATION_DIRECTORY", f"{home}/none")
        folder = find_user_folder()
        folder.mkdir(parents=True)
        (folder / "mine.yaml").write_text(TEXT.format("mine"))
        folder.chmod(mode)
        if os.getuid() == 0:
            os.seteuid(61_999)
        try:
            yield folder
        finally:
            os.seteuid(os.getuid())
            folder.chmod(0o700)


@pytest.mark.parametrize("mode", [0o000, 0o300, 0o400])
def test_a_folder_that_cannot_be_looked_into_is_told(mode) -> None:
    with closed_folder(mode) as folder:
        for look in (
            *(list_profiles, list_misnamed, partial(find_profile, "default")),
            partial(make_profile, "new", "default", str),
        ):
            with pytest.raises(ProfileError, match=f"'{folder}' cannot be looked into: Per") as it:
                look()
            assert it.value.hint.startswith("Get the right to look into it.")
        assert find_profile("./mine.yaml") == Path("mine.yaml")  # a path needs no folder
        assert complete_profile(None, None, "") == []
        with pytest.raises(ProfileError, match="cannot be looked into"):  # else it deletes copies
            collect_settings(1)


def test_versions_that_cannot_be_looked_into_are_told() -> None:
    with closed_folder(0o000) as folder, pytest.raises(ProfileError, match="looked into: Per"):
        Store(folder / "mine.yaml", str).versions()


def test_a_file_that_no_name_leads_to_is_not_handed_over(user_folder: Path) -> None:
    for name in ("mine", "Mine", ".#mine", "my profile"):
        (user_folder / f"{name}.yaml").write_text(TEXT.format("mine"))
    assert list(collect_settings(1)["profiles"]) == ["mine"]


def test_the_list_is_sorted_and_skips_what_cannot_be_named(user_folder: Path) -> None:
    for name in ("zeta", "alpha", "Not A Name", ".hidden"):
        (user_folder / f"{name}.yaml").write_text(TEXT.format("x"))
    (user_folder / "folder.yaml").mkdir()
    names = list(list_profiles())
    assert names == sorted({"alpha", "zeta", "default", "spacecraft"} | set(names))
    assert not {"Not A Name", ".hidden", "folder"} & set(names)


def test_a_name_that_is_nearly_right(user_folder: Path) -> None:
    with pytest.raises(ProfileError) as caught:
        load_profile("spacecaft")
    assert caught.value.message == "No profile is called 'spacecaft'."
    assert caught.value.hint == "Did you mean 'spacecraft'?"


@pytest.mark.parametrize("name", ["", ".", "..", "Default", "default\n", "a" * 65, "\x1b[31m"])
def test_what_is_no_name(name: str) -> None:
    with pytest.raises(ProfileError, match="No profile is called") as caught:
        load_profile(name)
    assert "\x1b" not in caught.value.message


def test_a_slash_or_a_suffix_makes_a_path(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("default.yaml").write_text(TEXT.format("here"))
    assert load_profile("default.yaml").name == "here"
    assert load_profile("./default.yaml").name == "here"
    assert load_profile(tmp_path / "default.yaml").name == "here"
    with pytest.raises(ProfileError, match="does not exist"):
        load_profile("./default")


def test_a_relative_configuration_folder_is_ignored(monkeypatch) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", "relative")
    monkeypatch.setenv("HOME", "/home/somebody")
    assert find_user_folder() == Path("/home/somebody/.config/neurotouch/profiles")


def test_another_player_has_values_of_their_own_and_the_same_profiles(monkeypatch) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", "/etc")
    folder = Path("/etc/neurotouch")
    for player, file in {"1": "user.yaml", "2": "player-2/user.yaml"}.items():
        monkeypatch.setenv("NEUROTOUCH_PLAYER", player)
        assert find_user_file() == folder / file
        assert find_user_folder() == folder / "profiles"
    assert find_user_file(player=3) == folder / "player-3/user.yaml"
    monkeypatch.setenv("NEUROTOUCH_PLAYER", "x")
    with pytest.raises(DriverError, match="must be one of 1, 2, 3, 4, not 'x'"):
        find_user_file()


def test_how_a_driver_is_started_depends_on_the_package(monkeypatch, tmp_path):
    monkeypatch.setattr("neurotouch_hid.players.SERVICE_UNIT", tmp_path / "unit")
    assert explain_start() == "Start it: neurotouch run. Without a camera: neurotouch demo"
    (tmp_path / "unit").touch()
    assert "systemctl start neurotouch" in explain_start()
    assert explain_start().endswith("Without a camera: neurotouch demo")

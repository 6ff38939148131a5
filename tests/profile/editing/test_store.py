"""Saving whole or not at all, with a history."""

import itertools
import json
import os
import resource
import stat
import subprocess
import sys

import pytest

from neurotouch_hid.errors import ProfileError
from neurotouch_hid.players import find_user_file
from neurotouch_hid.profile import UserSettings, load_user
from neurotouch_hid.profile.editing import Store, make_profile, take_profile, take_user
from neurotouch_hid.profile.reading.library import find_shipped_folder, find_user_folder


@pytest.fixture
def stamp():
    count = itertools.count(1)
    return lambda: f"2026-11-21_{next(count):02d}"


@pytest.fixture(autouse=True)
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    return tmp_path


def make(tmp_path, stamp, n):
    """A store whose file was 0, then 1, ... then n."""
    store = Store(tmp_path / "mine.yaml", stamp)
    for i in range(n + 1):
        store.save(b"%d" % i, over=store.read())
    return store


def test_every_version_is_kept_up_to_twenty(tmp_path, stamp):
    store = make(tmp_path, stamp, 25)
    versions = store.versions()
    assert [version.path.read_bytes() for version in versions] == [
        b"%d" % i for i in range(24, 4, -1)
    ]
    assert versions[0].number == 25


@pytest.mark.parametrize(
    ("saved", "undone"),
    [
        ("ABA", "BA"),  # as it was once before
        ("ABAB", "ABA"),
        ("AB<CB", "CA"),  # what was undone does not come back
        ("ABC<<D", "A"),
        ("ABC<B<", ""),
        ("AB<B", "A"),
        ("AAB", "A"),
        ("ABx", "BA"),  # a small letter: another program writes it
        ("ABxy", "BA"),
        ("AxB", "xA"),
        ("AB<x", "A"),
        ("ABA<x", "BA"),
        ("AB-", "BA"),  # another program removes the file
    ],
)
def test_undo_takes_back_the_last_change_and_then_the_one_before(tmp_path, stamp, saved, undone):
    store = Store(tmp_path / "mine.yaml", stamp)
    for letter in saved:
        if letter == "<":
            store.undo()
        elif letter == "-":
            store.path.unlink()
        elif letter.islower():
            store.path.write_text(letter)
        else:
            store.save(letter.encode(), over=store.read())
    assert [store.undo() and store.read() for _ in undone] == [each.encode() for each in undone]
    with pytest.raises(ProfileError, match="nothing to undo"):
        store.undo()


def test_a_broken_note_of_what_was_undone_is_no_obstacle(tmp_path, stamp):
    store = make(tmp_path, stamp, 2)
    store.undo()
    (tmp_path / ".history" / "mine" / "undone.json").write_text("[" * 9000)
    store.undo()
    assert store.read() in (b"0", b"2")


def test_undo_goes_back_step_by_step_and_loses_nothing(tmp_path, stamp):
    store = make(tmp_path, stamp, 3)
    assert [store.undo() and store.read() for _ in range(3)] == [b"2", b"1", b"0"]
    with pytest.raises(ProfileError, match="nothing to undo"):
        store.undo()
    contents = {version.path.read_bytes(): version.number for version in store.versions()}
    assert set(contents) == {b"0", b"1", b"2", b"3"}
    store.restore(contents[b"3"])
    assert store.read() == b"3"
    with pytest.raises(ProfileError, match="no version 99"):
        store.restore(99)


def test_a_change_by_somebody_else_is_not_overwritten(tmp_path, stamp):
    store = make(tmp_path, stamp, 1)
    store.path.write_bytes(b"theirs")
    with pytest.raises(ProfileError, match="another program"):
        store.save(b"mine", over=b"1")
    assert store.read() == b"theirs"


COUNTING = """
import json, sys
from pathlib import Path
from neurotouch_hid.errors import ProfileError
from neurotouch_hid.profile.editing import Store

store, name, n_saved = Store(Path(sys.argv[1]), lambda: "now", kept=3), sys.argv[2], 0
while n_saved < 60:
    over = store.read()
    counts = json.loads(over)
    counts[name] = counts.get(name, 0) + 1
    try:
        store.save(json.dumps(counts).encode(), over=over)
        n_saved += 1
    except ProfileError as error:
        assert "another program" in error.message, error
"""


def test_of_two_processes_that_save_at_once_no_change_is_lost(tmp_path):
    file = tmp_path / "mine.yaml"
    file.write_text("{}")
    both = [
        subprocess.Popen([sys.executable, "-c", COUNTING, str(file), name]) for name in ("a", "b")
    ]
    assert [each.wait() for each in both] == [0, 0]
    assert json.loads(file.read_text()) == {"a": 60, "b": 60}


def test_another_file_of_the_folder_can_be_saved_meanwhile(tmp_path, stamp):
    first, second = (Store(tmp_path / f"{name}.yaml", stamp) for name in ("mine", "yours"))
    with first._lock("written"):
        second.save(b"1", over=None)
        with pytest.raises(ProfileError, match="another program"):
            Store(first.path, stamp).save(b"1", over=None)
    assert second.read() == b"1"


def test_what_another_program_replaced_is_no_change_of_a_kind(tmp_path):
    """The page takes back the last calibration: what came by hand since then stays."""
    store = Store(tmp_path / "user.yaml", lambda: "2026-11-21_calibration")
    store.save(b"0", over=None)
    store.save(b"1", over=b"0")
    store.path.write_bytes(b"by hand")
    assert list(store.changes("calibration")) == [(b"0", b"1")]
    store.save(b"2", over=b"by hand")
    assert list(store.changes("calibration")) == [(b"by hand", b"2"), (b"0", b"1")]


def test_a_full_disk_leaves_the_old_file(tmp_path, stamp):
    store = make(tmp_path, stamp, 1)
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (100, before[1]))
    try:
        with pytest.raises(ProfileError, match="it is as it was"):
            store.save(b"x" * 10_000, over=b"1")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert store.read() == b"1"
    assert not [path for path in tmp_path.rglob("*") if path.name.endswith(".part")]


def test_links_and_modes_stay(tmp_path, stamp):
    real = tmp_path / "dotfiles" / "real.yaml"
    real.parent.mkdir()
    real.write_bytes(b"0")
    real.chmod(0o640)
    link = tmp_path / "mine.yaml"
    link.symlink_to(real)
    Store(link, stamp).save(b"1", over=b"0")
    assert link.is_symlink()
    assert real.read_bytes() == b"1"
    assert stat.S_IMODE(os.stat(real).st_mode) == 0o640  # noqa: PTH116


def test_a_shipped_profile_is_never_changed(stamp):
    shipped = find_shipped_folder() / "racing.yaml"
    before = shipped.read_bytes()
    edited = take_profile("racing", stamp)
    assert edited.shipped
    edited.save(
        edited.text.rewrite(edited.text.text.replace("Twist to steer", "Steer by twisting"))
    )
    assert shipped.read_bytes() == before
    own = find_user_folder() / "racing.yaml"
    assert b"Steer by twisting" in own.read_bytes()
    assert not take_profile("racing", stamp).shipped
    take_profile("racing", stamp).store.undo()
    assert b"Twist to steer" in own.read_bytes()
    with pytest.raises(ProfileError, match="never changed"):
        take_profile(str(shipped), stamp)


def test_what_is_wrong_is_not_saved(stamp):
    edited = make_profile("mine", "racing", stamp)
    with pytest.raises(ProfileError, match="NT110"):
        edited.save(edited.text.rewrite(f"{edited.text}nonsense: 1\n"))
    assert not edited.store.path.exists()
    edited.save(edited.text)
    assert b"name: mine" in edited.store.path.read_bytes()
    with pytest.raises(ProfileError, match="already"):
        make_profile("mine", "racing", stamp)


def test_a_profile_cannot_be_built_on_itself(stamp):
    for _ in range(2):  # as the copy of a shipped one, then as the user's own
        edited = take_profile("racing", stamp)
        with pytest.raises(ProfileError, match="NT131"):
            edited.save(
                edited.text.rewrite(
                    edited.text.text.replace("\nbindings:", "\nextends: [racing]\nbindings:")
                )
            )
        edited.save(edited.text.rewrite(f"{edited.text}\n"))


@pytest.mark.parametrize("name", ["", "../x", "a/b", "/etc/x", "A", "a" * 65, "a.yaml", "é", ".x"])
def test_a_name_is_never_a_path(name, stamp):
    with pytest.raises(ProfileError, match="cannot be called"):
        make_profile(name, "racing", stamp)


def test_the_users_first_values_can_be_undone(stamp):
    edited = take_user(stamp)
    edited.save(edited.text.rewrite(f"{edited.text}filter: strong\n"))
    take_user(stamp).store.undo()
    assert "filter" not in take_user(stamp).text.text


@pytest.fixture
def machine(tmp_path, monkeypatch):
    """The values of people who have saved none, as an administrator has written them."""
    folder = tmp_path / "etc/neurotouch"
    folder.mkdir(parents=True)
    monkeypatch.setenv("CONFIGURATION_DIRECTORY", str(folder))
    (folder / "user.yaml").write_text(
        "# For the whole ward.\nversion: 1\nfilter: strong\nslots: [racing, default]\n"
    )
    return folder / "user.yaml"


def test_a_person_s_first_values_begin_with_those_of_the_machine(machine, stamp):
    before, content = load_user(), machine.read_bytes()
    edited = take_user(stamp)
    assert edited.content is None  # a file of the person's own
    edited.save(edited.text.rewrite(f"{edited.text}timing: slow\n"))
    assert edited.store.path == find_user_file()
    assert load_user() == before.model_copy(update={"timing": "slow"})
    assert machine.read_bytes() == content


def test_favourites_that_are_the_default_do_not_become_a_choice(machine, stamp):
    """A service plays the machine's profile for a person who has chosen none."""
    machine.write_text("version: 1\nfilter: strong\nslots: [default]\n")
    edited = take_user(stamp)
    edited.save(edited.text)
    assert load_user().filter == "strong"
    assert "slots" not in load_user().model_fields_set


def test_without_the_machine_s_values_a_person_s_begin_empty(machine, stamp):
    machine.unlink()
    edited = take_user(stamp)
    edited.save(edited.text)
    assert load_user() == UserSettings()


def test_a_link_to_itself_is_explained(stamp):
    own = find_user_folder() / "loop.yaml"
    own.parent.mkdir(parents=True)
    own.symlink_to("loop.yaml")
    made = make_profile("loop", "racing", stamp)
    made.check(made.text).require()
    with pytest.raises(ProfileError, match="cannot be read: Too many levels of symbolic links"):
        made.save(made.text)


def test_a_version_that_is_no_file_is_explained(tmp_path, stamp):
    store = make(tmp_path, stamp, 3)
    kept = store.versions()[0].path
    kept.unlink()
    kept.symlink_to("/dev/zero")
    with pytest.raises(ProfileError, match="cannot be read: it is a device, not a file"):
        store.undo()


def test_a_deleted_link_comes_back_as_a_link_unless_its_target_has_changed(tmp_path, stamp):
    real = tmp_path / "dotfiles.yaml"
    real.write_bytes(b"0")
    link = tmp_path / "mine.yaml"
    link.symlink_to("dotfiles.yaml")
    store = Store(link, stamp)
    store.delete()
    assert not link.is_symlink()
    store.undo()
    assert str(link.readlink()) == "dotfiles.yaml"
    assert real.read_bytes() == b"0"
    store.delete()
    real.write_bytes(b"other")
    store.undo()
    assert not link.is_symlink()
    assert (link.read_bytes(), real.read_bytes()) == (b"0", b"other")
    store.delete()  # a file now
    store.undo()
    assert not link.is_symlink()
    store.delete()
    real.write_bytes(b"0")
    store.restore(1)
    assert not link.is_symlink()  # the link was not deleted last

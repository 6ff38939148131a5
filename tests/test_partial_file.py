"""A file is whole or not there, a link in the way is not followed, and a device stays a device."""

import errno
import os
import re
import stat
import sys
import threading
from pathlib import Path

import pytest

from neurotouch_hid.cli.ui.output import save_json
from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.files.small_file import suggest_reading
from neurotouch_hid.partial_file import (
    PartialFile,
    remove_left,
    suggest_fix,
    try_writing,
    write_whole,
)
from tests.processes import run_command

ROOT = Path(__file__).parents[1]
WRITES = re.compile(r"\.write_(text|bytes)\(|\.open\([\"'][wxa]|O_CREAT|mkstemp|NamedTemporary")
OTHERS = {
    "page/address.py": "a secret, made with its owner's rights only",
    "evaluation/accuracy/report/write.py": "a report, in a new folder that then takes its name",
    "driver/control_socket.py": "a lock",
    "cli/session.py": "a lock",
    "profile/editing/store.py": "a lock",
    "recording/file_output.py": "a recording that can be read while it is written",
    "emulator/usbip.py": "a switch of the kernel",
    "doctor/hello/led.py": "a switch of the kernel",
}


def test_nothing_else_writes_a_file():
    packages = ("neurotouch_hid", "devtools/neurotouch_devtools")
    places = {
        str(path.relative_to(ROOT / package))
        for package in packages
        for path in (ROOT / package).rglob("*.py")
        if path.name != "partial_file.py" and WRITES.search(path.read_text())
    }
    assert places == set(OTHERS), "write it by partial_file.py"


def test_the_old_file_is_there_until_the_new_one_is_whole(tmp_path):
    path = tmp_path / "numbers.json"
    path.write_text("old")
    path.chmod(0o640)
    with PartialFile(path) as partial:
        partial.file.write(b"new")
        assert path.read_text() == "old"
    assert path.read_text() == "new"
    assert stat.S_IMODE(path.stat().st_mode) == 0o640
    assert [*tmp_path.iterdir()] == [path]


def test_a_failure_leaves_the_old_file_and_nothing_beside_it(tmp_path):
    path = tmp_path / "numbers.json"
    path.write_text("old")
    with pytest.raises(ZeroDivisionError), PartialFile(path):
        raise ZeroDivisionError
    assert path.read_text() == "old"
    assert [*tmp_path.iterdir()] == [path]


def test_whether_a_file_can_be_written_is_tried_and_leaves_everything_as_it_is(tmp_path):
    path = tmp_path / "old.json"
    path.write_text("old")
    os.mkfifo(tmp_path / "pipe")  # nobody reads it: to open it would take for ever
    for each in (path, tmp_path / "new.json", tmp_path / "pipe", Path("/dev/full")):
        try_writing(each)
    assert sorted(each.name for each in tmp_path.iterdir()) == ["old.json", "pipe"]
    assert path.read_text() == "old"
    for nowhere in ("gone/x", "old.json/x"):
        with pytest.raises(OSError, match=r"No such|Not a directory"):
            try_writing(tmp_path / nowhere)
    with pytest.raises(FileNotFoundError):
        try_writing(Path("/proc/x"))


def test_a_link_that_waits_beside_it_is_not_followed(tmp_path):
    victim, path = tmp_path / "victim", tmp_path / "numbers.json"
    victim.write_text("precious")
    (tmp_path / f".{path.name}.{os.getpid()}.partial").symlink_to(victim)
    write_whole(path, b"new")
    assert victim.read_text() == "precious"
    assert path.read_text() == "new"


def test_a_link_that_is_put_there_in_the_last_moment_is_not_followed(tmp_path, monkeypatch):
    victim, path = tmp_path / "victim", tmp_path / "numbers.json"
    victim.write_text("precious")

    def put_a_link(part, missing_ok):
        assert missing_ok
        part.symlink_to(victim)

    monkeypatch.setattr(Path, "unlink", put_a_link)
    with pytest.raises(FileExistsError):
        write_whole(path, b"new")
    assert victim.read_text() == "precious"


def test_what_somebody_has_removed_is_not_missed(tmp_path):
    partial = PartialFile(tmp_path / "numbers.json")
    for part in tmp_path.iterdir():
        part.unlink()
    partial.discard()
    assert [*tmp_path.iterdir()] == []


def test_a_written_file_leaves_no_descriptor_and_has_the_usual_mode(tmp_path):
    before, mask = len([*Path("/proc/self/fd").iterdir()]), os.umask(0o022)
    try:
        write_whole(tmp_path / "numbers.json", b"new")
    finally:
        os.umask(mask)
    assert len([*Path("/proc/self/fd").iterdir()]) == before
    assert stat.S_IMODE((tmp_path / "numbers.json").stat().st_mode) == 0o644


def test_a_link_stays_a_link(tmp_path):
    (tmp_path / "folder").mkdir()
    target, path = tmp_path / "folder/real", tmp_path / "numbers.json"
    path.symlink_to(target)
    write_whole(path, b"new")
    assert path.is_symlink()
    assert target.read_text() == "new"


def test_a_link_to_itself_is_no_riddle(tmp_path):
    path = tmp_path / "numbers.json"
    path.symlink_to(path)
    write_whole(path, b"new")
    assert path.read_text() == "new"


@pytest.mark.parametrize("device", ["/dev/null", "/dev/stdout"])
def test_a_device_stays_one(device):
    kind = os.lstat(device).st_mode
    write_whole(Path(device), b"")
    assert os.lstat(device).st_mode == kind


def test_a_link_to_a_device_is_written_as_it_is(tmp_path):
    path = tmp_path / "nowhere"
    path.symlink_to("/dev/null")
    write_whole(path, b"all of it")
    assert path.is_symlink()
    assert path.is_char_device()


def test_a_pipe_is_written_to(tmp_path):
    path = tmp_path / "pipe"
    os.mkfifo(path)
    read = []
    reader = threading.Thread(target=lambda: read.append(path.read_bytes()))
    reader.start()
    write_whole(path, b"all of it")
    reader.join()
    assert read == [b"all of it"]
    assert path.is_fifo()


def test_a_full_device_is_an_error():
    with pytest.raises(OSError, match="No space left"):
        write_whole(Path("/dev/full"), b"too much")


def test_the_json_of_a_command_may_go_to_a_device(tmp_path):
    path = tmp_path / "nowhere"
    path.symlink_to("/dev/null")
    save_json(path, {"a": 1})
    assert path.is_char_device()


@pytest.mark.parametrize(
    ("number", "fix"),
    [
        (errno.ENOSPC, "Make room"),
        (errno.EROFS, "Restart"),
        (errno.EACCES, "right"),
        (errno.EFBIG, "another disk"),
        (errno.EIO, "another disk"),
    ],
)
def test_what_to_do_is_said_by_the_reason(number, fix):
    assert fix in suggest_fix(OSError(number, os.strerror(number)))


def test_an_error_names_the_file_and_not_the_part_beside_it(tmp_path):
    (tmp_path / "file").touch()
    path = tmp_path / "file" / "a.json"
    with pytest.raises(NeuroTouchError) as caught:
        save_json(path, {})
    assert caught.value.hint == f"See what each part of its path is: namei -l {path}"


def test_a_folder_that_is_missing_is_to_be_made(tmp_path):
    with pytest.raises(NeuroTouchError, match="No such file or directory") as caught:
        save_json(tmp_path / "gone" / "a.json", {})
    assert caught.value.hint == "Make the folder, or choose another."


def test_a_missing_right_is_explained_with_the_folders_above(tmp_path):
    denied = PermissionError(errno.EACCES, "Permission denied", str(tmp_path / "my file"))
    shown = f"Who owns each part of its path: namei -l '{tmp_path}/my file'"
    assert suggest_fix(denied) == f"Get the right to write there. {shown}"
    assert suggest_reading(denied) == f"Get the right to read it. {shown}"
    assert "namei -l /x" in suggest_fix(NotADirectoryError(errno.ENOTDIR, "no folder", "/x"))
    assert suggest_reading(IsADirectoryError(errno.EISDIR, "a folder", "x"), "Name a file.") == (
        "Name a file."
    )


def test_what_a_killed_writer_left_goes_and_a_living_one_goes_on(tmp_path):
    killed = run_command(sys.executable, "-c", "import os; print(os.getpid())").stdout.strip()
    left = tmp_path / f".a.aedat4.{killed}.partial"
    left.write_bytes(b"part")
    strange = [tmp_path / name for name in (".partial", ".a.partial", "a.aedat4", ".1.partial.txt")]
    for path in strange:
        path.write_bytes(b"not ours")
    with PartialFile(tmp_path / "b.aedat4") as living:
        remove_left(tmp_path)
        living.file.write(b"whole")
    assert not left.exists()
    assert all(path.exists() for path in strange)
    assert (tmp_path / "b.aedat4").read_bytes() == b"whole"

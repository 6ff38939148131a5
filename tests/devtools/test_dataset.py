"""The public data set: the same bytes twice, whole, and its splits share nothing."""

import re

import pytest
from neurotouch_devtools.dataset import (
    EDITION,
    SPLITS,
    Part,
    compare_checksums,
    list_checksums,
    list_parts,
    read_checksums,
    write_edition,
)
from neurotouch_devtools.dataset.__main__ import OF_EDITION

from neurotouch_hid.recording import labels_path, read_labels
from tests.docs.prose import ROOT
from tests.processes import run_command

TINY = (
    Part("open/events", "tiny", 5, 1, 0.7, "solid", {"dust": 5.0}),
    Part("open/film", "tiny", 6, 1, 0.7, "half-space", {"uvc": 60.0, "mjpeg": 70.0}, "rings"),
)


@pytest.fixture(scope="module")
def twice(tmp_path_factory):
    """The same tiny edition, made by one process and by two."""
    folders = [tmp_path_factory.mktemp("edition") for _ in range(2)]
    said = []
    for folder, jobs in zip(folders, (1, 2), strict=True):
        write_edition(folder, TINY, jobs=jobs, progress=said.append)
    assert [line.split(" parts")[0] for line in said] == ["1 of 2", "2 of 2"] * 2
    return folders


def test_the_same_seeds_give_the_same_bytes(twice):
    first, second = (list_checksums(folder) for folder in twice)
    assert first == second
    assert {name.rpartition(".")[2] for name in first} >= {"aedat4", "mkv", "csv", "yaml", "json"}


def test_every_recording_has_labels_and_every_other_gel_its_file(twice):
    for path in [*twice[0].rglob("*.aedat4"), *twice[0].rglob("*.mkv")]:
        size = (640, 480) if path.suffix == ".mkv" else None
        assert len(read_labels(labels_path(path), size)) > 10
        assert path.with_name(f"{path.stem}.gel.yaml").exists() == (path.suffix == ".mkv")


def test_the_folder_says_that_it_is_simulated_and_its_licence(twice):
    assert "SIMULATED" in (twice[0] / "README.md").read_text()
    assert "CC BY 4.0" in (twice[0] / "LICENSE.txt").read_text()


def test_other_tools_read_the_checksums_and_one_byte_is_found(twice):
    def check():
        command = ["sha256sum", "--check", "--quiet", "SHA256SUMS"]
        done = run_command(*command, code=None, cwd=twice[1])
        return done.returncode, done.stdout

    assert check() == (0, "")
    path = twice[1] / "open" / "events" / "user1-push-solid.aedat4"
    content = bytearray(path.read_bytes())
    content[-1] ^= 1
    path.write_bytes(content)
    assert check()[0] == 1
    expected = read_checksums((twice[1] / "SHA256SUMS").read_text())
    name = "open/events/user1-push-solid.aedat4"
    assert compare_checksums(expected, list_checksums(twice[1])) == [f"{name} has other bytes."]


def test_what_is_missing_or_strange_is_named():
    found = compare_checksums({"a": "1", "b": "2"}, {"b": "2", "c": "3"})
    assert found == ["a is missing.", "c does not belong here."]


def test_no_two_parts_share_people_or_gestures():
    parts = [part for split in SPLITS for part in list_parts(split)]
    assert len({part.seed for part in parts}) == len({part.folder for part in parts}) == 14
    assert all(901_000 <= part.seed < 910_000 for part in list_parts("judge"))
    assert all(800_000 <= part.seed < 900_000 for part in list_parts("open"))
    later = [part.seed for split in SPLITS for part in list_parts(split, EDITION + 1)]
    assert not {part.seed for part in parts} & set(later)


def test_our_notebooks_use_no_seed_of_the_judge():
    notebooks = [*(ROOT / "docs" / "research").glob("notebook-*.md")]
    assert len(notebooks) == 2
    for path in notebooks:
        assert re.findall(r"\b90[1-9],?\d{3}\b", path.read_text("utf-8")) == [], path.name


def test_the_committed_checksums_are_of_these_parts():
    names = read_checksums(OF_EDITION.read_text())
    recordings = [name for name in names if name.endswith((".aedat4", ".mkv"))]
    expected = {part.folder: 5 * part.users for split in SPLITS for part in list_parts(split)}
    folders = [name.rpartition("/")[0] for name in recordings]
    assert {folder: folders.count(folder) for folder in folders} == expected
    assert all(len(digest) == 64 for digest in names.values())


def test_the_simulator_still_makes_the_bytes_of_the_edition(tmp_path):
    """One recording of this part has two events of one moment, whose order may change."""
    folder = "judge/davis-hex"
    made = write_edition(tmp_path, [part for part in list_parts("judge") if part.folder == folder])
    expected = read_checksums(OF_EDITION.read_text())
    names = [name for name in expected if name.startswith(f"{folder}/")]
    assert len(names) == 16
    assert {name: made[name] for name in names} == {name: expected[name] for name in names}

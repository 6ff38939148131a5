"""The image for systems with a read-only ``/usr``, in a Debian whose ``/usr`` cannot be written."""

import json
import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from neurotouch_hid import __version__
from tests.system import machine
from tests.system.conftest import (
    CHOSEN,
    IN_CONTAINER,
    LACKS,
    SYSEXT,
    TIME_LIMIT_S,
    compile_unpacked,
    prepare_scene,
)
from tests.system.image import PACKAGES, ROOT, ROOT_FOLDER, find_missing, make_image

SQUASHFS = {"mksquashfs": "squashfs-tools", "unsquashfs": "squashfs-tools"}
OLDER = "0.0.1"


@pytest.fixture(scope="module")
def seen(tmp_path_factory) -> dict:
    if os.environ.get("NEUROTOUCH_SYSTEM_TEST") != "1":
        pytest.skip("boots a whole Debian, which takes minutes: make system-test")
    if IN_CONTAINER:
        pytest.skip(LACKS)
    if CHOSEN and SYSEXT not in CHOSEN:
        pytest.skip(f"the chapter {SYSEXT!r} was not chosen")
    missing = find_missing(PACKAGES | SQUASHFS)
    if missing or os.geteuid() != 0:
        pytest.fail(f"the system test needs root and the packages: {' '.join(missing)}")
    image = ROOT / "dist/neurotouch-hid.raw"
    if not image.exists():
        pytest.fail("there is no image in dist/: make sysext")
    results = tmp_path_factory.mktemp("extended")
    disk = make_image()
    shutil.copy(image, results / "newer.raw")
    make_older(image, results)
    prepare_scene(results)
    unpack = ["unsquashfs", "-quiet", "-no-progress", "-force", "-dest", str(ROOT_FOLDER)]
    compile_unpacked([*unpack, str(image)], results / "compiled-extension")
    program = "tests.system.guest.sysext"
    machine.boot(disk, results, time_limit_s=TIME_LIMIT_S, program=program)
    answer = json.loads((results / "sysext.json").read_text())
    assert "failed" not in answer, answer["failed"]
    return dict(answer["saw"])


def make_older(image: Path, folder: Path) -> None:
    """Makes ``older.raw``: the same image with an older version of the program."""
    content = folder / "content"
    quiet = ("-quiet", "-no-progress")
    subprocess.run(["unsquashfs", *quiet, "-dest", str(content), str(image)], check=True)
    module = content / "usr/lib/neurotouch-hid/neurotouch_hid/__init__.py"
    text, n_found = re.subn(
        r'(?m)^__version__ = ".*"', f'__version__ = "{OLDER}"', module.read_text()
    )
    assert n_found == 1
    module.write_text(text)
    # It is believed without a look at the source.
    for path in module.parent.glob("__pycache__/__init__.*.pyc"):
        path.unlink()
    command = ["mksquashfs", str(content), str(folder / "older.raw"), "-all-root", "-comp", "zstd"]
    subprocess.run([*command, *quiet], check=True)
    shutil.rmtree(content)


def test_usr_is_read_only_all_the_time(seen):
    for moment in ("before", "merged", "set_up", "renewed", "after"):
        assert seen[moment]["usr_is_read_only"], moment


def test_one_command_puts_the_program_there_and_gives_no_rights(seen):
    assert not seen["before"]["version"]
    assert seen["merge"]["code"] == 0, seen["merge"]["err"]
    assert OLDER in seen["merged"]["version"]
    assert not any(seen["merged"]["allowed"].values())


def test_setup_writes_rules_into_etc_and_nothing_else(seen):
    assert seen["setup"]["code"] == 0, seen["setup"]["err"]
    assert all(seen["set_up"]["allowed"].values())
    new = set(seen["set_up"]["files"]) - set(seen["merged"]["files"])
    assert new
    assert all(path.startswith(("/etc/udev/rules.d/", "/etc/modules-load.d/")) for path in new), new


def test_the_person_at_the_seat_plays_from_the_camera(seen):
    assert seen["plays"]


def test_the_image_is_renewed_while_it_plays(seen):
    assert seen["refresh"]["code"] == 0, seen["refresh"]["err"]
    assert seen["plays_on"]
    assert __version__ in seen["renewed"]["version"]
    assert seen["ended"] == 0


def test_the_renewed_program_plays(seen):
    assert seen["plays_renewed"]
    assert seen["ended_renewed"] == 0


def test_removed_it_leaves_no_trace(seen):
    assert seen["uninstall"]["code"] == 0, seen["uninstall"]["err"]
    assert seen["last_refresh"]["code"] == 0, seen["last_refresh"]["err"]
    for what in ("version", "mounts"):
        assert seen["after"][what] == seen["before"][what], what
    left = set(seen["after"]["files"]) - set(seen["before"]["files"])
    assert all(path.startswith("/run/user/") for path in left), "it goes at the end of the session"
    assert not seen["after"]["allowed"]["/dev/uinput"]
    assert "stays open to you until it is unplugged" in seen["uninstall"]["out"]
    assert not seen["after"]["failed_units"]


def test_a_removed_image_is_kept_only_by_other_programs_that_began_meanwhile(seen):
    holders = seen["after"]["holders"]
    assert not [name for name in holders if "neurotouch" in name]
    if not holders:  # the observer itself may be one
        assert not seen["after"]["loops"]

"""Boots a whole Debian once for all tests of this folder and hands them what the guest saw."""

import json
import os
import re
import shutil
import subprocess
import sysconfig
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.system import container, machine
from tests.system.image import (
    CACHE,
    CONTAINER_PACKAGES,
    PACKAGES,
    ROOT,
    ROOT_FOLDER,
    find_missing,
    make_container,
    make_image,
)

TIME_LIMIT_S = 7200.0
"""Emulated it needs 20 to 30 minutes of a core; on a busy machine that is far longer."""
CONTAINER_TIME_LIMIT_S = 900.0
"""A container needs about two minutes."""
RESULTS = CACHE / "results"
"""What the last run saw, its journal included; stays for reading."""

# Compiled kernels are kept per processor, and QEMU's is not ours: both are made for a generic one.
GENERIC = {"NUMBA_CPU_NAME": "generic"}

IN_CONTAINER = os.environ.get("NEUROTOUCH_MACHINE") == "container"
CHOSEN = os.environ.get("NEUROTOUCH_CHAPTERS", "").split()
SYSEXT, SLEEP = OF_THEIR_OWN = ("sysext", "sleep")
"""The chapters for which a machine of their own boots."""
SHOWN_IN_CONTAINER = ("install", "rights", "upgrade", "versions", "purge")
"""The chapters that see something without a camera and a pad, in their order."""
LACKS = "a container has neither a camera nor /dev/uinput: make system-test without MACHINE"


@pytest.fixture(scope="session")
def results() -> Path:
    """The folder that the guest wrote."""
    if os.environ.get("NEUROTOUCH_SYSTEM_TEST") != "1":
        pytest.skip("boots a whole Debian, which takes long: make system-test")
    if CHOSEN and set(CHOSEN) <= set(OF_THEIR_OWN):
        pytest.skip("only chapters with machines of their own were chosen")
    missing = find_missing(CONTAINER_PACKAGES if IN_CONTAINER else PACKAGES)
    if missing or os.geteuid() != 0:
        pytest.fail(f"the system test needs root and the packages: {' '.join(missing)}")
    packages = sorted((ROOT / "dist").glob("*.deb"), key=lambda path: path.stat().st_mtime)
    if not packages:
        pytest.fail("there is no package in dist/: make deb")
    shutil.rmtree(RESULTS, ignore_errors=True)
    RESULTS.mkdir(parents=True)
    package = packages[-1]
    shutil.copy(package, RESULTS)
    if not CHOSEN or "versions" in CHOSEN:
        make_older(package, RESULTS / "older")
    if IN_CONTAINER:
        chapters = [each for each in SHOWN_IN_CONTAINER if not CHOSEN or each in CHOSEN]
        (RESULTS / "chapters").write_text(" ".join(chapters))
        container.boot(make_container(), RESULTS, time_limit_s=CONTAINER_TIME_LIMIT_S)
        return RESULTS
    image = make_image()
    (RESULTS / "chapters").write_text(" ".join(each for each in CHOSEN if each not in OF_THEIR_OWN))
    prepare_scene(RESULTS)
    compile_service(package, RESULTS / "compiled-service")
    machine.boot(image, RESULTS, time_limit_s=TIME_LIMIT_S)
    return RESULTS


@pytest.fixture(scope="session")
def guest(results: Path) -> Callable[[str], Any]:
    """Returns what a chapter of the guest's program saw; no answer is a failure."""

    def saw(chapter: str) -> Any:
        if CHOSEN and chapter not in CHOSEN:
            pytest.skip(f"the chapter {chapter!r} was not chosen")
        if IN_CONTAINER and chapter not in SHOWN_IN_CONTAINER:
            pytest.skip(LACKS)
        answer = results / f"{chapter}.json"
        if not answer.exists():
            output = results / "output.txt"
            said = output.read_text()[-3000:] if output.exists() else "nothing"
            pytest.fail(f"the guest gave no answer to {chapter!r}; it said:\n{said}")
        said = json.loads(answer.read_text())
        if "failed" in said:
            pytest.fail(f"in the guest, {chapter!r} failed:\n{said['failed']}")
        return said["saw"]

    return saw


@pytest.fixture(scope="session")
def at_play() -> None:
    """Skips in a container, where the service cannot play."""
    if IN_CONTAINER:
        pytest.skip(LACKS)


def make_older(package: Path, folder: Path) -> None:
    """Makes the same package with an older version."""
    content = folder / "content"
    folder.mkdir()
    subprocess.run(["dpkg-deb", "--raw-extract", str(package), str(content)], check=True)
    control = content / "DEBIAN/control"
    text = re.sub(r"(?m)^Version: .*", "Version: 0.0.1", control.read_text())
    control.write_text(text)
    subprocess.run(["dpkg-deb", "-Znone", "--build", str(content), str(folder)], check=True)
    shutil.rmtree(content)


def prepare_scene(results: Path) -> None:
    """Record what the camera sees, and compile what plays the camera, with the guest's Python."""
    recording = str(results / "scene.aedat4")
    environment = {
        **os.environ,
        **GENERIC,
        "NUMBA_CACHE_DIR": str(results / "compiled"),
        "PYTHONPATH": f"{sysconfig.get_path('purelib')}:{ROOT}/devtools",
        "PYTHONDONTWRITEBYTECODE": "1",
    }
    for module in (
        ["tests.system.scene", recording],
        ["tests.system.guest.camera", recording, "rehearse"],
    ):
        subprocess.run(["/usr/bin/python3", "-m", *module], cwd=ROOT, env=environment, check=True)


def compile_service(package: Path, compiled: Path) -> None:
    """Have the packaged service compile where it will lie, in a folder that is the same Debian."""
    compile_unpacked(["dpkg-deb", "-x", str(package), str(ROOT_FOLDER)], compiled)


def compile_unpacked(unpack: list[str], compiled: Path) -> None:
    """The same for what a command unpacks into that folder."""
    cache = ROOT_FOLDER / "var/cache/neurotouch"
    for folder in (cache, ROOT_FOLDER / "usr/lib/neurotouch-hid"):
        shutil.rmtree(folder, ignore_errors=True)
    subprocess.run(unpack, check=True, stdout=subprocess.DEVNULL)
    inside = {"XDG_CONFIG_HOME": "/etc", "NUMBA_CACHE_DIR": "/var/cache/neurotouch", **GENERIC}
    settings = [f"{name}={value}" for name, value in inside.items()]
    command = ["env", "-i", "PATH=/usr/bin:/bin", *settings, "neurotouch", "service", "--compile"]
    subprocess.run(["chroot", str(ROOT_FOLDER), *command], check=True)
    cache.rename(compiled)

"""The power is cut right after the installation: the package is whole, and the service starts.

QEMU is killed, so what the guest's kernel had not yet written is lost, as it is with the power.
"""

import json
import os
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.system import machine
from tests.system.conftest import CHOSEN, IN_CONTAINER, TIME_LIMIT_S, compile_service
from tests.system.image import ROOT, make_image

LEFT_OUT = "displacement.displace"
"""A small kernel that is not there yet: the package compiles it just before the cut."""


@pytest.fixture(scope="module")
def found(tmp_path_factory) -> dict:
    if os.environ.get("NEUROTOUCH_SYSTEM_TEST") != "1":
        pytest.skip("boots a whole Debian twice, which takes minutes: make system-test")
    if IN_CONTAINER:
        pytest.skip("a container has no power of its own: make system-test without MACHINE")
    if CHOSEN:
        pytest.skip("only chapters were chosen")
    results = tmp_path_factory.mktemp("installed")
    package = max((ROOT / "dist").glob("*.deb"), key=lambda path: path.stat().st_mtime)
    shutil.copy(package, results)
    image = make_image()
    compile_service(package, results / "compiled-service")
    left_out = list(results.rglob(f"{LEFT_OUT}-*.*"))
    assert left_out
    for path in left_out:
        path.unlink()
    disk = make_disk(image, results / "disk.img")
    told = results / "installed.json"
    for is_over in (told.exists, lambda: False):
        machine.boot(
            disk,
            results,
            time_limit_s=TIME_LIMIT_S,
            program="tests.system.guest.installing",
            keeps_changes=True,
            is_over=is_over,
        )
    assert json.loads(told.read_text())["code"] == 0, told.read_text()
    return dict(json.loads((results / "found.json").read_text()))


def make_disk(image: Path, disk: Path) -> Path:
    """A copy of the image that has a journal, as installed systems have."""
    subprocess.run(["cp", "--sparse=always", str(image), str(disk)], check=True)
    subprocess.run(["tune2fs", "-j", str(disk)], check=True, stdout=subprocess.DEVNULL)
    return disk


def test_the_package_is_installed_and_every_file_is_whole(found):
    assert found["state"] == "install ok installed"
    assert found["audit"] == found["verified"] == ""


def test_every_compiled_kernel_is_whole_also_the_last_one(found):
    assert all(found["kernels"].values())
    assert found["kernels"][f"{LEFT_OUT}.nbc"]
    assert found["kernels"][f"{LEFT_OUT}.code"]


def test_the_service_starts_and_makes_its_pad(found):
    assert found["checked"]["code"] == 0, found["checked"]["err"]
    assert found["started"]["code"] == 0, found["started"]["err"]
    assert found["show"] == {"ActiveState": "active", "NRestarts": "0"}
    assert found["pad"]

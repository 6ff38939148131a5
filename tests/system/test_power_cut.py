"""The power is cut in the middle of saving: a saved file is whole, and what was said stays.

QEMU is killed, so what the guest's kernel had not yet written is lost, as it is with the power.
"""

import json
import os
import random
import subprocess
import sys
from pathlib import Path

import pytest

from tests.kernel.conftest import NUMBA
from tests.kernel.machine import boot, fetch_kernel, require_packages
from tests.system.conftest import CHOSEN, IN_CONTAINER

N_CUTS = 4
SIZE = "64M"
TIME_LIMIT_S = 900.0


@pytest.fixture(scope="module")
def cuts(tmp_path_factory) -> list[tuple[dict, list[str]]]:
    """Of each cut: what was found after it, and the saves that had been told before it."""
    if os.environ.get("NEUROTOUCH_SYSTEM_TEST") != "1":
        pytest.skip("boots a kernel several times, which takes minutes: make system-test")
    if IN_CONTAINER:
        pytest.skip("a container has no power of its own: make system-test without MACHINE")
    if CHOSEN:
        pytest.skip("only chapters were chosen")
    require_packages()
    kernel, results = fetch_kernel(), tmp_path_factory.mktemp("power")
    disk = results / "disk.img"
    subprocess.run(["mke2fs", "-q", "-t", "ext4", str(disk), SIZE], check=True)
    chance = random.Random(19)
    settings = [f"{name}={value}" for name, value in NUMBA.items()]
    for turn in range(N_CUTS + 1):
        found, told = results / f"found{turn}.json", results / f"saved{turn}"
        enough = chance.randint(4, 12) if turn < N_CUTS else 1
        program = [sys.executable, "-m", "tests.system.guest.saving", str(results), str(turn)]
        console = boot(
            kernel,
            ["env", *settings, *program],
            results,
            time_limit_s=TIME_LIMIT_S,
            disk=disk,
            is_over=lambda told=told, enough=enough: count_lines(told) >= enough,
        )
        assert found.exists(), f"turn {turn} did not begin:\n{console[-2000:]}"
    return [
        (
            json.loads((results / f"found{turn + 1}.json").read_text()),
            (results / f"saved{turn}").read_text().split(),
        )
        for turn in range(N_CUTS)
    ]


def count_lines(path: Path) -> int:
    return len(path.read_text().splitlines()) if path.exists() else 0


@pytest.mark.parametrize("cut", range(N_CUTS))
def test_the_last_save_that_was_told_or_the_one_after_it_is_there(cuts, cut):
    found, told = cuts[cut]
    last = int(told[-1])
    assert found["profile"] in (str(last), str(last + 1))


@pytest.mark.parametrize("cut", range(N_CUTS))
def test_every_version_is_whole(cuts, cut):
    found, _ = cuts[cut]
    assert len(found["versions"]) >= 3
    assert all(text.startswith("# ") and text.endswith("\n") for text in found["versions"])
    assert all("bindings:" in text or "extends:" in text for text in found["versions"])


@pytest.mark.parametrize("cut", range(N_CUTS))
def test_nothing_unfinished_stays_for_ever(cuts, cut):
    found, _ = cuts[cut]
    assert found["others"] in ([".history"], [".history", ".lock"])

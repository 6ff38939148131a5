"""Boots the kernel once for pads and once for cameras; hands the tests what the guest saw."""

import fcntl
import functools
import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.kernel.machine import (
    COMPILED,
    ROOT,
    MissingError,
    boot,
    choose_machine,
    fetch_kernel,
    require_packages,
    take_turn,
)

TIME_LIMIT_S = 2000.0 + int(os.environ.get("NEUROTOUCH_PICTURES", "0")) / 5
"""Several times what it takes on two idle cores without hardware virtualisation."""

# Compiled kernels are kept per processor; QEMU's is not ours. For a generic one they are compiled
# here, and the slow guest only loads them.
NUMBA = {"NUMBA_CPU_NAME": "generic", "NUMBA_CACHE_DIR": str(COMPILED)}


@pytest.fixture(scope="session")
def machines(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Boots a machine when it is first asked for, and returns the folder that its guest wrote."""

    @functools.cache
    def booted(machine: str) -> Path:
        try:
            require_packages()
            kernel = fetch_kernel()
        except MissingError as error:
            if os.environ.get("NEUROTOUCH_REQUIRE_KERNEL") == "1":
                pytest.fail(f"real-kernel tests are required, but {error}")
            pytest.skip(f"real-kernel tests: {error}")
        folder = tmp_path_factory.mktemp(machine)
        prepare(machine, folder / "tour.aedat4")
        settings = [f"{name}={value}" for name, value in (NUMBA | read_wishes()).items()]
        program = ["env", *settings, sys.executable, "-m", "tests.kernel.guest", str(folder)]
        with take_turn():
            console = boot(
                kernel,
                [*program, machine],
                folder,
                time_limit_s=TIME_LIMIT_S,
                n_processors=2 if machine == "processors" else 1,
            )
        (folder / "console.txt").write_text(console)
        return folder

    return booted


@pytest.fixture(scope="module")
def results(request: pytest.FixtureRequest, machines: Callable[[str], Path]) -> Path:
    """What the guest wrote; the tests are skipped where no kernel can be booted."""
    return machines(choose_machine(request.path.name))


@pytest.fixture(scope="module")
def guest(results: Path) -> Callable[[str], Any]:
    """Returns what a chapter of the guest's program saw; no answer is a failure."""

    def saw(chapter: str) -> Any:
        answer = results / f"{chapter}.json"
        if not answer.exists():
            console = (results / "console.txt").read_text()
            pytest.fail(f"the guest gave no answer to {chapter!r}; its console:\n{console[-3000:]}")
        said = json.loads(answer.read_text())
        if "failed" in said:
            pytest.fail(f"in the guest, {chapter!r} failed:\n{said['failed']}")
        return said["saw"]

    return saw


def prepare(machine: str, recording: Path) -> None:
    """Record the tour for the guest, and do here once what compiles all that the guest needs.

    Bytecode too, which nobody else writes where PYTHONDONTWRITEBYTECODE is set: the guest would
    take half a minute for each program that it starts.
    """
    run("compileall", "-q", "neurotouch_hid", "devtools", "tests")
    COMPILED.mkdir(parents=True, exist_ok=True)
    with (COMPILED / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # what several machines need is compiled once
        if machine == "processors":
            run("tests.kernel.film", str(recording.with_name("film.npy")))
        run("tests.kernel.tour", str(recording))
        if machine == "cameras":
            run("tests.kernel.davis")
        play = ["run", "--source", f"file:{recording}", "--device", "memory", "--speed", "max"]
        run("neurotouch_hid", *play)


def read_wishes() -> dict[str, str]:
    """Variables of the environment that are for the guest, too."""
    return {name: os.environ[name] for name in ("NEUROTOUCH_PICTURES",) if name in os.environ}


def run(*module: str) -> None:
    """Run a module here as the guest would."""
    subprocess.run(
        [sys.executable, "-m", *module],
        cwd=ROOT,
        env={**os.environ, **NUMBA},
        stdout=subprocess.DEVNULL,
        check=True,
    )

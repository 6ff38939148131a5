"""Wheel and sdist: everything inside, and found by an installation far from any checkout."""

import os
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import venv
import zipfile
from pathlib import Path

import pytest

from neurotouch_hid.process.processor import find_levels, read_abilities
from neurotouch_hid.resources import find_resources
from tests.processes import run_command

ROOT = Path(__file__).parents[2]
INSIDE = {
    "profiles": [
        "default.yaml",
        "spacecraft.yaml",
        "schema/profile-1.json",
        "schema/user-1.json",
        "schema/gel-1.json",
    ],
    "udev": [path.name for path in (ROOT / "udev").glob("*.rules")],
    "modules-load.d": ["neurotouch.conf"],
    "windows": ["kwin-windows.js", "extension.js", "metadata.json"],
    "desktop": ["neurotouch-hid.desktop"],
}


@pytest.fixture(scope="module")
def python(built, tmp_path_factory) -> Path:
    """A fresh environment with the wheel; what it depends on is lent by this one."""
    folder = tmp_path_factory.mktemp("fresh")
    venv.create(folder, with_pip=False, symlinks=True)
    install(built, next(folder.glob("lib/python*/site-packages")))
    return folder / "bin/python"


def install(built: Path, site: Path) -> None:
    wheel = next(built.glob("*.whl"))
    target = ["--target", str(site), "--no-deps", "--no-index", "--quiet", str(wheel)]
    subprocess.run([sys.executable, "-m", "pip", "install", *target], check=True)


def run(python: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """A command of the fresh environment, far from any checkout."""
    return run_command(
        python,
        *arguments,
        code=None,
        cwd=python.parent,
        env={**os.environ, "PYTHONPATH": sysconfig.get_path("purelib")},
    )


def test_the_wheel_holds_what_comes_along(built):
    with zipfile.ZipFile(next(built.glob("*.whl"))) as wheel:
        names = set(wheel.namelist())
    for kind, files in INSIDE.items():
        for file in files:
            assert f"neurotouch_hid/data/{kind}/{file}" in names
    assert not [name for name in names if name.startswith("tests/")]


def test_the_sdist_holds_what_the_package_is_made_of(built):
    with tarfile.open(next(built.glob("*.tar.gz"))) as sdist:
        names = {name.partition("/")[2] for name in sdist.getnames()}
    wanted = (
        "packaging/debian/control",
        "packaging/requirements.lock",
        "udev",
        "Makefile",
        "tests",
    )
    for file in wanted:
        assert any(name == file or name.startswith(f"{file}/") for name in names), file
    assert not [name for name in names if name.startswith((".cache", ".venv", "dist"))]


@pytest.mark.parametrize("kind", INSIDE)
def test_the_installed_package_finds_its_own(python, kind):
    code = f"from neurotouch_hid.resources import find_resources as f; print(f({kind!r}))"
    said = run(python, "-c", code)
    assert said.returncode == 0, said.stderr
    found = Path(said.stdout.strip())
    assert python.parents[1] in found.parents
    for file in INSIDE[kind]:
        assert (found / file).is_file()


@pytest.mark.parametrize("kind", INSIDE)
def test_a_checkout_finds_the_same(kind):
    for file in INSIDE[kind]:
        assert (find_resources(kind) / file).is_file()


def test_installed_commands_use_them(python):
    listed = run(python, "-m", "neurotouch_hid", "profile", "list")
    assert listed.returncode == 0, listed.stderr
    assert "spacecraft" in listed.stdout
    setup = run(python, "-m", "neurotouch_hid", "setup", "--dry-run")
    assert setup.returncode == 0, setup.stderr
    assert 'KERNEL=="uinput"' in setup.stdout


@pytest.mark.skipif(not find_levels(read_abilities()), reason="needs a processor with x86-64-v2")
def test_kernels_in_the_wheel_are_loaded_and_nothing_is_compiled(built, tmp_path):
    library, site, cache = tmp_path / "library", tmp_path / "site", tmp_path / "cache"
    install(built, library)
    level = {"NUMBA_CPU_NAME": "x86-64-v2", "NUMBA_CPU_FEATURES": ""}
    assert select_median(library, level) == "2.0 compiled"
    shutil.copy(next(built.glob("*.whl")), tmp_path)
    subprocess.run(
        [ROOT / "packaging/add-kernels.sh", *tmp_path.glob("*.whl"), library],
        env={**os.environ, "PYTHON": sys.executable},
        check=True,
        capture_output=True,
    )
    install(tmp_path, site)
    assert select_median(site, {"NUMBA_CACHE_DIR": str(cache)}) == "2.0 loaded"
    assert not cache.exists()


def select_median(site: Path, environment: dict[str, str]) -> str:
    """What a kernel of an installed package answers, and how it came about."""
    code = (
        "import sys; import numpy as np\n"
        "from neurotouch_hid.kernels.order_statistics import select\n"
        "median = select(np.array([3.0, 1.0, 2.0]), 1)\n"
        "print(median, 'compiled' if 'numba' in sys.modules else 'loaded')"
    )
    own = {name: value for name, value in os.environ.items() if not name.startswith("NUMBA")}
    paths = f"{site}:{sysconfig.get_path('purelib')}"
    done = run_command(
        sys.executable, "-c", code, cwd=site, env={**own, "PYTHONPATH": paths, **environment}
    )
    return done.stdout.strip()

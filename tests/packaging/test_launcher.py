"""The Debian package's launcher, whose libraries are where Python does not search."""

import json
import os
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest

from tests.processes import run_command

ROOT = Path(__file__).parents[2]
LIMIT_S = 500
LEFT = "unexplained"
"""Of these kernels the tests see that the launcher can compile; all others are compiled already."""


@pytest.fixture(scope="module")
def launcher(built, tmp_path_factory):
    """The launcher with the wheel in the folder of its libraries; what it needs is linked there."""
    top = tmp_path_factory.mktemp("package")
    libraries = top / "neurotouch-hid"
    wheel = next(built.glob("*.whl"))
    target = ["--target", str(libraries), "--no-deps", "--no-index", "--quiet", str(wheel)]
    subprocess.run([sys.executable, "-m", "pip", "install", *target], check=True)
    for path in Path(sysconfig.get_path("purelib")).iterdir():
        if path.suffix != ".pth" and "neurotouch" not in path.name and path.name != "bin":
            (libraries / path.name).symlink_to(path)
    text = (ROOT / "packaging" / "launcher.py").read_text()
    assert text.count("/usr/lib/neurotouch-hid") == 1
    file = top / "neurotouch"
    file.write_text(text.replace("/usr/lib/neurotouch-hid", str(libraries)))
    for folder in (ROOT / "neurotouch_hid").rglob("kernels/__pycache__"):
        own = libraries / folder.relative_to(ROOT)
        own.mkdir(exist_ok=True)
        for path in (*folder.glob("*.code"), *folder.glob("*.nbc")):
            if not path.name.startswith(f"{LEFT}."):
                shutil.copy(path, own)
    return file


@pytest.mark.parametrize(
    ("given", "used"),
    [("/caches", "/caches"), ("caches", "HOME/.cache"), ("", "HOME/.cache"), (None, "HOME/.cache")],
)
def test_code_is_never_loaded_from_below_the_current_folder(tmp_path, given, used):
    package = tmp_path / "neurotouch_hid"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "__main__.py").write_text(
        "import os\ndef main():\n    print(os.environ['NUMBA_CACHE_DIR'])\n"
    )
    text = (ROOT / "packaging/launcher.py").read_text()
    file = tmp_path / "neurotouch"
    file.write_text(text.replace("/usr/lib/neurotouch-hid", str(tmp_path)))
    named = {} if given is None else {"XDG_CACHE_HOME": given}
    done = run_command(sys.executable, "-I", file, env={"HOME": str(tmp_path), **named})
    assert done.stdout.strip() == f"{used.replace('HOME', str(tmp_path))}/neurotouch"


@pytest.fixture
def run(launcher, tmp_path):
    """Runs the launcher with a Python that knows none of the tests' packages."""
    python = Path(sys.base_prefix) / "bin" / f"python3.{sys.version_info.minor}"
    environment = {
        "PATH": os.environ["PATH"],
        "HOME": str(tmp_path),
        "XDG_RUNTIME_DIR": str(tmp_path),
        # The launcher is there by the name of our folder, so kernels are kept beside their source.
        "XDG_CACHE_HOME": str(launcher.parent),
    }

    def call(*arguments):
        return run_command(python, "-I", launcher, *arguments, env=environment, cwd=tmp_path)

    return call


def test_the_page_beside_a_demo_is_served_and_kernels_are_compiled(run, launcher):
    said = run("demo", "--seconds", "1", "--show", "lines", "--scene", "push").stderr
    assert "http://" in said
    assert "No module" not in said
    assert list(launcher.parent.rglob(f"{LEFT}.*.code"))


def test_several_recordings_are_evaluated_at_once(run, tmp_path):
    run("simulate", "play", "--users", "1", "--minutes", "0.2")
    files = sorted((tmp_path / "play").glob("*.aedat4"))[:2]
    run("evaluate", *map(str, files), "--jobs", "2", "--json", "play.json")
    report = json.loads((tmp_path / "play.json").read_text())
    assert len(report["files"]) == 2

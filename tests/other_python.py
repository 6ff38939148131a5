"""Runs the quick tests with the Python that runs this, and with the oldest or the newest libraries.

    python3.14 -m tests.other_python oldest|newest [ARGUMENTS OF PYTEST ...]

Makes a new environment each time, in ``.cache/python``, beside the list of its libraries.
"""

import os
import platform
import shutil
import subprocess
import sys
import venv
from pathlib import Path

ROOT = Path(__file__).parents[1]

RESOLUTIONS = {"oldest": "lowest-direct", "newest": "highest"}
"""What uv calls the oldest and the newest versions that ``pyproject.toml`` allows. What our
libraries need themselves is the newest in both."""

EXTRAS = ("events", "gel", "lsl", "osc")
"""Without ``desktop``: one of its libraries has to be compiled."""

QUICK = (
    *("files", "gesture", "profile", "recording", "runtime", "tracker"),
    *("stream/test_command.py", "stream/test_targets.py"),
    *(path.name for path in sorted((ROOT / "tests").glob("test_*.py"))),
)
"""What runs in ``tests``: much of our libraries and every kernel, and no other program."""


def main() -> int:
    """Returns the exit code of pytest, or 2 if this was called in another way."""
    match sys.argv[1:]:
        case [("oldest" | "newest") as which, *arguments]:
            name = f"{platform.python_version()}-{platform.machine()}-{which}"
            folder = ROOT / ".cache/python" / name
            make_environment(folder, which)
            return run_tests(folder, arguments)
    print("Use: python -m tests.other_python oldest|newest [ARGUMENTS OF PYTEST ...]")
    return 2


def make_environment(folder: Path, which: str) -> None:
    """Makes a new environment with our libraries and the tools of the quick tests.

    Raises:
        subprocess.CalledProcessError: the libraries cannot be had; the output says why.
    """
    environment, libraries = folder / "environment", folder / "libraries.txt"
    shutil.rmtree(environment, ignore_errors=True)
    venv.create(environment, with_pip=True)
    python = str(environment / "bin/python")
    _run(python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "uv>=0.5")
    uv = (python, "-m", "uv", "pip")
    # What only a compiler brings in, few people with this Python have.
    wheels = ("--no-config", "--quiet", "--python", python, "--only-binary", ":all:")
    extras = [f"--extra={extra}" for extra in EXTRAS]
    resolution = f"--resolution={RESOLUTIONS[which]}"
    _run(*uv, "compile", *wheels, resolution, *extras, "pyproject.toml", "-o", str(libraries))
    ours = ["--editable", ".", "--no-binary", "neurotouch-hid"]
    ours += ["--editable", "devtools", "--no-binary", "neurotouch-hid-devtools"]
    _run(*uv, "install", *wheels, "--requirement", str(libraries), *ours, "--group", "test")


def run_tests(folder: Path, arguments: list[str]) -> int:
    """Runs pytest in the environment and returns its exit code."""
    libraries = (folder / "libraries.txt").read_text().splitlines()
    print(f"Python {platform.python_version()} with", end=" ")
    print(*(each for each in libraries if "==" in each), sep=", ", flush=True)
    command = [str(folder / "environment/bin/python"), "-m", "pytest", "-p", "no:cacheprovider"]
    # In a place of its own: a kernel of another numba would take the place of the developer's.
    settings = {**os.environ, "NUMBA_CACHE_DIR": str(folder / "kernels")}
    paths = [f"tests/{name}" for name in QUICK]
    return subprocess.run(
        [*command, *(arguments or paths)], cwd=ROOT, env=settings, check=False
    ).returncode


def _run(*command: str) -> None:
    subprocess.run(command, cwd=ROOT, check=True)


if __name__ == "__main__":
    sys.exit(main())

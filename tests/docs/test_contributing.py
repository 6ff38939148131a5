"""The first change of CONTRIBUTING is carried out, so that a stranger's first quarter works."""

import re
import shlex
import sys

import pytest

from tests.docs.prose import ROOT
from tests.processes import run_command

_PAGE = (ROOT / "CONTRIBUTING.md").read_text()
STEPS = _PAGE.partition("## A first change")[2].partition("\n## ")[0]
WITH_COPY = """
import sys
from importlib.util import spec_from_file_location

_, copy, name, program, *words = sys.argv

class Copy:
    @staticmethod
    def find_spec(module, *_):
        return spec_from_file_location(module, copy) if module == name else None

sys.meta_path.insert(0, Copy)
sys.argv = [program, *words]
if program == "neurotouch":
    from neurotouch_hid.__main__ import main
    main()
else:
    import pytest
    sys.exit(pytest.main(words))
"""
"""Runs a command with a copy of one module in its place."""


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """Carries out steps 1 and 2 in a copy, and gives a function that runs a command with it."""
    (file,) = re.findall(r"Open `([^`]+)`", STEPS)
    (before,) = re.findall(r"Find `([^`]+)`", STEPS)
    (added,) = re.findall(r"Add a line below it: `([^`]+)`", STEPS)
    copy = tmp_path_factory.mktemp("first_change") / "copy.py"
    lines = (ROOT / file).read_text().splitlines(keepends=True)
    at = lines.index(f"    {before}\n")
    copy.write_text("".join([*lines[: at + 1], f"    {added}\n", *lines[at + 1 :]]))
    module = file.removesuffix(".py").replace("/", ".")

    def run(command, *more):
        words = [*shlex.split(command), *more]
        return run_command(
            sys.executable, "-c", WITH_COPY, copy, module, *words, code=None, cwd=ROOT
        )

    return run


def test_the_new_scene_is_played_half_as_strong(run):
    (command,) = re.findall(r"`(neurotouch demo[^`]+)`", STEPS)
    done = run(command, "--no-page", "--show", "lines", "--seconds", "3")
    assert done.returncode == 0, done.stderr
    peak_mm = float(re.search(r"peak ([\d.]+) mm", done.stdout)[1])
    assert peak_mm == pytest.approx(3.0, abs=0.5)


def test_the_tests_that_are_named_find_the_new_scene(run):
    (command,) = re.findall(r"`(pytest [^`]+)`", STEPS)
    done = run(command, "-n", "0", "-k", "soft-pinch", "-p", "no:cacheprovider")
    assert done.returncode == 0, done.stdout
    assert "1 passed" in done.stdout

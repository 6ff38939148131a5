"""Whatever we start runs nothing from the folder that one happens to be in."""

import os
import re
import sys
from pathlib import Path

import pytest

from neurotouch_hid.process.own_command import make_own_command
from tests.processes import run_command

ROOT = Path(__file__).parents[2]
STARTS = re.compile(
    r"sys\.executable|multiprocessing|ProcessPoolExecutor|shell=True|create_subprocess_shell"
    r"|os\.(fork|exec|spawn|posix_spawn|popen|system\b)|\[[\"']python"
)
OURS = ("neurotouch_hid", "devtools/neurotouch_devtools", "packaging", "examples")
OWN = ("own_command.py", "own_pool.py")
HOSTILE = ("runpy", "json", "pickle", "signal", "websockets", "numpy", "click", "multiprocessing")
IN_A_POOL = """\
import os, sys
from neurotouch_hid.process.own_pool import open_pool
if __name__ == "__main__":
    with open_pool(1) as pool:
        print(pool.submit(len, "done").result())
    print(os.environ.get("PYTHONSAFEPATH"))  # later processes of others are left alone
"""


@pytest.fixture
def hostile(tmp_path, monkeypatch):
    """A current folder with modules that others have left there."""
    for name in HOSTILE:
        (tmp_path / f"{name}.py").write_text("import os\nos.mkdir('ran')\n")
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("PYTHONSAFEPATH", raising=False)
    return tmp_path


def test_nothing_else_starts_a_python():
    places = {
        f"{path.relative_to(ROOT)}:{number}"
        for folder in OURS
        for path in (ROOT / folder).rglob("*.py")
        if "/build/" not in str(path) and path.name not in OWN
        for number, line in enumerate(path.read_text().splitlines(), 1)
        if STARTS.search(line)
    }
    assert places == set(), "start it by process/own_command.py or own_pool.py"


def test_a_command_of_ours_runs_nothing_from_the_current_folder(hostile):
    run_command(*make_own_command("profile", "list", "--json"))
    assert not (hostile / "ran").exists()


def test_a_page_that_a_demo_starts_runs_nothing_from_the_current_folder(hostile):
    done = run_command(*make_own_command("view", "--edit", "--until-stdin-ends"), input="")
    assert "http://" in done.stdout
    assert not (hostile / "ran").exists()


def test_a_pool_of_processes_runs_nothing_from_the_current_folder(hostile, tmp_path_factory):
    """Its own program is elsewhere, as an installed one is."""
    program = tmp_path_factory.mktemp("bin") / "program.py"
    program.write_text(IN_A_POOL)
    done = run_command(
        sys.executable, program, code=None, env={**os.environ, "PYTHONPATH": str(ROOT)}
    )
    assert done.stdout == "4\nNone\n", done.stderr
    assert not (hostile / "ran").exists()

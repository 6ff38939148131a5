"""Ctrl-C while a command is being loaded; each in a process of its own."""

import os
import signal
import sys
from pathlib import Path

import pytest

from tests.processes import run_command

ROOT = Path(__file__).parents[2]
SWALLOWING = """
import os, signal
try:
    os.kill(os.getpid(), signal.{name})
    for _ in range(1000):
        pass
except BaseException:
    pass
"""
"""Of a library: what comes while it is imported stays there."""
LOADING = """
import time
from neurotouch_hid.process.interrupts import handle_interrupts
handle_interrupts()
try:
    exec({code!r}, {{"__name__": {module!r}}})
    time.sleep(60)
except KeyboardInterrupt:
    print("interrupted")
"""
READ = "exec(open('swallowing.py').read(), {'__name__': __name__})"
MORTAL = f"""
class Mortal:
    def __del__(self):
        {READ}
Mortal()
"""
STARTING = """
import signal, sys
from neurotouch_hid.__main__ import main
sys.argv = ["neurotouch", "--version"]
try:
    main()
except SystemExit:
    print(signal.getsignal(signal.SIGINT) is signal.SIG_IGN)
"""


POOL = """
import os, signal, time
from {module} import {owner}
from neurotouch_hid.process.interrupts import handle_interrupts
from neurotouch_hid.process.own_pool import open_pool
handle_interrupts()
real = {owner}.{name}
def interrupted(*arguments):
    os.kill(os.getpid(), signal.SIGTERM)
    return real(*arguments)
{owner}.{name} = interrupted
try:
    with open_pool(1) as pool:
        pool.submit(abs, -1)
        time.sleep(60)
except KeyboardInterrupt:
    print("interrupted")
"""


@pytest.fixture
def python(tmp_path):
    """Runs Python with what lies in ``tmp_path`` before everything else."""

    def run(*arguments, ignores=False):
        before = signal.signal(signal.SIGINT, signal.SIG_IGN if ignores else signal.SIG_DFL)
        try:
            return run_command(
                sys.executable,
                *arguments,
                code=None,
                cwd=tmp_path,
                env=os.environ | {"PYTHONPATH": os.pathsep.join([str(tmp_path), str(ROOT)])},
            )
        finally:
            signal.signal(signal.SIGINT, before)

    return run


def test_before_there_is_a_command_line_the_process_just_ends(python, tmp_path):
    (tmp_path / "click.py").write_text(SWALLOWING.format(name="SIGINT"))
    done = python("-m", "neurotouch_hid", "run")
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "Stopped.\n")


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM"])
def test_while_a_command_imports_the_process_just_ends(python, tmp_path, name):
    (tmp_path / "swallowing.py").write_text(SWALLOWING.format(name=name))
    done = python("-c", LOADING.format(code="import swallowing", module="neurotouch_hid.cli.run"))
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "Stopped.\n")


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM"])
@pytest.mark.parametrize(
    ("code", "module"),
    [
        ("import swallowing", "neurotouch_hid.runtime.warmup"),
        (READ, "pydantic.main"),
        (MORTAL, "neurotouch_hid.cli.run"),
    ],
)
def test_elsewhere_it_waits_until_nobody_can_swallow_it(python, tmp_path, name, code, module):
    (tmp_path / "swallowing.py").write_text(SWALLOWING.format(name=name))
    done = python("-c", LOADING.format(code=code, module=module))
    assert (done.returncode, done.stdout, done.stderr) == (0, "interrupted\n", "")


@pytest.mark.parametrize(
    ("module", "owner", "name"),
    [
        ("multiprocessing", "forkserver", "read_signed"),
        ("concurrent.futures.process", "_ExecutorManagerThread", "start"),
    ],
)
def test_what_a_pool_is_just_starting_is_ended_too(python, module, owner, name):
    """A process that was forgotten would find nothing of its pool, and print a traceback."""
    done = python("-c", POOL.format(module=module, owner=owner, name=name))
    assert (done.returncode, done.stdout, done.stderr) == (0, "interrupted\n", "")


def test_python_still_loses_an_interrupt_that_comes_in_del(python, tmp_path):
    """When this fails, ``handle_interrupts`` no longer needs to look at who is interrupted."""
    (tmp_path / "swallowing.py").write_text(
        "import os, signal; os.kill(os.getpid(), signal.SIGINT)"
    )
    done = python("-c", MORTAL + "print('lost')")
    assert done.stdout == "lost\n"
    assert "KeyboardInterrupt" in done.stderr


@pytest.mark.parametrize("ignores", [True, False])
def test_who_ignores_it_goes_on_doing_so(python, ignores):
    done = python("-c", STARTING, ignores=ignores)
    assert done.stdout.splitlines()[-1] == str(ignores)

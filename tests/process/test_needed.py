"""Python and numba still do what these tricks prevent: whoever sees one fail may delete the trick.

The other tricks of ``process/`` have such a test beside their own tests.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import neurotouch_hid
from neurotouch_hid.process import own_command
from tests.processes import run_command

PACKAGE = Path(neurotouch_hid.__file__).parent


def say(*command: str, cwd: Path | None = None, **environment: str) -> str:
    inherited = {k: v for k, v in os.environ.items() if not k.startswith(("NUMBA", "PYTHON"))}
    done = run_command(
        *command, cwd=cwd, env=inherited | {"PYTHONPATH": str(PACKAGE.parent)} | environment
    )
    return done.stdout.strip()


OLD_GARBAGE = """
import contextlib, gc, weakref
from neurotouch_hid.process.gc_freeze import freeze_gc

class Node:
    pass

def make_old_garbage():
    node = Node()
    node.me = node
    gc.collect()  # it is in use, so it counts as old from now on
    return weakref.ref(node)

found, new = make_old_garbage(), []
with {block}:
    while found() is not None and len(new) < 1_000_000:
        new.append([])
print(found() is None)
"""


def test_python_looks_through_what_is_old_unless_it_is_frozen():
    plain = say(sys.executable, "-c", OLD_GARBAGE.format(block="contextlib.nullcontext()"))
    assert plain == "True", "Python leaves old objects alone by itself: freeze_gc may go"
    assert say(sys.executable, "-c", OLD_GARBAGE.format(block="freeze_gc()")) == "False"


ARENAS = """
import ctypes, os, sys, tempfile, threading
from neurotouch_hid.process.arenas import share_arenas

libc = ctypes.CDLL(None)
libc.fdopen.restype = ctypes.c_void_p
if sys.argv[1] == "shared":
    share_arenas()
together = threading.Barrier(6)

def work():
    parts = [bytes(4_000) for _ in range(100)]
    together.wait()

threads = [threading.Thread(target=work) for _ in range(together.parties)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
with tempfile.TemporaryFile() as said:
    stream = ctypes.c_void_p(libc.fdopen(os.dup(said.fileno()), b"w"))
    libc.malloc_info(0, stream)
    libc.fclose(stream)
    said.seek(0)
    print(said.read().count(b"<heap "))
"""


def test_each_thread_gets_an_arena_of_its_own_unless_they_share():
    apart = int(say(sys.executable, "-c", ARENAS, "apart"))
    assert apart > 2, "the C library lets threads share by itself: share_arenas may go"
    assert int(say(sys.executable, "-c", ARENAS, "shared")) == 2


def test_numba_alone_misses_an_update_of_an_imported_constant(tmp_path):
    """Our own cache notices it, see ``test_kernel_cache.py``."""
    (tmp_path / "plain.py").write_text(
        "from numba import njit\nfrom constants import TWO\n\n\n"
        "@njit(cache=True)\ndef call(x):\n    return TWO * x\n"
    )
    constants = tmp_path / "constants.py"
    constants.write_text("TWO = 2\n")
    command = (sys.executable, "-c", "from plain import call; print(call(3))")
    assert say(*command, PYTHONPATH=str(tmp_path)) == "6"
    constants.write_text("TWO = 2 + 2\n")
    after = say(*command, PYTHONPATH=str(tmp_path))
    assert after == "6", "numba sees what a kernel imports: kernel_cache may go"


def test_isolated_python_finds_no_package_beside_it(tmp_path):
    """The Debian package's libraries are in such a folder, which only its launcher knows."""
    package = tmp_path / "neurotouch_hid"
    (package / "process").mkdir(parents=True)
    for name in ("__init__.py", "process/__init__.py"):
        (package / name).touch()
    shutil.copy(own_command.__file__, package / "process/own_command.py")
    (package / "__main__.py").write_text("print('started')\n")
    isolated = (sys.executable, "-I", "-S")
    plain = run_command(*isolated, "-m", "neurotouch_hid", code=None, cwd=tmp_path)
    assert "No module named neurotouch_hid" in plain.stderr, "own_command may go"
    launcher = (
        f"import subprocess, sys; sys.path.insert(0, {str(tmp_path)!r}); "
        "from neurotouch_hid.process.own_command import make_own_command; "
        "subprocess.run(make_own_command())"
    )
    assert say(*isolated, "-c", launcher, cwd=tmp_path) == "started"


def test_pydantic_searches_all_packages_for_plugins_unless_it_is_told_not_to():
    program = (
        "import importlib.metadata as packages; "
        "packages.distributions = lambda **_: print('searched') or []; "
        "import pydantic; pydantic.create_model('A', a=(int, 0))"
    )
    plain = say(sys.executable, "-c", program)
    assert plain == "searched", "leave_out_pydantic_plugins may go"
    told = "from neurotouch_hid.process.startup import *; leave_out_pydantic_plugins(); "
    assert say(sys.executable, "-c", told + program) == ""


FAILING_OUTPUT = """
import os, sys
from neurotouch_hid.process.dead_output import silence
sys.stdout.write("lost")
if len(sys.argv) > 1:
    silence(sys.stdout)
"""


def end_with_dead_output(*arguments: str) -> tuple[int, str]:
    """Returns exit code and errors of a program whose reader goes before it ends."""
    reader, writer = os.pipe()
    os.close(reader)
    done = subprocess.run(
        [sys.executable, "-c", FAILING_OUTPUT, *arguments],
        stdout=writer,
        stderr=subprocess.PIPE,
        text=True,
        check=False,
        env=os.environ | {"PYTHONPATH": str(PACKAGE.parent), "PYTHONUNBUFFERED": ""},
    )
    os.close(writer)
    return done.returncode, done.stderr


def test_python_fails_at_the_end_if_nobody_reads_its_output():
    code, errors = end_with_dead_output()
    assert code != 0, "Python ends well with a dead output: dead_output.silence may go"
    assert "BrokenPipeError" in errors
    assert end_with_dead_output("silence") == (0, "")


def test_a_fork_server_imports_from_the_current_folder_unless_it_is_told_not_to(tmp_path):
    """``own_pool`` tells it, and so does ``own_command``; see ``test_own_command.py``."""
    program = (
        "from multiprocessing import get_context; from importlib.util import find_spec\n"
        "if __name__ == '__main__':\n"
        "    with get_context('forkserver').Pool(1) as pool:\n"
        "        print(pool.apply(find_spec, ('found_here',)) is not None)"
    )
    (tmp_path / "found_here.py").touch()
    plain = say(sys.executable, "-c", program, cwd=tmp_path)
    assert plain == "True", "Python leaves the current folder alone: own_pool may go"
    assert say(sys.executable, "-c", program, cwd=tmp_path, PYTHONSAFEPATH="1") == "False"

"""Ctrl-C and SIGTERM at any moment of a start: one word, no traceback, the documented exit code."""

import asyncio
import os
import signal
import subprocess
import sys

import pytest

from neurotouch_hid.page.server import EndBySignal
from tests.docs.prose import ROOT
from tests.processes import run_command

START = """\
import os, signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)  # also where the tests ignore it
moment, number = int(sys.argv[1]), int(sys.argv[2])
del sys.argv[1:3]
from neurotouch_hid.__main__ import main
me, seen = os.getpid(), 0
def watch(event, arguments):  # what Python reports of itself: imports, files, sockets, threads
    global seen
    seen += os.getpid() == me
    if seen == moment:
        seen += 1
        os.kill(me, number)
sys.addaudithook(watch)
main()
"""
MOMENTS = (20, 300, 1500, 4000, 9000)
"""Of the 6,000 (view) to 16,000 (doctor) events of a start: the first lines, command line, imports
of the command, of the libraries, of the kernels. A ``view`` has begun to serve before the last."""

SERVING = ("view", "game --no-open")


@pytest.mark.parametrize(
    "command",
    [
        *SERVING,
        "demo --seconds 1",
        "run --source sim:tour --device memory --seconds 1",
        "record out.aedat4 --source sim:tour --seconds 1",
        "calibrate --source sim:tour --seconds 1",
        "evaluate nothing.aedat4",
        "doctor",
    ],
)
@pytest.mark.parametrize("moment", MOMENTS)
def test_signal_during_the_start(tmp_path, command, moment):
    number = (signal.SIGINT, signal.SIGTERM)[(MOMENTS.index(moment) + len(command)) % 2]
    with subprocess.Popen(
        [sys.executable, "-c", START, str(moment), str(int(number)), *command.split()],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=tmp_path,
        env={**os.environ, "XDG_RUNTIME_DIR": str(tmp_path)},
    ) as process:
        try:
            printed, said = process.communicate(timeout=5 if command in SERVING else 60)
        except subprocess.TimeoutExpired:  # it serves, and had no 9,000 events
            process.send_signal(number)
            printed, said = process.communicate(timeout=30)
    assert process.returncode in (0, 4, 130), said
    for words in ("Traceback", "Exception", "asyncio", "never awaited", "Warning: the page"):
        assert words not in printed + said
    if process.returncode == 130:
        assert said.splitlines()[-1] == "Stopped."


ENDING = """\
import atexit, os, signal, sys
from neurotouch_hid.cli.main import main
number = int(sys.argv[1])
atexit.register(lambda: os.kill(os.getpid(), number))
signal.signal(signal.SIGINT, signal.default_int_handler)  # also where the tests ignore it
sys.argv = ["neurotouch", "--version"]
main()
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_another_signal_while_it_ends_leaves_no_traceback(number):
    done = run_command(sys.executable, "-c", ENDING, str(int(number)), code=None)
    assert done.stderr == ""
    assert done.returncode == 130


@pytest.fixture
def restored():
    before = {number: signal.getsignal(number) for number in (1, 2, 15)}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.usefixtures("restored")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_page_ends_at_a_signal_before_during_and_after_its_loop(number):
    end = EndBySignal()

    async def serve(*, during):
        stop = asyncio.Event()
        end.tell(asyncio.get_running_loop(), stop)
        if during:
            os.kill(os.getpid(), number)
        await asyncio.wait_for(stop.wait(), 30)

    asyncio.run(serve(during=True))
    os.kill(os.getpid(), number)  # after: the loop is closed
    asyncio.run(serve(during=False))  # before: the signal has come already


def test_nothing_slow_is_imported_before_signals_are_handled():
    code = (
        "import sys; before = set(sys.modules); import neurotouch_hid.__main__; "
        "print(sorted({'typing', 'contextlib', 're', 'click'} "
        "& (set(sys.modules) - before)))"
    )
    done = run_command(
        sys.executable, "-S", "-c", f"import sys; sys.path.insert(0, {str(ROOT)!r}); {code}"
    )
    assert done.stdout == "[]\n"

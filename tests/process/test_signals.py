"""Signals end the line or reload; each in a process of its own, handlers are never put back."""

import os
import signal
import subprocess
import sys

import pytest

from neurotouch_hid.client import ask_status
from neurotouch_hid.errors import DriverError
from tests.processes import make_environment, run_command
from tests.waiting import wait_until

PROGRAM = """
import os, signal
from neurotouch_hid.process.signals import stop_on_signals
{before}
reloads = []
stop = stop_on_signals({reload})
for name in {names!r}:
    os.kill(os.getpid(), getattr(signal, name))
print(stop.is_set(), len(reloads))
"""
RELOAD = "lambda: reloads.append(1)"
NOHUP = "signal.signal(signal.SIGHUP, signal.SIG_IGN)"


@pytest.mark.parametrize(
    ("reload", "before", "names", "said"),
    [
        (RELOAD, "", ["SIGINT"], "True 0"),
        (RELOAD, "", ["SIGTERM", "SIGTERM"], "True 0"),
        (RELOAD, "", ["SIGHUP", "SIGHUP"], "False 2"),
        ("", "", ["SIGHUP"], "True 0"),
        (RELOAD, NOHUP, ["SIGHUP"], "False 1"),
        ("", NOHUP, ["SIGHUP"], "False 0"),
    ],
)
def test_signal(reload, before, names, said):
    code = PROGRAM.format(reload=reload, before=before, names=names)
    done = run_command(sys.executable, "-c", code)
    assert done.stdout.strip() == said


INTERRUPTED = """
import os, signal, sys
from neurotouch_hid.process.signals import stop_on_signals
stop = stop_on_signals()
def come_between(frame, event, _):
    if event == "call" and frame.f_code.co_name in ("set", "notify_all"):
        sys.setprofile(None)
        os.kill(os.getpid(), signal.SIGTERM)
        sys.setprofile(come_between if frame.f_code.co_name == "set" else None)
sys.setprofile(come_between)
os.kill(os.getpid(), signal.SIGINT)
print(stop.is_set())
"""


def test_a_signal_that_comes_while_another_is_obeyed_holds_nothing_up():
    """As at a logout, which sends two at once."""
    done = run_command(sys.executable, "-c", INTERRUPTED)
    assert done.stdout.strip() == "True"


STOPPING = """\
import sys
import threading
from neurotouch_hid.cli.main import main
from neurotouch_hid.device import MemoryDevice
release = MemoryDevice.neutral
def tell(self):
    release(self)
    if threading.current_thread() is threading.main_thread():  # not the stall guard
        print("RELEASED", flush=True)
MemoryDevice.neutral = tell
sys.argv = "neurotouch run --source sim:tour --device memory --show picture".split()
main()
"""


def test_ctrl_z_releases_the_pad_and_shows_the_cursor_before_the_driver_stops(
    tmp_path, monkeypatch
):
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path / "run"))
    said = tmp_path / "said.txt"
    with said.open("w") as out:
        process = subprocess.Popen(
            [sys.executable, "-c", STOPPING],
            stdout=out,
            stderr=subprocess.STDOUT,
            env=make_environment(tmp_path),
            process_group=0,  # or the kernel ignores the signal where the tests have no terminal
        )
    try:
        wait_until(lambda: "buttons" in said.read_text() or process.poll() is not None)
        for times in (1, 2):
            process.send_signal(signal.SIGTSTP)
            _, status = os.waitpid(process.pid, os.WUNTRACED)
            assert os.WIFSTOPPED(status)
            assert said.read_text().count("RELEASED") == times
            assert said.read_text().count("\x1b[?25h") == times
            with pytest.raises(DriverError, match="was stopped, as by Ctrl-Z") as found:
                ask_status()
            assert f"kill -CONT {process.pid}" in found.value.hint
            process.send_signal(signal.SIGCONT)
            length = len(said.read_text())
            wait_until(lambda before=length: len(said.read_text()) > before)
        process.send_signal(signal.SIGINT)
        assert process.wait(60) == 0
    finally:
        process.kill()
        process.wait()

"""Signals end the line or reload; each in a process of its own, handlers are never put back."""

import sys

import pytest

from tests.processes import run_command

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

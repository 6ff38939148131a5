"""Signals end the line or reload; each in a process of its own, handlers are never put back."""

import subprocess
import sys

import pytest

PROGRAM = """
import os, signal
from neurotouch_hid.runtime.signals import stop_on_signals
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
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == said

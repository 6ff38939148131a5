"""Lets the line's thread wake when it wants to, before others of its machine where permitted."""

import ctypes
import os
import resource
import shutil
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

NICE = -10
"""Before everything usual, behind sound. It counts only among what Linux shares the processor out
to as one: the programs of one terminal or of one service."""
PRIORITY = 1
"""Of SCHED_RR, the lowest: before everything usual wherever that runs, behind sound."""
MOST_BUSY_US = 100_000
"""Whoever works for so long without once waiting does not keep up, or hangs, and goes back among
the usual; so a line that hangs does not hold the machine up."""
SLACK_NS = 1_000
"""How late the kernel may wake us to save power; it takes 50 µs without being asked."""
SWITCH_S = 0.001
"""How long a thread that computes in Python may keep the others from running. Python's own 5 ms are
what a game that shakes the pad would wait for its answer; the line is as quick with either."""

_PR_SET_TIMERSLACK = 29  # prctl(2)
_RTKIT = "org.freedesktop.RealtimeKit1"
_PATIENCE_S = 2.0


@contextmanager
def hurry() -> Iterator[None]:
    """Prefers the calling thread meanwhile, as far as this machine permits; it works without.

    By our own right with SCHED_RR, and the threads that it starts as well; else rtkit is asked,
    which grants a better nice value to who sits at the machine. (It grants SCHED_RR too, but only
    to who accepts to be killed for being busy for 0.2 s.) Only the main thread gets SCHED_RR, for
    only there is heard that it has been busy for too long.
    """
    sys.setswitchinterval(SWITCH_S)
    with suppress(OSError, AttributeError):  # no Linux, no prctl
        ctypes.CDLL(None).prctl(_PR_SET_TIMERSLACK, SLACK_NS, 0, 0, 0)
    before = os.getpriority(os.PRIO_PROCESS, threading.get_native_id())
    _raise()
    try:
        yield
    finally:
        _go_back()
        with suppress(OSError):
            os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), before)


def _raise() -> None:
    thread = threading.get_native_id()
    if os.getpriority(os.PRIO_PROCESS, thread) > NICE:  # else whoever started us has chosen
        try:
            os.setpriority(os.PRIO_PROCESS, thread, NICE)
        except OSError:
            _ask_rtkit(thread)
    if threading.current_thread() is threading.main_thread():
        with suppress(OSError, ValueError):  # a sandbox may forbid either
            signal.signal(signal.SIGXCPU, _go_back)
            _, most = resource.getrlimit(resource.RLIMIT_RTTIME)
            resource.setrlimit(resource.RLIMIT_RTTIME, (MOST_BUSY_US, most))
            os.sched_setscheduler(thread, os.SCHED_RR, os.sched_param(PRIORITY))


def _go_back(*_: object) -> None:
    """All threads of the process: it does not say which one was busy for too long."""
    for task in Path("/proc/self/task").iterdir():
        with suppress(OSError):
            os.sched_setscheduler(int(task.name), os.SCHED_OTHER, os.sched_param(0))


def _ask_rtkit(thread: int) -> None:
    busctl = shutil.which("busctl")
    if busctl is None:
        return
    path = "/" + _RTKIT.replace(".", "/")
    call = [_RTKIT, path, _RTKIT, "MakeThreadHighPriorityWithPID", "tti"]
    numbers = [str(number) for number in (os.getpid(), thread, NICE)]
    with suppress(OSError, subprocess.TimeoutExpired):
        subprocess.run(  # noqa: S603  # our own command
            [busctl, "--system", "call", *call, "--", *numbers],
            capture_output=True,
            timeout=_PATIENCE_S,
            check=False,
        )

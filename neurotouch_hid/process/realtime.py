"""Wakes the pipeline's thread in time, before others of the machine where that is permitted."""

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

from neurotouch_hid.process.gc_freeze import freeze_gc

NICE = -10
"""Before all usual programs, behind sound. It counts only within a group to which Linux gives a
share of the processor: the programs of one terminal or of one service."""
PRIORITY = 1
"""The lowest of SCHED_RR: before all usual programs of all groups, behind sound."""
MOST_BUSY_US = 100_000
"""A thread that works for this time without waiting does not keep up, or hangs, and gets the usual
priority again; so a pipeline that hangs does not stop the machine."""
PAUSE_S = 1.0
"""After this pause the thread is preferred again. A pipeline that was held up for a moment must not
be slow for the rest of the day; one that hangs takes a tenth of one core before others."""
SLACK_NS = 1_000
"""The kernel may wake us late by this time to save power; its default is 50 µs."""
SWITCH_S = 0.0001
"""A thread that computes in Python gives way to others after this time. With Python's own 5 ms a
slice would wait while a frame is processed, and a game that shakes the pad for its answer."""

_PR_SET_TIMERSLACK = 29  # prctl(2)
_RTKIT = "org.freedesktop.RealtimeKit1"
_PATIENCE_S = 2.0


@contextmanager
def realtime_priority() -> Iterator[None]:
    """Prefers the calling thread meanwhile, as far as this machine permits; it works without.

    With the right to it, the thread and those that it starts get SCHED_RR. Otherwise rtkit is
    asked, which grants a better nice value to the person at the machine. (It grants SCHED_RR too,
    but Linux then kills a process that is busy for 0.2 s.) Only the main thread gets SCHED_RR,
    because the signal for a thread that is busy for too long arrives there. Meanwhile garbage
    collection is short.
    """
    sys.setswitchinterval(SWITCH_S)
    with suppress(OSError, AttributeError):  # no Linux, no prctl
        ctypes.CDLL(None).prctl(_PR_SET_TIMERSLACK, SLACK_NS, 0, 0, 0)
    thread = threading.get_native_id()
    before = os.getpriority(os.PRIO_PROCESS, thread)
    if before > NICE:  # else the parent process has chosen
        try:
            os.setpriority(os.PRIO_PROCESS, thread, NICE)
        except OSError:
            _ask_rtkit(thread)
    real_time = _RealTime()
    if threading.current_thread() is threading.main_thread():
        real_time.begin()
    try:
        with freeze_gc():
            yield
    finally:
        real_time.end()
        with suppress(OSError):
            os.setpriority(os.PRIO_PROCESS, thread, before)


class _RealTime:
    """SCHED_RR for the main thread and those it starts, with a pause whenever they are too busy."""

    def __init__(self) -> None:
        self._again: threading.Timer | None = None

    def begin(self) -> None:
        """Prefers this thread, if that is permitted."""
        with suppress(OSError, ValueError):  # a sandbox may forbid either
            signal.signal(signal.SIGXCPU, self._pause)
            self._prefer({threading.get_native_id()})

    def end(self) -> None:
        """Gives all threads the usual priority for good."""
        if self._again is not None:
            self._again.cancel()
            self._again.join()
        _go_back()

    def _pause(self, *_: object) -> None:
        preferred = _go_back()
        if preferred:
            self._again = threading.Timer(PAUSE_S, self._prefer, (preferred,))
            self._again.daemon = True
            self._again.start()

    def _prefer(self, threads: set[int]) -> None:
        _, most = resource.getrlimit(resource.RLIMIT_RTTIME)
        # Again each time: the kernel raises it by a second whenever it is reached.
        resource.setrlimit(resource.RLIMIT_RTTIME, (MOST_BUSY_US, most))
        for thread in _list_threads() & threads:
            with suppress(OSError):  # it may have ended
                os.sched_setscheduler(thread, os.SCHED_RR, os.sched_param(PRIORITY))


def _go_back() -> set[int]:
    """Returns the threads of this process that were preferred.

    The kernel does not say which was busy.
    """
    preferred = set()
    for thread in _list_threads():
        with suppress(OSError):
            if os.sched_getscheduler(thread) == os.SCHED_RR:
                os.sched_setscheduler(thread, os.SCHED_OTHER, os.sched_param(0))
                preferred.add(thread)
    return preferred


def _list_threads() -> set[int]:
    return {int(task.name) for task in Path("/proc/self/task").iterdir()}


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

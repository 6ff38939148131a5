"""The line's thread is preferred where that is permitted, and goes on where it is not."""

import json
import os
import sys

import pytest

from neurotouch_hid.process import realtime
from tests.processes import run_command

SCRIPT = """
import ctypes, json, os, sys, threading, time
from neurotouch_hid.process.realtime import realtime_priority
if sys.argv[1] == "user":
    os.setuid(65534)
def look():
    thread = threading.get_native_id()
    policy = os.sched_getscheduler(thread)
    said.append([policy, os.getpriority(os.PRIO_PROCESS, thread)])
def look_in_thread():
    thread = threading.Thread(target=look)
    thread.start()
    thread.join()
said = []
look()
older = threading.Thread(target=lambda: (go.wait(), look()))
go = threading.Event()
older.start()
with realtime_priority():
    look()
    said.append(round(1e6 * sys.getswitchinterval()))
    look_in_thread()  # begins now, as the camera's does
    said.append(ctypes.CDLL(None).prctl(30, 0, 0, 0, 0))  # PR_GET_TIMERSLACK
    go.set()
    older.join()
    for _ in range(2):
        begun = time.monotonic()
        while os.sched_getscheduler(0) and time.monotonic() - begun < 60.0:
            pass  # hangs
        look()
        begun = time.monotonic()
        while not os.sched_getscheduler(0) and time.monotonic() - begun < float(sys.argv[2]):
            time.sleep(0.01)  # keeps up again
        look()
look()
print(json.dumps(said))
"""


@pytest.mark.skipif(os.geteuid() != 0, reason="only root may raise and drop rights")
@pytest.mark.parametrize(("who", "raised"), [("root", True), ("user", False)])
def test_the_line_is_preferred_while_it_plays_but_not_while_it_hangs(who, raised):
    nice = os.getpriority(os.PRIO_PROCESS, 0)
    patience_s = "60" if raised else "1.5"  # nobody will come back who never was preferred
    done = run_command(sys.executable, "-c", SCRIPT, who, patience_s)
    before, line, switch_us, camera, slack, older, *turns, after = json.loads(done.stdout)
    usual = [os.SCHED_OTHER, nice]
    raised_nice = -10 if raised else nice
    assert slack <= 1_000
    assert switch_us == 100
    assert before == after == older == usual
    assert line == camera == [os.SCHED_RR if raised else os.SCHED_OTHER, raised_nice]
    hung = [os.SCHED_OTHER, raised_nice]
    assert turns == [hung, line, hung, line]


def test_the_system_still_starts_us_among_the_usual():
    """When this fails, that part of ``realtime_priority`` is no longer needed."""
    program = """
import ctypes, os, sys
print(ctypes.CDLL(None).prctl(30, 0, 0, 0, 0), sys.getswitchinterval(), os.sched_getscheduler(0))
"""
    told = run_command(sys.executable, "-c", program)
    slack_ns, switch_s, scheduler = told.stdout.split()
    assert int(slack_ns) > realtime.SLACK_NS
    assert float(switch_s) > realtime.SWITCH_S
    assert int(scheduler) == os.SCHED_OTHER

"""Ends the pipeline in order on signals; SIGHUP loads the profile again."""

import os
import signal
import threading
from collections.abc import Callable


def stop_on_signals(reload: Callable[[], object] | None = None) -> threading.Event:
    """Makes Ctrl-C and SIGTERM set the returned event and do nothing else; repeating is harmless.

    SIGHUP reloads, unless it comes because the terminal was closed: then it ends the pipeline too,
    except under nohup.
    Nothing puts the former behaviour back: the pad is to be released undisturbed. Only the main
    thread may call this.

    Args:
        reload: is called on SIGHUP and must be safe in a signal handler; without, SIGHUP ends the
            pipeline.
    """
    stop = threading.Event()
    outlives = signal.getsignal(signal.SIGHUP) is signal.SIG_IGN  # nohup has set this
    attached = _has_terminal()
    is_ending = False

    def end(*_: object) -> None:
        nonlocal is_ending
        if not is_ending:  # a signal in the middle of ``set`` would wait for the code it interrupts
            is_ending = True
            stop.set()

    def hang_up(*_: object) -> None:
        if not outlives and (reload is None or (attached and not _has_terminal())):
            end()
        elif reload is not None:
            reload()

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, end)
    signal.signal(signal.SIGHUP, hang_up)
    return stop


def _has_terminal() -> bool:
    """Returns True if the process has a terminal that controls it; a closed one is none."""
    try:
        os.close(os.open("/dev/tty", os.O_RDONLY | os.O_NOCTTY))
    except OSError:
        return False
    return True

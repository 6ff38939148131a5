"""Ends the pipeline in order on signals; SIGHUP loads the profile again."""

import os
import signal
import threading
import time
from collections.abc import Callable
from types import FrameType
from typing import Final

_PATIENCE_S: Final = 1.0
"""A signal that comes sooner after the first is no second wish: a logout sends two at once."""
_CALLERS: Final = frozenset(
    {"neurotouch_hid.plugins", "neurotouch_hid.source.plugin", "neurotouch_hid.gesture.method"}
)
"""The modules that call other packages."""


class NotReturned(BaseException):
    """Code of another package that is still at work when the end is asked for again."""


def stop_on_signals(reload: Callable[[], object] | None = None) -> threading.Event:
    """Makes Ctrl-C and SIGTERM set the returned event and do nothing else; repeating is harmless.

    Only code of another package that does not return is ended by a second signal, with an error.
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
    ending_s = 0.0

    def end(_: object = None, frame: FrameType | None = None) -> None:
        nonlocal ending_s
        if not ending_s:  # a signal in the middle of ``set`` would wait for the code it interrupts
            ending_s = time.monotonic()
            stop.set()
        elif time.monotonic() - ending_s > _PATIENCE_S and _is_in_package(frame):
            raise NotReturned("it does not return, and was ended by a second signal")

    def hang_up(*_: object) -> None:
        if not outlives and (reload is None or (attached and not _has_terminal())):
            end()
        elif reload is not None:
            reload()

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, end)
    signal.signal(signal.SIGHUP, hang_up)
    return stop


class TerminalStop:
    """Stops the process on Ctrl-Z (SIGTSTP), but first calls what has to be done before.

    Only the main thread may make it. Where the signal is ignored, it stays so.

    Args:
        prepare: is called just before the process stops.
    """

    def __init__(self, prepare: Callable[[], object]) -> None:
        self._prepare = prepare
        self._is_wanted = False
        self._has_begun = signal.getsignal(signal.SIGTSTP) is not signal.SIG_IGN
        if self._has_begun:
            signal.signal(signal.SIGTSTP, self._ask)

    def take(self) -> None:
        """Stops the process if that was asked for; returns when it continues."""
        if self._is_wanted:
            self._is_wanted = False
            self._prepare()
            self._stop()

    def close(self) -> None:
        """Makes Ctrl-Z stop the process at once again."""
        if self._has_begun:
            signal.signal(signal.SIGTSTP, signal.SIG_DFL)

    def _ask(self, *_: object) -> None:
        if self._is_wanted:  # a second one: the main thread is busy elsewhere
            self._stop()
        self._is_wanted = True

    def _stop(self) -> None:
        signal.signal(signal.SIGTSTP, signal.SIG_DFL)
        signal.raise_signal(signal.SIGTSTP)  # in this thread, so it has stopped here
        signal.signal(signal.SIGTSTP, self._ask)


def _is_in_package(frame: FrameType | None) -> bool:
    """Returns True if code of another package runs there."""
    while frame is not None and frame.f_globals.get("__name__") not in _CALLERS:
        frame = frame.f_back
    return frame is not None


def _has_terminal() -> bool:
    """Returns True if the process has a terminal that controls it; a closed one is none."""
    try:
        os.close(os.open("/dev/tty", os.O_RDONLY | os.O_NOCTTY))
    except OSError:
        return False
    return True

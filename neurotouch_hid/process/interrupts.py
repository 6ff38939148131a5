"""Ends a command on Ctrl-C, SIGTERM and when its terminal is closed, also while it is loaded."""

import _thread
import os
import signal
import time
from contextlib import suppress
from types import FrameType
from typing import Final

EXIT_INTERRUPTED: Final = 130
_COMMANDS: Final = "neurotouch_hid.cli"
_IMPORT: Final = frozenset({"importlib", "_frozen_importlib"})
_POOL: Final = "concurrent.futures.process"
_DELICATE: Final = _IMPORT | {"pydantic", "llvmlite", "weakref", "_weakrefset", _POOL}
"""Modules in which an exception may get lost. A library that is imported swallows it or stays half
made. pydantic takes it for a fault of a schema. llvmlite prints a traceback while it tidies up. A
pool whose threads and processes are just being started can no longer end them. Of an exception in a
weak reference's callback, as in ``__del__``, Python only prints a warning."""
_SOON_S: Final = 0.01


def handle_interrupts() -> None:
    """Makes Ctrl-C, SIGTERM and SIGHUP raise KeyboardInterrupt, except where it could get lost.

    While a command imports its libraries, nothing is open yet, and the process just ends. In other
    code that might lose it, the signal is sent again 10 ms later. A process that ignores Ctrl-C or
    SIGHUP, as in the background or under nohup, goes on ignoring it.
    """
    for number in (signal.SIGINT, signal.SIGHUP):
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _interrupt)
    signal.signal(signal.SIGTERM, _interrupt)


def end_at_next_interrupt() -> None:
    """Makes a further Ctrl-C or SIGTERM end the process at once, because its work is over.

    An exception would end up in what Python still does at the exit, as a traceback.
    """
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) is _interrupt:
            signal.signal(number, lambda *_: os._exit(EXIT_INTERRUPTED))


def _interrupt(number: int, frame: FrameType | None) -> None:
    begin = _find_begin(frame)
    if begin is None:
        raise KeyboardInterrupt
    caller, called = begin
    if caller.startswith(_COMMANDS) and _find_package(called) in _IMPORT:
        with suppress(OSError):  # nobody may be there to read it
            os.write(2, b"Stopped.\n")
        os._exit(EXIT_INTERRUPTED)
    # Not by ``threading``, whose locks the interrupted code may hold.
    _thread.start_new_thread(_repeat, (number,))


def _find_begin(frame: FrameType | None) -> tuple[str, str] | None:
    """Returns the caller that must not be interrupted; None if there is none."""
    begin, delicate = None, ""
    while frame is not None:
        module: str = frame.f_globals.get("__name__") or "?"
        if (
            not _DELICATE.isdisjoint((module, _find_package(module)))
            or frame.f_code.co_name == "__del__"
        ):
            delicate = module
        elif delicate:
            begin, delicate = (module, delicate), ""
        frame = frame.f_back
    return begin


def _find_package(module: str) -> str:
    return module.partition(".")[0]


def _repeat(number: int) -> None:
    """Sends the same signal again, for the handler that is active by then."""
    time.sleep(_SOON_S)
    os.kill(os.getpid(), number)

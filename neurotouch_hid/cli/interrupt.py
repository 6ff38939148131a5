"""How Ctrl-C and SIGTERM end a command, also one that is still being loaded."""

import _thread
import os
import signal
import time
from contextlib import suppress
from types import FrameType
from typing import Final

EXIT_INTERRUPTED: Final = 130
_COMMANDS: Final = "neurotouch_hid.cli"
_DELICATE: Final = {"importlib", "_frozen_importlib", "pydantic"}
"""Where an exception may get lost: a library that is imported swallows it or stays half made,
pydantic takes it for a fault of a schema."""
_SOON_S: Final = 0.01


def heed_interrupts() -> None:
    """From now on Ctrl-C and SIGTERM raise KeyboardInterrupt, but not where it might get lost.

    While a command imports what it needs, nothing is open yet, and the process just ends. In any
    other import the signal comes again when that is over. Who ignores Ctrl-C, as programs in the
    background do, goes on ignoring it.
    """
    if signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:
        signal.signal(signal.SIGINT, _interrupt)
    signal.signal(signal.SIGTERM, _interrupt)


def _interrupt(number: int, frame: FrameType | None) -> None:
    importer = _find_importer(frame)
    if importer is None:
        raise KeyboardInterrupt
    if importer.startswith(_COMMANDS):
        with suppress(OSError):  # nobody may be there to read it
            os.write(2, b"Stopped.\n")
        os._exit(EXIT_INTERRUPTED)
    # Not by ``threading``, whose locks the interrupted code may hold.
    _thread.start_new_thread(_repeat, (number,))


def _find_importer(frame: FrameType | None) -> str | None:
    """The module that began what must not be broken off; None if nothing of that kind goes on."""
    importer, is_begun = None, False
    while frame is not None:
        module: str = frame.f_globals.get("__name__") or ""
        is_delicate = module.partition(".")[0] in _DELICATE
        if is_begun and not is_delicate:
            importer = module
        is_begun = is_delicate
        frame = frame.f_back
    return importer


def _repeat(number: int) -> None:
    """The same signal again, for whoever handles it by then."""
    time.sleep(_SOON_S)
    os.kill(os.getpid(), number)

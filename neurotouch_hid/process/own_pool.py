"""Processes of our own that share out a long work."""

import os
import signal
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from importlib import import_module
from multiprocessing import active_children, forkserver, get_context, resource_tracker
from tempfile import gettempdir
from typing import Final

_QUICKLY: Final = "neurotouch_hid.process.fork_server"
"""The module that makes imports quick."""

_LONGEST_FOLDER: Final = 70
"""The server listens at a socket in the temporary folder, whose whole path has at most 107 bytes.
With a longer folder each process imports for itself."""


@contextmanager
def open_pool(jobs: int, modules: Sequence[str] = ()) -> Iterator[ProcessPoolExecutor]:
    """Gives processes of our own that work beside this one; they end with the block.

    At Ctrl-C, which reaches every process of a terminal, they end and say nothing.

    They are forked from a server of Python's, which has imported modules and done nothing else. To
    fork this process is not safe: it may have loaded kernels and OpenCV's threads.

    Args:
        jobs: how many at once.
        modules: names of modules that each needs. The server imports them, once for all; it is the
            same for all pools of this process, and only the first one counts.

    Raises:
        OSError: there is no memory that processes can share, for instance.
    """
    is_short = len(os.fsencode(gettempdir())) <= _LONGEST_FOLDER
    context = get_context("forkserver" if is_short else "spawn")
    context.set_forkserver_preload([_QUICKLY, *modules])
    with _without_current_folder():
        if is_short:
            _start_server()
        pool = ProcessPoolExecutor(jobs, mp_context=context, initializer=_begin)
        try:
            yield pool
        finally:
            for process in active_children():  # those that still work, after an error or Ctrl-C
                process.terminate()
            pool.shutdown()


@contextmanager
def _without_current_folder() -> Iterator[None]:
    """Lets what Python starts import nothing from the current folder: ``-P`` of a command."""
    before = os.environ.get("PYTHONSAFEPATH")
    os.environ["PYTHONSAFEPATH"] = "1"
    try:
        yield
    finally:
        if before is None:
            del os.environ["PYTHONSAFEPATH"]
        else:
            os.environ["PYTHONSAFEPATH"] = before


def _start_server() -> None:
    """Starts Python's server so that Ctrl-C does not reach it, nor a process that it has forked.

    While they start, they would answer it with a traceback.
    """
    resource_tracker.ensure_running()  # the server starts it, and Python 3.11 lets Ctrl-C in then
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        forkserver.ensure_running()
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _begin() -> None:
    """Prepares a process of a pool."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    import_module(_QUICKLY)  # up to Python 3.12 the server does not find the Debian package

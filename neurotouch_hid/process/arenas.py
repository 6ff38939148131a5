"""Keeps the memory of a driver that runs for months from growing with each new thread."""

import ctypes
from contextlib import suppress
from typing import Final

N_ARENAS: Final = 2
"""One for the main thread, one for all others."""

_M_ARENA_MAX: Final = -8  # mallopt(3)


def share_arenas() -> None:
    """Lets all threads of this process share two of the arenas from which glibc takes memory.

    By itself glibc gives each thread an arena, up to eight for each processor. An arena keeps most
    of what its threads have freed. As viewers and cameras came and went for hours, one arena after
    the other grew to 8 MB and stayed so.
    """
    with suppress(AttributeError):  # another C library
        ctypes.CDLL(None).mallopt(_M_ARENA_MAX, N_ARENAS)

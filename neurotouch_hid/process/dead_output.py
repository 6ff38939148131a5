"""Silences an output that nobody can read any more."""

import os
import sys
from typing import TextIO


def silence(stream: TextIO) -> None:
    """Makes a stream write to nowhere, after its disk was full or its reader has gone.

    Otherwise Python would try once more at the end, and fail.

    Args:
        stream: one with a descriptor, such as the standard output.
    """
    descriptor = stream.fileno()
    nowhere = os.open(os.devnull, os.O_WRONLY | os.O_CLOEXEC)
    os.dup2(nowhere, descriptor, inheritable=os.get_inheritable(descriptor))
    os.close(nowhere)


def print_error(text: str) -> None:
    """Prints what went wrong; where nobody can read it, the exit code alone says so.

    Args:
        text: one line or several, without control characters.
    """
    _print(text, sys.stderr)


def print_answer(text: str) -> None:
    """Prints what was done, at once; where nobody can read it, it is done all the same.

    Args:
        text: the same.
    """
    _print(text, sys.stdout)


def _print(text: str, stream: TextIO) -> None:
    try:
        print(text, file=stream, flush=True)
    except OSError:
        silence(stream)

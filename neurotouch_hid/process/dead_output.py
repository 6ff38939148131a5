"""What remains to be done with an output that nobody can read any more."""

import os
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

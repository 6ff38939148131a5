"""Tells by its stamp whether a file has changed."""

from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

Stamp = tuple[int, int, int]
"""Inode, mtime in ns and size of a file: an editor that replaces files changes the inode."""


def read_stamps(paths: Iterable[Path]) -> dict[Path, Stamp]:
    """Returns the stamps of files as they are now; those that are not there have none."""
    stamps = {}
    for path in paths:
        with suppress(OSError, ValueError):
            found = path.stat()
            stamps[path] = found.st_ino, found.st_mtime_ns, found.st_size
    return stamps

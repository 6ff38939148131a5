"""Writes files so that at every moment the old or the new one is there, never a part.

Every file that a person names is written here.
"""

import errno
import os
import shlex
import stat
from contextlib import suppress
from pathlib import Path
from typing import Self


class PartialFile:
    """A new file beside ``path`` that takes its name in one step; a context manager.

    A link stays a link, and an older file's mode stays. What is no plain file, such as a device, a
    pipe or the standard output, is written as it is. The temporary name is that of the process too,
    so two writers never share it.

    Args:
        path: where the file will be.

    Attributes:
        file: takes the content, unbuffered.

    Raises:
        OSError: the file cannot be made.
    """

    def __init__(self, path: Path) -> None:
        self._part: Path | None = None
        if not is_plain(path):
            self.file = os.fdopen(_open(path, 0), "wb", buffering=0)
            return
        self._path = Path(os.path.realpath(path))  # also of a link to itself
        self._part = self._path.with_name(f".{path.name}.{os.getpid()}.partial")
        try:
            # One may be left of a process that had this number before a power cut.
            self._part.unlink(missing_ok=True)
            # Another user who may write to the folder could have put a link there.
            descriptor = _open(self._part, os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW)
        except OSError as error:
            error.filename = str(path)  # the name that the person knows
            raise
        self.file = os.fdopen(descriptor, "wb", buffering=0)

    def commit(self) -> None:
        """Gives the file its name, replacing an older one.

        Raises:
            OSError: the file system refuses; the older one is still there.
        """
        if self._part is None:
            self.file.close()
            return
        try:
            with self.file:
                os.fsync(self.file.fileno())
            if self._path.exists():
                self._part.chmod(stat.S_IMODE(self._path.stat().st_mode))
            self._part.replace(self._path)
        except OSError:
            self.discard()
            raise

    def discard(self) -> None:
        """Removes the temporary file."""
        self.file.close()
        if self._part is not None:
            self._part.unlink(missing_ok=True)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        if kind is None:
            self.commit()
        else:
            self.discard()


def write_whole(path: Path, content: bytes) -> None:
    """Writes a file; when this returns, the file survives a power cut.

    Args:
        path: where the file will be.
        content: all of it.

    Raises:
        OSError: it could not be written; the old file is still there.
    """
    with PartialFile(path) as partial:
        rest = memoryview(content)
        while rest:
            rest = rest[partial.file.write(rest) :]
    folder = os.open(Path(os.path.realpath(path)).parent, os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)


def remove_left(folder: Path) -> None:
    """Removes the temporary files of writers that were killed; those of living ones stay."""
    for part in folder.glob(".*.partial"):
        writer = part.suffixes[-2][1:] if len(part.suffixes) > 1 else ""
        if writer.isdecimal() and not Path("/proc", writer).exists():
            with suppress(OSError):
                part.unlink()


def suggest_fix(error: OSError) -> str:
    """Returns what to do where a file could not be written."""
    match error.errno:
        case errno.ENOSPC | errno.EDQUOT:
            return "Make room on this disk, then try again."
        case errno.EROFS:
            return "This disk is read-only, often after an error. Restart the machine."
        case errno.EACCES | errno.EPERM:
            return explain_missing_right(error, "write there")
        case _ if not isinstance(error.filename, str):  # while it was written
            return "Choose another disk: this one cannot take it."
        case errno.ENOENT if not Path(error.filename).parent.is_dir():
            return "Make the folder, or choose another."
        case _:
            return f"See what each part of its path is: {_show_path(error)}"


def explain_missing_right(error: OSError, to: str) -> str:
    """Returns what to do where a right is missing.

    Args:
        error: what the system said.
        to: what the right is for: ``read it`` or ``write there``.
    """
    return f"Get the right to {to}. Who owns each part of its path: {_show_path(error)}"


def _show_path(error: OSError) -> str:
    """Returns the command that lists a path's folders with owner and mode."""
    path = error.filename if isinstance(error.filename, str) else "PATH"
    return f"namei -l {shlex.quote(path)}"


def try_writing(path: Path) -> None:
    """Tries before a long work whether a file can be written; leaves everything as it is.

    Raises:
        OSError: it cannot.
    """
    if is_plain(path):
        PartialFile(path).discard()
    elif not os.access(path, os.W_OK):  # opening a pipe would wait for its reader
        path.stat()
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))


def is_plain(path: Path) -> bool:
    """Returns whether a file of this name may be removed, or replaced by a new one."""
    folder = os.path.realpath(path.parent)
    if folder == "/dev" or f"{folder}/".startswith("/proc/"):  # such as /dev/stdout
        return False
    return not path.exists() or stat.S_ISREG(path.stat().st_mode)


def _open(path: Path, flags: int) -> int:
    return os.open(path, flags | os.O_WRONLY | os.O_CLOEXEC, 0o666)

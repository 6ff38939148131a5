"""The file under a recording that is being written: each piece is appended whole or not at all."""

import errno
import fcntl
import os
import shutil
from contextlib import suppress
from pathlib import Path
from typing import IO

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.partial_file import PartialFile, is_plain

MIN_FREE_BYTES = 64 << 20
"""Space that a recording leaves free on the disk, for other programs."""


class FileOutput:
    """Appends to a new file.

    Either the file takes its name only when it is complete, or it is written ``in_place``: it has
    its name from the start.

    Args:
        path: the future path; an existing file is replaced.
        in_place: write under the name itself, from the start.
        min_free_bytes: how much of the disk to leave free.

    Attributes:
        path: the future path.
        in_place: it has its name from the start.
        size_bytes: its present size.
        is_closed: nothing more can be written.

    Raises:
        RecordingError: the file cannot be made.
    """

    def __init__(self, path: Path, *, in_place: bool, min_free_bytes: int) -> None:
        self.path, self.in_place = path, in_place
        self.size_bytes = 0
        self.is_closed = False
        self._min_free_bytes = min_free_bytes
        try:
            self._partial = None if in_place else PartialFile(path)
            self._file = self._partial.file if self._partial else _open_in_place(path)
        except OSError as error:
            raise self._failure(error) from error

    def append(self, data: bytes) -> None:
        """Appends all of it or nothing.

        Raises:
            RecordingError: the disk is full or gone.
        """
        try:
            self._check_space()
            self._append(data)
        except OSError as error:
            raise self._failure(error) from error

    def append_last(self, data: bytes) -> bool:
        """Appends what readers can do without; returns False if there was no room."""
        try:
            self._append(data)
        except OSError:
            return False
        return True

    def patch(self, position: int, data: bytes) -> None:
        """Replaces bytes that readers can do without, such as the length of the file."""
        with suppress(OSError):
            os.pwrite(self._file.fileno(), data, position)

    def close(self) -> None:
        """Finishes the file and moves it into place; a second call does nothing."""
        if self.is_closed:
            return
        self.is_closed = True
        if self._partial is None:
            self._file.close()
            return
        try:
            self._partial.commit()
        except OSError as error:
            raise self._failure(error) from error

    def discard(self) -> None:
        """Removes everything that was written."""
        if self.is_closed:
            return
        self.is_closed = True
        self._file.close()
        if self._partial is not None:
            self._partial.discard()
        elif is_plain(self.path):
            self.path.unlink(missing_ok=True)

    def _append(self, data: bytes) -> None:
        try:
            written = 0
            while written < len(data):
                written += os.write(self._file.fileno(), memoryview(data)[written:])
        except OSError:
            self._file.truncate(self.size_bytes)
            self._file.seek(self.size_bytes)
            raise
        self.size_bytes += len(data)

    def _check_space(self) -> None:
        if shutil.disk_usage(self.path.parent).free < self._min_free_bytes:
            raise RecordingError(
                f"'{self.path}' cannot be written: the disk is full.",
                hint=f"Make room: {self._min_free_bytes >> 20} MB have to stay free.",
            )

    def _failure(self, error: OSError) -> RecordingError:
        if error.errno == errno.ELOOP:
            return RecordingError(
                f"'{self.path}' is a link, and a recording is not written through a link.",
                hint="Give the name of the file itself.",
            )
        if isinstance(error, BlockingIOError):
            return RecordingError(
                f"Another program is recording to '{self.path}'.", hint="Give another name."
            )
        return RecordingError.of_writing(self.path, error)


def _open_in_place(path: Path) -> IO[bytes]:
    """Opens a file to be written under its own name.

    Another user who may write to the folder could have put a link there, to a file of this person.
    The file is locked, so that two recordings are not mixed in it.
    """
    flags = os.O_WRONLY | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC
    file = os.fdopen(os.open(path, flags, 0o666), "wb", buffering=0)
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        file.close()
        raise
    except OSError:  # this file system knows no locks
        pass
    if is_plain(path):
        file.truncate(0)
    return file

"""The outside of a recording: a regular file with a header, and packets one after the other.

A packet is its stream's number and its size, both int32, and so many bytes. Everything is compared
with the length of the file before any memory is taken.
"""

import difflib
import os
import struct
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Final

from neurotouch_hid.closing import Closing
from neurotouch_hid.errors import RecordingError
from neurotouch_hid.files.small_file import open_regular, suggest_reading
from neurotouch_hid.recording.compression import MAX_BYTES, TooLargeError, decompress
from neurotouch_hid.recording.header import MAX_HEADER_BYTES, parse_header
from neurotouch_hid.vocabulary import RECORDING_ENDINGS

_PACKET_HEAD: Final = struct.Struct("<ii")


class DamageError(Exception):
    """The file cannot be read from a place on.

    Attributes:
        position: the place, in bytes.
        what: what is wrong, as a sentence about the file goes on: ``is cut off``.
    """

    def __init__(self, position: int, what: str = "is damaged") -> None:
        super().__init__(what)
        self.position = position
        self.what = what


class Container(Closing):
    """An open recording; several walks can read it side by side.

    Args:
        path: the file.

    Attributes:
        header: its header.

    Raises:
        RecordingError: the file is missing, not a file, of another format or damaged.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._descriptor = open_recording(path)
        try:
            self._size = os.fstat(self._descriptor).st_size
            self.header = parse_header(path, self._read(0, MAX_HEADER_BYTES))
        except BaseException:
            os.close(self._descriptor)
            raise

    def walk(self, stream: int | None) -> Iterator[tuple[int, bytes | memoryview]]:
        """Gives the packets of a stream in the order of the file, with the place of each.

        Args:
            stream: its number; None gives none.

        Raises:
            DamageError: the file breaks off, or a packet cannot be unpacked.
        """
        position, table = self.header.begin, self.header.table
        end = self._size if table < 0 else min(table, self._size)
        what = "is damaged" if 0 <= table <= self._size else "is cut off"
        while stream is not None and position + _PACKET_HEAD.size <= end:
            head = self._read(position, _PACKET_HEAD.size)
            if len(head) < _PACKET_HEAD.size:
                break  # a program has made the file shorter
            number, size = _PACKET_HEAD.unpack(head)
            begin = position + _PACKET_HEAD.size
            if size <= 0 or number not in self.header.streams:
                raise DamageError(position)
            if begin + size > end:
                raise DamageError(position, what)
            if number == stream:
                yield position, self._unpack(position, begin, size)
            position = begin + size
        if stream is not None and (position != end or table > self._size):
            raise DamageError(position, what)

    def close(self) -> None:
        """Closes the file."""
        os.close(self._descriptor)

    def _unpack(self, position: int, begin: int, size: int) -> bytes | memoryview:
        # Nothing grows by being compressed, but for a few bytes for each block.
        try:
            if size > MAX_BYTES + (MAX_BYTES >> 8):
                raise TooLargeError(size)
            return decompress(self._read(begin, size), self.header.compression)
        except TooLargeError as error:
            what = f"has a packet of {error.size >> 20} MB, more than any camera gives,"
            raise DamageError(position, what) from error
        except ValueError as error:
            raise DamageError(position) from error

    def _read(self, position: int, n: int) -> bytes:
        try:
            return os.pread(self._descriptor, n, position)
        except OSError as error:
            raise self._refuse(error) from error

    def _refuse(self, error: OSError) -> RecordingError:
        return refuse_reading(self._path, error)


def open_recording(path: Path) -> int:
    """Returns a descriptor of a recording's file; the caller closes it.

    Raises:
        RecordingError: the file is missing, a folder, or no plain file.
    """
    if path.is_dir():
        raise RecordingError(
            f"'{path}' is a folder.", hint=f"Give a recording in it: {path}/NAME.aedat4"
        )
    try:
        return open_regular(path)
    except FileNotFoundError as error:
        raise RecordingError(f"There is no file '{path}'.", hint=_name_near(path)) from error
    except OSError as error:
        raise refuse_reading(path, error) from error


def refuse_reading(path: Path, error: OSError) -> RecordingError:
    """Returns the error about a file that is there and cannot be read."""
    reason = f"'{path}' cannot be read: {error.strerror}."
    return RecordingError(reason, hint=suggest_reading(error))


def _name_near(path: Path) -> str:
    """Returns a hint with a recording of nearly the same name, or what else can be done."""
    with suppress(OSError):
        files = [file for file in path.parent.iterdir() if file.name.endswith(RECORDING_ENDINGS)]
        files.sort(key=lambda file: file.suffix == path.suffix)  # the same ending counts last
        names = {file.stem: file.name for file in files}  # endings would make all names alike
        near = difflib.get_close_matches(path.stem, names, 1)
        if near:
            return f"Did you mean {path.with_name(names[near[0]])}?"
    return "Check the name. To record one: neurotouch record NAME.aedat4"

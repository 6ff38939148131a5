"""Writes events and frames to one AEDAT4 file that is readable at every moment."""

import errno
import os
import shutil
from array import array
from pathlib import Path
from types import TracebackType
from typing import IO, Self

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.messages import EventPacket, Frame
from neurotouch_hid.partial_file import PartialFile, is_plain
from neurotouch_hid.recording.packing import (
    EVENTS,
    FRAMES,
    TABLE_POSITION_AT,
    pack_events,
    pack_frame,
    pack_header,
    pack_table,
)
from neurotouch_hid.recording.simulation import Simulation

MIN_FREE_BYTES = 64 << 20
"""Space that a recording leaves free on the disk, for other programs."""

_COLUMNS = 6  # of the table


class RecordingWriter:
    """Writes packets to an AEDAT4 file with the streams ``events`` and ``frames``.

    Each packet is written immediately and completely. Whatever ends the writing, the file can be
    read up to there; a failed write is undone.

    Either the file takes its name only when it is complete (a recording that exists is complete,
    and an exception in the ``with`` block removes what was written), or it is written
    ``in_place``: it has its name from the start, and an exception leaves the part written so far.

    Args:
        path: the future path of the recording; an existing one is replaced.
        in_place: write under the name itself, from the start.
        simulation: where simulated data come from; None for a sensor's data.
        min_free_bytes: how much of the disk to leave free.

    Attributes:
        path: the future path of the recording.
        size_bytes: its present size.

    Raises:
        RecordingError: the file cannot be made.
    """

    def __init__(
        self,
        path: Path | str,
        *,
        in_place: bool = False,
        simulation: Simulation | None = None,
        min_free_bytes: int = MIN_FREE_BYTES,
    ) -> None:
        self.path = Path(path)
        self.size_bytes = 0
        self._min_free_bytes = min_free_bytes
        self._table = array("q")
        self._last_us = 0  # the format's readers take no events before the origin
        self._frame_us = 0
        self._closed = False
        try:
            self._partial = None if in_place else PartialFile(self.path)
            self._file = self._partial.file if self._partial else _open_in_place(self.path)
        except OSError as error:
            raise self._failure(error) from error
        try:
            self._check_space()
            self._append(pack_header(simulation))
        except OSError as error:
            self.discard()
            raise self._failure(error) from error
        except RecordingError:
            self.discard()
            raise

    def write(self, packet: EventPacket) -> None:
        """Appends a packet; packets come in order of time.

        Raises:
            RecordingError: the events are older than those already written, or the disk is full or
                gone.
        """
        self.write_events(packet.events)
        for frame in packet.frames:
            self.write_frame(frame)

    def write_events(self, events: NDArray[np.void]) -> None:
        """Appends events, (n,) EVENT_DTYPE, ascending in ``t`` and not older than those before."""
        if not len(events):
            return
        t = events["t"]
        if t[0] < self._last_us or (t[1:] < t[:-1]).any():
            raise self._disorder("events")
        self._add(EVENTS, pack_events(events), len(events), int(t[0]), int(t[-1]))
        self._last_us = int(t[-1])

    def write_frame(self, frame: Frame) -> None:
        """Appends a frame, (260, 346) uint8, not older than the one before."""
        begin_us = frame.exposure_begin_us
        if begin_us < self._frame_us:
            raise self._disorder("frames")
        self._add(FRAMES, pack_frame(frame), 1, begin_us, begin_us)
        self._frame_us = begin_us

    def _add(self, stream: int, packet: bytes, n: int, first_us: int, last_us: int) -> None:
        """Appends a packet and notes it for the table."""
        at = self.size_bytes + 8
        try:
            self._check_space()
            self._append(packet)
        except OSError as error:
            raise self._failure(error) from error
        self._table.extend((stream, len(packet) - 8, at, n, first_us, last_us))

    def _append(self, data: bytes) -> None:
        """Appends all of it or nothing."""
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
        return RecordingError(
            f"'{self.path}' cannot be written: {error.strerror}.",
            hint="Choose a folder that exists, with room, that you may write to.",
        )

    def _disorder(self, what: str) -> RecordingError:
        return RecordingError(
            f"{self.path}: {what} must be written in order of time, from 0 µs on."
        )

    def close(self) -> None:
        """Finishes the file and moves it into place; a second call does nothing."""
        if self._closed:
            return
        self._closed = True
        self._write_table()
        if self._partial is None:
            self._file.close()
            return
        try:
            self._partial.commit()
        except OSError as error:
            raise self._failure(error) from error

    def _write_table(self) -> None:
        """Writes the table, an index; without it, readers must read the file from start to end."""
        entries = np.frombuffer(self._table, np.int64).reshape(-1, _COLUMNS)
        position = self.size_bytes
        try:
            self._append(pack_table(entries))
            os.pwrite(self._file.fileno(), position.to_bytes(8, "little"), TABLE_POSITION_AT)
        except OSError:
            pass  # no room: all packets are there

    def discard(self) -> None:
        """Removes everything that was written."""
        if self._closed:
            return
        self._closed = True
        self._file.close()
        if self._partial is not None:
            self._partial.discard()
        elif is_plain(self.path):
            self.path.unlink(missing_ok=True)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if kind is None or self._partial is None:
            self.close()
        else:
            self.discard()


def _open_in_place(path: Path) -> IO[bytes]:
    """Opens a file to be written under its own name.

    Another user who may write to the folder could have put a link there, to a file of this person.
    """
    flags = os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_NOFOLLOW | os.O_CLOEXEC
    return os.fdopen(os.open(path, flags, 0o666), "wb", buffering=0)

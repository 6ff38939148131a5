"""Writes events and frames to one AEDAT4 file that is readable at every moment."""

from array import array
from pathlib import Path
from typing import Self

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.messages import EventPacket, Frame
from neurotouch_hid.recording.clip import Picture
from neurotouch_hid.recording.file_output import MIN_FREE_BYTES, FileOutput
from neurotouch_hid.recording.packing import (
    EVENTS,
    FRAMES,
    TABLE_POSITION_AT,
    pack_events,
    pack_frame,
    pack_header,
    pack_table,
)
from neurotouch_hid.recording.sensor import DAVIS346, Sensor
from neurotouch_hid.recording.simulation import Simulation

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
        sensor: the sensor whose pixels the events name; only a DAVIS-346 has frames.
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
        sensor: Sensor = DAVIS346,
        min_free_bytes: int = MIN_FREE_BYTES,
    ) -> None:
        self.path = Path(path)
        self._output = FileOutput(self.path, in_place=in_place, min_free_bytes=min_free_bytes)
        self._table = array("q")
        self._last_us = 0  # the format's readers take no events before the origin
        self._frame_us = 0
        try:
            self._output.append(pack_header(simulation, sensor))
        except RecordingError:
            self.discard()
            raise

    @property
    def size_bytes(self) -> int:
        """The file's present size."""
        return self._output.size_bytes

    def write(self, item: EventPacket | Picture) -> None:
        """Appends a packet; packets come in order of time.

        Raises:
            RecordingError: the events are older than those already written, it is a picture of
                another sensor, or the disk is full or gone.
        """
        if isinstance(item, Picture):
            raise RecordingError(
                f"'{self.path}' cannot keep the pictures of a video.",
                hint="Give a name that ends in .mkv.",
            )
        self.write_events(item.events)
        for frame in item.frames:
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
        self._output.append(packet)
        self._table.extend((stream, len(packet) - 8, at, n, first_us, last_us))

    def _disorder(self, what: str) -> RecordingError:
        return RecordingError(
            f"{self.path}: {what} must be written in order of time, from 0 µs on."
        )

    def close(self) -> None:
        """Finishes the file and moves it into place; a second call does nothing."""
        if not self._output.is_closed:
            self._write_table()
            self._output.close()

    def _write_table(self) -> None:
        """Writes the table, an index; without it, readers must read the file from start to end."""
        entries = np.frombuffer(self._table, np.int64).reshape(-1, _COLUMNS)
        position = self.size_bytes
        if self._output.append_last(pack_table(entries)):
            self._output.patch(TABLE_POSITION_AT, position.to_bytes(8, "little"))

    def discard(self) -> None:
        """Removes everything that was written."""
        self._output.discard()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        if kind is None or self._output.in_place:
            self.close()
        else:
            self.discard()

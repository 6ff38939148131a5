"""Recordings out: events and frames to one AEDAT4 file that appears only when it is complete."""

import shutil
from collections import deque
from itertools import starmap
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import dv_processing as dv
import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX, EventPacket, Frame
from neurotouch_hid.recording.partial import PartialFile

CAMERA_NAME = "DAVIS346"
MIN_FREE_BYTES = 64 << 20
"""Space that is left on the disk. The library writes from a thread of its own and aborts the whole
process when the disk is full, so we stop before; what it still has queued is far less than this."""


class RecordingWriter:
    """Writes packets to an AEDAT4 file with the streams ``events`` and ``frames``.

    The file is written under a temporary name beside its place and renamed by ``close()``, so a
    recording that exists is complete. Leaving the ``with`` block by an exception (Ctrl-C too)
    removes what was written.

    Args:
        path: where the recording will be; an existing one is replaced at the end.
        min_free_bytes: how much of the disk to leave free.

    Raises:
        RecordingError: the file cannot be made.
    """

    def __init__(self, path: Path | str, *, min_free_bytes: int = MIN_FREE_BYTES) -> None:
        self._min_free_bytes = min_free_bytes
        self._file = PartialFile(Path(path))
        config = dv.io.MonoCameraWriter.Config(CAMERA_NAME)
        config.addEventStream((SENSOR_WIDTH_PX, SENSOR_HEIGHT_PX))
        config.addFrameStream((SENSOR_WIDTH_PX, SENSOR_HEIGHT_PX))
        self._writer: Any = dv.io.MonoCameraWriter(str(self._file.partial), config)
        self._last_us = 0  # the library takes no events before the origin
        self._frame_us = 0

    def write(self, packet: EventPacket) -> None:
        """Append a packet; packets come in order of time.

        Raises:
            RecordingError: the events are older than those already written, or the disk is full.
        """
        self.write_events(packet.events)
        for frame in packet.frames:
            self.write_frame(frame)

    def write_events(self, events: NDArray[np.void]) -> None:
        """Append events, (n,) EVENT_DTYPE, ascending in ``t`` and not older than those before."""
        if not len(events):
            return
        self._check_space()
        t = events["t"]
        if t[0] < self._last_us or (t[1:] < t[:-1]).any():
            raise self._disorder("events")
        self._last_us = int(t[-1])
        store = dv.EventStore()
        # The library builds a store from Python only event by event; starmap is its fastest loop.
        deque(starmap(store.push_back, events.tolist()), maxlen=0)
        self._writer.writeEvents(store)

    def write_frame(self, frame: Frame) -> None:
        """Append a frame, (260, 346) uint8, not older than the one before."""
        self._check_space()
        if frame.exposure_begin_us < self._frame_us:
            raise self._disorder("frames")
        self._frame_us = frame.exposure_begin_us
        exposure_us = frame.exposure_end_us - frame.exposure_begin_us
        self._writer.writeFrame(
            dv.Frame(
                frame.exposure_begin_us,
                exposure_us,
                0,
                0,
                np.ascontiguousarray(frame.pixels),
                dv.FrameSource.SENSOR,
            )
        )

    def _check_space(self) -> None:
        if shutil.disk_usage(self._file.path.parent).free < self._min_free_bytes:
            raise RecordingError(
                f"{self._file.path} cannot be written: the disk is full",
                hint=f"make room: {self._min_free_bytes >> 20} MB have to stay free",
            )

    def _disorder(self, what: str) -> RecordingError:
        return RecordingError(
            f"{self._file.path}: {what} must be written in order of time, from 0 µs on"
        )

    def close(self) -> None:
        """Finish the file and put it in its place; a second call does nothing."""
        if self._writer is not None:
            self._writer = None  # the library writes its table and closes when the object dies
            self._file.commit()

    def discard(self) -> None:
        """Remove what was written; nothing stays."""
        if self._writer is not None:
            self._writer = None
            self._file.discard()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if kind is None:
            self.close()
        else:
            self.discard()

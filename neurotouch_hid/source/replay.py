"""A recording as a source, mirrored back if its rig file says that the camera saw it mirrored."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.closing import Closing
from neurotouch_hid.messages import SENSOR_WIDTH_PX, EventPacket, Frame
from neurotouch_hid.recording import Batch, Recording
from neurotouch_hid.source.rig_file import RigFile, load_rig_file, rig_path
from neurotouch_hid.source.slicer import slice_recording


class Replay(Closing):
    """Plays a recording as fast as it is asked for; each iteration starts at its beginning.

    A recording that is cut off plays up to the break, its last slice included, then raises.

    Args:
        path: the recording; ``NAME.rig.yaml`` beside it is read if there is one.
        slice_us: length of a slice.

    Attributes:
        name: ``file:`` and the path.
        rig: the rig file's override, or None.
        is_simulated: the recording is marked so.

    Raises:
        RecordingError: the recording or its rig file cannot be used.
    """

    is_live = False

    def __init__(self, path: Path | str, *, slice_us: int = 10_000) -> None:
        self.name = f"file:{path}"
        self._recording = Recording(path)
        self.is_simulated = self._recording.simulation is not None
        beside = rig_path(path)
        known = load_rig_file(beside) if beside.exists() else RigFile()
        self.rig = known.rig
        self._mirrored = known.mirrored
        self._slice_us = slice_us

    def __iter__(self) -> Iterator[EventPacket]:
        return slice_recording(self._batches(), self._slice_us)

    def close(self) -> None:
        """Does nothing: nothing stays open between two iterations."""

    def _batches(self) -> Iterator[Batch]:
        for events, frames in self._recording:
            if self._mirrored:
                yield mirror_events(events), tuple(mirror_frame(frame) for frame in frames)
            else:
                yield events, frames


def mirror_events(events: NDArray[np.void]) -> NDArray[np.void]:
    """Returns events flipped left to right, in place: (n,) EVENT_DTYPE."""
    events["x"] = SENSOR_WIDTH_PX - 1 - events["x"]
    return events


def mirror_frame(frame: Frame) -> Frame:
    """Returns a frame flipped left to right."""
    pixels = np.ascontiguousarray(frame.pixels[:, ::-1])
    return Frame(pixels, frame.exposure_begin_us, frame.exposure_end_us)

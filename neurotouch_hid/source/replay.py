"""A recording as a source, mirrored back if its rig file says that the camera saw it mirrored."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.closing import Closing
from neurotouch_hid.geometry import PAPER_GEL, Gel
from neurotouch_hid.messages import SENSOR_WIDTH_PX, EventPacket, Frame
from neurotouch_hid.recording import DAVIS346, Batch, Recording
from neurotouch_hid.source.rig_file import RigFile, load_rig_file, rig_path
from neurotouch_hid.source.sensor_map import SensorMap
from neurotouch_hid.source.slicer import slice_recording
from neurotouch_hid.source.strobe.decoder import Strobe
from neurotouch_hid.source.video.view_search import find_scale
from neurotouch_hid.source.view import View, whole_view


class Replay(Closing):
    """Plays a recording as fast as it is asked for; each iteration starts at its beginning.

    A recording that is cut off plays up to the break, its last slice included, then raises.

    One of another sensor is mapped to the canonical picture: by its rig file, or whole.

    Args:
        path: the recording; ``NAME.rig.yaml`` beside it is read if there is one.
        slice_us: length of a slice.
        gel: the gel that it shows.

    Attributes:
        name: ``file:`` and the path.
        rig: the rig file's override, or None.
        view: the map from the picture of another sensor; None for a DAVIS-346.
        is_simulated: the recording is marked so.

    Raises:
        RecordingError: the recording or its rig file cannot be used.
    """

    is_live = False

    def __init__(self, path: Path | str, *, slice_us: int = 10_000, gel: Gel = PAPER_GEL) -> None:
        self.name = f"file:{path}"
        self._recording = Recording(path)
        self.is_simulated = self._recording.simulation is not None
        beside = rig_path(path)
        size_px = self._recording.size_px
        known = load_rig_file(beside, size_px) if beside.exists() else RigFile()
        self.view = None if size_px == DAVIS346.size_px else _find_view(size_px, known, gel)
        self.rig = known.rig if self.view is None else None
        self._mirrored, self._strobe = known.mirrored, known.strobe
        self._slice_us = slice_us

    def __iter__(self) -> Iterator[EventPacket]:
        slices = slice_recording(self._batches(), self._slice_us)
        return slices if self._strobe is None else map(Strobe(self._strobe).take, slices)

    def close(self) -> None:
        """Does nothing: nothing stays open between two iterations."""

    def _batches(self) -> Iterator[Batch]:
        if self.view is not None:
            sensor_map = SensorMap(self.view)
            for events, _ in self._recording:
                for part in sensor_map.map_events(events):
                    yield part, ()
            return
        for events, frames in self._recording:
            if self._mirrored:
                yield mirror_events(events), tuple(mirror_frame(frame) for frame in frames)
            else:
                yield events, frames


def _find_view(size_px: tuple[int, int], known: RigFile, gel: Gel) -> View:
    """Returns the map from the picture of another sensor."""
    rig = known.rig
    if rig is None:
        return whole_view(*size_px, mirrored=known.mirrored)
    scale = find_scale(gel) / rig.px_per_mm
    return View(*size_px, rig.centre_px, scale, mirrored=known.mirrored)


def mirror_events(events: NDArray[np.void]) -> NDArray[np.void]:
    """Returns events flipped left to right, in place: (n,) EVENT_DTYPE."""
    events["x"] = SENSOR_WIDTH_PX - 1 - events["x"]
    return events


def mirror_frame(frame: Frame) -> Frame:
    """Returns a frame flipped left to right."""
    pixels = np.ascontiguousarray(frame.pixels[:, ::-1])
    return Frame(pixels, frame.exposure_begin_us, frame.exposure_end_us)

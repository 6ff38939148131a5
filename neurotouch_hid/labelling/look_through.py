"""Plays a recording once, and keeps what a person needs to label it."""

import tempfile
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.closing import Closing
from neurotouch_hid.driver import REFERENCE, Driver
from neurotouch_hid.errors import RecordingError
from neurotouch_hid.geometry import fit_rig
from neurotouch_hid.labelling.hindsight import apply_hindsight
from neurotouch_hid.labelling.track import Track
from neurotouch_hid.messages import (
    SENSOR_HEIGHT_PX,
    SENSOR_WIDTH_PX,
    Frame,
    Gesture,
    MarkerField,
    Step,
)
from neurotouch_hid.source import PictureSource
from neurotouch_hid.source.view import View

WITHOUT_FRAME_US: Final = 60_000
"""Where no frame comes for this time, there is a moment without one: a DAVIS makes 25 a second."""
_MOST_MOMENTS: Final = 90_000
"""An hour at 25 pictures a second, with 177 dots some 300 MB."""
_KEPT_GESTURES: Final = 64
_QUALITY: Final = 90


class Pictures(Closing):
    """Frames as JPEG, in a file without a name; a context manager."""

    def __init__(self) -> None:
        self._file = tempfile.TemporaryFile()  # noqa: SIM115  # open as long as this object
        self._places: list[tuple[int, int]] = []

    def add(self, pixels: NDArray[np.uint8]) -> None:
        """Appends a picture.

        Raises:
            RecordingError: there is no room for it.
        """
        content = cv2.imencode(".jpg", pixels, [cv2.IMWRITE_JPEG_QUALITY, _QUALITY])[1].tobytes()
        begin = self._file.tell()
        try:
            self._file.write(content)
        except OSError as error:
            raise RecordingError(
                f"The pictures do not fit into {tempfile.gettempdir()}: {error.strerror}.",
                hint="Free some space there, or name another folder in TMPDIR.",
            ) from error
        self._places.append((begin, len(content)))

    def __len__(self) -> int:
        return len(self._places)

    def close(self) -> None:
        """Removes the file."""
        self._file.close()

    def read(self, k: int) -> bytes:
        """Returns a picture as JPEG."""
        begin, size = self._places[k]
        self._file.seek(begin)
        content = self._file.read(size)
        self._file.seek(0, 2)
        return content


@dataclass(frozen=True, slots=True, eq=False)
class Moments:
    """A recording, as its n moments that can be labelled: its frames.

    Attributes:
        t_us: (n,) int64, the middle of each frame's exposure.
        picture: (n,) int32, the place of its picture in ``pictures``; -1 before the first.
        proposals: what the recogniser says, with hindsight.
        confidence: (n,) float32, 0..1, of the proposals.
        markers_px: (n, m, 2) float32, the tracked dots; NaN before the gel is found.
        is_seen: (n, m) bool, the dot is measured, not guessed from its neighbours.
        peak_mm: (n,) float32, displacement of the dot that is displaced most.
        peak_px: (n, 2) float32, where that dot is; before the gel is found, the picture's middle.
        px_per_mm: scale of the picture.
        pictures: the frames.
        view: map from a video's own pictures to the canonical one; None for other recordings.
        is_simulated: the recording is marked so.
    """

    t_us: NDArray[np.int64]
    picture: NDArray[np.int32]
    proposals: Track
    confidence: NDArray[np.float32]
    markers_px: NDArray[np.float32]
    is_seen: NDArray[np.bool_]
    peak_mm: NDArray[np.float32]
    peak_px: NDArray[np.float32]
    px_per_mm: float
    pictures: Pictures
    view: View | None
    is_simulated: bool

    def __len__(self) -> int:
        return len(self.t_us)


def look_through(
    recording: Path,
    pictures: Pictures,
    *,
    gel: str | None = None,
    progress: Callable[[float], None] = lambda _: None,
) -> Moments:
    """Plays a recording as fast as possible.

    Args:
        recording: an AEDAT4 recording or a video clip.
        pictures: takes its frames; empty.
        gel: name or path of the gel's file, see ``DriverOptions.gel``.
        progress: called with the seconds of the recording so far.

    Raises:
        RecordingError: it cannot be read.
        GelNotFoundError: no frame shows the gel.
    """
    with Driver(replace(REFERENCE, source=f"file:{recording}", gel=gel)) as driver:
        collector = _Collector(pictures, progress)
        driver.run([collector])
        source = driver.source
        view = source.view if isinstance(source, PictureSource) else None
        return collector.finish(recording, view, is_simulated=source.is_simulated)


class _Collector:
    """A tap that notes every moment."""

    def __init__(self, pictures: Pictures, progress: Callable[[float], None]) -> None:
        self._pictures, self._progress = pictures, progress
        self._begin_us: int | None = None
        self._gestures: deque[Gesture] = deque(maxlen=_KEPT_GESTURES)
        self._times: list[int] = []
        self._shown: list[int] = []
        self._said: list[Gesture] = []
        self._fields: list[MarkerField] = []

    def __call__(self, step: Step) -> None:
        self._gestures.append(step.gesture)
        end_us = step.packet.t_end_us
        if self._begin_us is None:
            self._begin_us = end_us
        for frame in step.packet.frames:
            self._add_frame(frame, step.markers)
        last_us = self._times[-1] if self._times else self._begin_us
        if end_us - last_us >= WITHOUT_FRAME_US:
            self._add(end_us, step.gesture, step.markers)
        self._progress((end_us - self._begin_us) / 1e6)

    def _add_frame(self, frame: Frame, markers: MarkerField) -> None:
        if self._times and frame.t_us <= self._times[-1]:
            return  # a repeated picture
        self._pictures.add(frame.pixels)
        gesture = min(self._gestures, key=lambda each: abs(each.t_us - frame.t_us))
        self._add(frame.t_us, gesture, markers)

    def _add(self, t_us: int, gesture: Gesture, markers: MarkerField) -> None:
        if len(self._times) == _MOST_MOMENTS:
            raise RecordingError(
                f"The recording has more than {_MOST_MOMENTS} pictures.",
                hint="Label a shorter one.",
            )
        self._times.append(t_us)
        self._shown.append(len(self._pictures) - 1)
        self._said.append(gesture)
        self._fields.append(markers)

    def finish(self, recording: Path, view: View | None, *, is_simulated: bool) -> Moments:
        """Returns what was collected."""
        if not self._times:
            raise RecordingError(f"'{recording}' has neither events nor pictures.")
        n = len(self._times)
        proposals = Track.of_size(n)
        for k, gesture in enumerate(self._said):
            proposals.set(k, gesture.kind, gesture.intensity_mm, gesture.contacts_px)
        rest_px = self._fields[-1].rest_px
        px_per_mm = fit_rig(rest_px, self._fields[-1].gel).px_per_mm
        peak_mm = np.zeros(n, np.float32)
        peak_px = np.tile(np.array([SENSOR_WIDTH_PX / 2, SENSOR_HEIGHT_PX / 2], np.float32), (n, 1))
        for k, field in enumerate(self._fields):
            moved = np.linalg.norm(field.position_px - field.rest_px, axis=1) * field.valid
            if np.isfinite(moved).any():
                most = int(np.nanargmax(moved))
                peak_mm[k], peak_px[k] = moved[most] / px_per_mm, field.position_px[most]
        t_us = np.array(self._times, np.int64)
        apply_hindsight(proposals, t_us, peak_mm, px_per_mm)
        return Moments(
            t_us,
            np.array(self._shown, np.int32),
            proposals,
            np.array([gesture.confidence for gesture in self._said], np.float32),
            np.array([field.position_px for field in self._fields], np.float32),
            np.array([field.valid for field in self._fields], bool),
            peak_mm,
            peak_px,
            px_per_mm,
            self._pictures,
            view,
            is_simulated,
        )

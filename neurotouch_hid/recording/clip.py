"""Video clips in: the grey pictures of a file and their stamps, one at a time.

Only a local, regular file is read, opened once, by the reader of the container that its name tells.
It has one video stream, in a codec that we know.
"""

import os
import shlex
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.printable import make_printable
from neurotouch_hid.recording.container import DamageError, open_recording, refuse_reading
from neurotouch_hid.recording.simulation import parse_comment
from neurotouch_hid.recording.video import CODECS, Track, Video, decode, open_video

LEAST_PX: Final = 120
MOST_PX: Final = 2560
"""Limits of the sides of a picture."""
SHORTEST_US: Final = 500
"""Least time between two pictures; no camera for such a gel is faster."""
TOLERATED_STEP_BACK_US: Final = 100_000
"""A picture this much older than the one before is left out; a larger step is a clock that was
reset."""

_MAGIC: Final = {".avi": (0, b"RIFF"), ".mkv": (0, b"\x1a\x45\xdf\xa3"), ".mp4": (4, b"ftyp")}
_MAX_STAMP_US: Final = 1 << 50
"""35 years."""


@dataclass(frozen=True, slots=True, eq=False)
class Picture:
    """One picture of a sensor of any size.

    Attributes:
        pixels: (h, w) uint8, the luma.
        exposure_begin_us: start of the exposure.
        exposure_end_us: end of the exposure; equal to the start where it is unknown.
        jpeg: the picture as the camera sent it, if that was a JPEG.
    """

    pixels: NDArray[np.uint8]
    exposure_begin_us: int
    exposure_end_us: int
    jpeg: bytes | None = None


def check_clip(path: Path) -> None:
    """Checks that a file is there and begins as a clip with this ending does.

    Raises:
        RecordingError: the file is missing, a folder, empty or of another format.
    """
    descriptor = open_recording(path)
    try:
        begin = os.pread(descriptor, 16, 0)
    finally:
        os.close(descriptor)
    ending = path.suffix.lower()
    at, magic = _MAGIC[ending]
    if begin[at : at + len(magic)] != magic:
        raise RecordingError(
            f"'{path}' is no {ending} file.",
            hint="It is damaged, or its name has the wrong ending.",
        )


class Clip:
    """A video clip; iterating reads its pictures from the start, in bounded memory.

    The first picture is at 0 µs. A clip that breaks off or is damaged yields everything up to
    there, then raises. A picture that is not later than the one before is left out.

    Args:
        path: the file.

    Attributes:
        path: the file.
        size_px: width and height of its pictures.
        simulation: where simulated data come from; None if they are not marked as simulated.
        n_left_out: pictures that the last iteration left out.

    Raises:
        RecordingError: not a readable clip with pictures of a usable size.
    """

    def __init__(self, path: Path | str) -> None:
        self.path = Path(path)
        self.n_left_out = 0
        check_clip(self.path)
        with self._open() as (video, track):
            self.size_px = track.width_px, track.height_px
            self.simulation = parse_comment(video.comment)

    def __iter__(self) -> Iterator[Picture]:
        self.n_left_out = 0
        before_us: int | None = None
        for picture in self._read():
            t_us = picture.exposure_end_us
            if before_us is not None and t_us < before_us - TOLERATED_STEP_BACK_US:
                raise RecordingError(
                    f"'{self.path}': the stamps go back from {before_us} to {t_us} µs.",
                    hint="The camera's clock was reset while recording; cut the clip there.",
                )
            if before_us is not None and t_us < before_us + SHORTEST_US:
                self.n_left_out += 1
                continue
            before_us = t_us
            yield picture
        if before_us is None:
            raise RecordingError(f"'{self.path}' has no pictures.", hint="Record it again.")

    def _read(self) -> Iterator[Picture]:
        """Gives every picture up to the end, or to where the clip breaks off."""
        last_us: int | None = None
        with self._open() as (video, _):
            try:
                first = None
                for shot in decode(video):
                    height, width = shot.pixels.shape
                    self._check_size(width, height)
                    first = shot.time_s if first is None else first
                    t_us = round((shot.time_s - first) * 1_000_000)
                    if abs(t_us) > _MAX_STAMP_US:
                        raise DamageError(0)
                    last_us = t_us if last_us is None else max(t_us, last_us)
                    yield Picture(shot.pixels, t_us, t_us, shot.jpeg)
            except DamageError as error:
                where = "before its first picture"
                if last_us is not None:
                    where = f"{last_us / 1e6:.3f} s after its first picture"
                raise RecordingError(
                    f"'{self.path}' {error} {where}.", hint="Copy it again from its origin."
                ) from error

    @contextmanager
    def _open(self) -> Iterator[tuple[Video, Track]]:
        """Gives the clip and its one track."""
        descriptor = open_recording(self.path)
        try:
            video = open_video(descriptor, self.path.suffix.lower())
            yield video, self._choose_track(video)
        except DamageError as error:
            raise RecordingError(
                f"'{self.path}' cannot be read as a clip: it {error}.",
                hint="Copy it again from its origin.",
            ) from error
        except OSError as error:
            raise refuse_reading(self.path, error) from error
        finally:
            os.close(descriptor)

    def _choose_track(self, video: Video) -> Track:
        if len(video.tracks) != 1:
            raise RecordingError(
                f"'{self.path}' has {len(video.tracks) or 'no'} video streams, not one.",
                hint="Save the one that shows the gel as a clip of its own.",
            )
        (track,) = video.tracks
        if track.codec not in CODECS:
            other = self.path.with_name(f"{self.path.stem}-mjpeg.mp4")
            names = shlex.quote(str(self.path)), shlex.quote(str(other))
            raise RecordingError(
                f"'{self.path}' is encoded by {make_printable(track.codec)}, "
                "which is not supported.",
                hint=f"Convert it: ffmpeg -i {names[0]} -an -c:v mjpeg -q:v 2 {names[1]}",
            )
        self._check_size(track.width_px, track.height_px)
        return track

    def _check_size(self, width: int, height: int) -> None:
        if not (LEAST_PX <= width <= MOST_PX and LEAST_PX <= height <= MOST_PX):
            raise RecordingError(
                f"'{self.path}' has pictures of {width}×{height} pixels; each side must have "
                f"{LEAST_PX} to {MOST_PX}.",
                hint="Record with another mode of the camera.",
            )

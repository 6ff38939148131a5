"""Video clips in: the grey pictures of a file and their stamps, one at a time.

Only a local, regular file is read, with the reader of the container that its name tells. It may
refer to no other file, and only its one video stream is decoded, by one of five codecs.
"""

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, Final, NoReturn

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.recording.container import open_recording
from neurotouch_hid.recording.simulation import Simulation, parse_comment
from neurotouch_hid.vocabulary import CLIP_ENDINGS

if TYPE_CHECKING:
    from av.container import InputContainer
    from av.video.frame import VideoFrame
    from av.video.stream import VideoStream

LEAST_PX: Final = 120
MOST_PX: Final = 2560
"""Limits of the sides of a picture."""
SHORTEST_US: Final = 500
"""Least time between two pictures; no camera for such a gel is faster."""
TOLERATED_STEP_BACK_US: Final = 100_000
"""A picture this much older than the one before is left out; a larger step is a clock that was
reset."""

_CONTAINERS: Final = dict(zip(CLIP_ENDINGS, ("avi", "matroska", "mov"), strict=True))
_MAGIC: Final = {".avi": (0, b"RIFF"), ".mkv": (0, b"\x1a\x45\xdf\xa3"), ".mp4": (4, b"ftyp")}
_CODECS: Final = ("mjpeg", "rawvideo", "ffv1", "h264", "mpeg4")
_LIMITS: Final = {
    "codec_whitelist": ",".join(_CODECS),
    "protocol_whitelist": "none",
    "max_streams": "8",
    "probesize": str(8 << 20),
}
_MAX_PACKET_BYTES: Final = 32 << 20
"""A raw picture of the largest size has 12 MB."""
_MAX_STAMP_US: Final = 1 << 50
"""35 years."""
_PLANAR: Final = ("gray", "yuv", "nv")
"""Beginnings of pixel formats whose first plane is the luma."""
_PACKED: Final = {"yuyv422": 0, "yvyu422": 0, "uyvy422": 1}
"""First byte of the luma in formats of two bytes a pixel."""


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
        with self._open() as file, _Reading(self.path, file) as reading:
            self.size_px = reading.size_px
            self.simulation = reading.find_simulation()

    def __iter__(self) -> Iterator[Picture]:
        self.n_left_out = 0
        with self._open() as file, _Reading(self.path, file) as reading:
            before_us: int | None = None
            for pixels, t_us, jpeg in reading.pictures():
                if before_us is not None and t_us < before_us - TOLERATED_STEP_BACK_US:
                    raise RecordingError(
                        f"'{self.path}': the stamps go back from {before_us} to {t_us} µs.",
                        hint="The camera's clock was reset while recording; cut the clip there.",
                    )
                if before_us is not None and t_us < before_us + SHORTEST_US:
                    self.n_left_out += 1
                    continue
                before_us = t_us
                yield Picture(pixels, t_us, t_us, jpeg)
            if before_us is None:
                raise RecordingError(f"'{self.path}' has no pictures.", hint="Record it again.")

    def _open(self) -> IO[bytes]:
        return os.fdopen(open_recording(self.path), "rb")


class _Reading:
    """One reading of a clip by FFmpeg's libraries."""

    def __init__(self, path: Path, file: IO[bytes]) -> None:
        import av  # noqa: PLC0415  # large, and of use for clips only

        self._path, self._first, self._last_us, self._n = path, Fraction(0), 0, 0
        self._errors = (av.FFmpegError, ValueError, OverflowError, MemoryError, OSError)
        try:
            self._container: InputContainer = av.open(
                file,
                "r",
                format=_CONTAINERS[path.suffix.lower()],
                io_open=_refuse_other_files,
                container_options=_LIMITS,
                metadata_errors="replace",
            )
        except self._errors as error:
            raise RecordingError(
                f"'{path}' cannot be read as a clip: it is cut off or damaged.",
                hint="Copy it again from its origin.",
            ) from error
        try:
            self._stream = self._choose_stream()
            self.size_px = self._check_size(self._stream.width, self._stream.height)
        except BaseException:
            self._container.close()
            raise

    def __enter__(self) -> "_Reading":
        return self

    def __exit__(self, *_: object) -> None:
        self._container.close()

    def find_simulation(self) -> Simulation | None:
        """Returns the mark of simulated data in the clip's comment."""
        tags: Mapping[str, str] = self._container.metadata
        return parse_comment(tags.get("comment") or tags.get("COMMENT") or "")

    def pictures(self) -> Iterator[tuple[NDArray[np.uint8], int, bytes | None]]:
        """Gives each picture: luma, µs since the first picture, and its JPEG if it is one."""
        is_jpeg = self._stream.codec_context.name == "mjpeg"
        packets = self._container.demux(self._stream)
        while True:
            try:
                packet = next(packets, None)
                if packet is None:
                    break
                if packet.size > _MAX_PACKET_BYTES:
                    raise ValueError("a packet larger than any picture")
                if packet.is_corrupt:
                    raise ValueError("a packet that is cut off")
                jpeg = bytes(packet) if is_jpeg and packet.size else None
                decoded = [(self._take_luma(f), self._stamp(f)) for f in packet.decode()]
            except self._errors as error:
                raise self._damage("is damaged") from error
            for pixels, t_us in decoded:
                self._n += 1
                self._last_us = max(self._last_us, t_us)
                yield pixels, t_us, jpeg
        if self._is_short():
            raise self._damage("is cut off")

    def _choose_stream(self) -> "VideoStream":
        streams = self._container.streams.video
        if len(streams) != 1:
            raise RecordingError(
                f"'{self._path}' has {len(streams) or 'no'} video streams, not one.",
                hint="Save the one that shows the gel as a clip of its own.",
            )
        stream = streams[0]
        context = stream.codec_context
        name = "an unknown codec" if context is None else context.name
        if name not in _CODECS:
            raise RecordingError(
                f"'{self._path}' is encoded by {name}, which is not supported.",
                hint="Supported are MJPEG, raw video, FFV1, H.264 and MPEG-4. Convert it: "
                "ffmpeg -i OLD -c:v ffv1 NEW.mkv",
            )
        context.thread_count = 1
        context.options = {"max_pixels": str(MOST_PX**2)}
        return stream

    def _check_size(self, width: int, height: int) -> tuple[int, int]:
        if not (LEAST_PX <= width <= MOST_PX and LEAST_PX <= height <= MOST_PX):
            raise RecordingError(
                f"'{self._path}' has pictures of {width}×{height} pixels; each side must have "
                f"{LEAST_PX} to {MOST_PX}.",
                hint="Record with another mode of the camera.",
            )
        return width, height

    def _take_luma(self, frame: "VideoFrame") -> NDArray[np.uint8]:
        """Returns the grey picture of a frame, (h, w) uint8; a view of its memory where it can."""
        self._check_size(frame.width, frame.height)
        name, step, first = frame.format.name, 1, 0
        if name in _PACKED:
            step, first = 2, _PACKED[name]
        elif not name.startswith(_PLANAR) or frame.format.components[0].bits != 8:
            frame = frame.reformat(format="gray")
        plane: Any = frame.planes[0]
        rows = np.frombuffer(plane, np.uint8).reshape(-1, abs(plane.line_size))
        luma = rows[: frame.height, first : first + frame.width * step : step]
        return luma[::-1] if plane.line_size < 0 else luma

    def _stamp(self, frame: "VideoFrame") -> int:
        """Returns the time of a picture since the first one, µs."""
        at = frame.pts if frame.pts is not None else frame.dts
        if at is None or frame.time_base is None:
            raise ValueError("a picture without a stamp")
        time = at * Fraction(frame.time_base)
        if not self._n:
            self._first = time
        t_us = round((time - self._first) * 1_000_000)
        if abs(t_us) > _MAX_STAMP_US:
            raise ValueError("an impossible stamp")
        return t_us

    def _is_short(self) -> bool:
        """Returns whether the clip's own header tells of much more."""
        stream, n = self._stream, self._n
        if stream.frames > n:
            return True
        length = self._container.duration  # µs, of its longest stream
        if not n or length is None or len(self._container.streams) != 1:
            return False
        return length - self._last_us > 50_000 + 2 * self._last_us / n

    def _damage(self, what: str) -> RecordingError:
        where = f"{self._last_us / 1e6:.3f} s after its first picture"
        return RecordingError(
            f"'{self._path}' {what} {where if self._n else 'before its first picture'}.",
            hint="Copy it again from its origin.",
        )


def _refuse_other_files(url: str, *_: object) -> NoReturn:
    """Refuses what a clip refers to: other files, addresses, devices."""
    raise PermissionError(f"a clip may not open {url}")

"""Video clips out: a Matroska file, written so that it is readable up to the last picture.

Every picture has its stamp in µs; FFmpeg's own writer of this format rounds to milliseconds. A
picture that came as a JPEG is written as it came, any other one as FFV1, without loss.
"""

import struct
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from neurotouch_hid import __version__
from neurotouch_hid.closing import Closing
from neurotouch_hid.errors import RecordingError
from neurotouch_hid.messages import EventPacket
from neurotouch_hid.recording.clip import Picture
from neurotouch_hid.recording.file_output import MIN_FREE_BYTES, FileOutput
from neurotouch_hid.recording.simulation import Simulation, format_comment

if TYPE_CHECKING:
    from av.video.codeccontext import VideoCodecContext

# Names of the elements as the Matroska specification (RFC 9559) has them.
_EBML, _SEGMENT, _INFO, _TRACKS = 0x1A45DFA3, 0x18538067, 0x1549A966, 0x1654AE6B
_CLUSTER, _TAGS = 0x1F43B675, 0x1254C367
_TIMESTAMP_SCALE, _DURATION, _MUXING_APP, _WRITING_APP = 0x2AD7B1, 0x4489, 0x4D80, 0x5741
_TRACK_ENTRY, _TRACK_NUMBER, _TRACK_UID, _TRACK_TYPE = 0xAE, 0xD7, 0x73C5, 0x83
_FLAG_LACING, _CODEC_ID, _CODEC_PRIVATE, _VIDEO = 0x9C, 0x86, 0x63A2, 0xE0
_PIXEL_WIDTH, _PIXEL_HEIGHT = 0xB0, 0xBA
_TAG, _TARGETS, _SIMPLE_TAG, _TAG_NAME, _TAG_STRING = 0x7373, 0x63C0, 0x67C8, 0x45A3, 0x4487
_TIMESTAMP, _SIMPLE_BLOCK = 0xE7, 0xA3
_UNKNOWN_SIZE: Final = b"\x01" + 7 * b"\xff"
_BLOCK_HEAD: Final = b"\x81" + struct.pack(">h", 0) + b"\x80"  # track 1, a key frame


class ClipWriter(Closing):
    """Writes pictures to a Matroska file; a context manager.

    Args:
        path: the file; an existing one is replaced.
        simulation: where simulated data come from; None for a sensor's data.
        min_free_bytes: how much of the disk to leave free.

    Attributes:
        size_bytes: the file's present size.

    Raises:
        RecordingError: the file cannot be made.
    """

    def __init__(
        self,
        path: Path | str,
        *,
        simulation: Simulation | None = None,
        min_free_bytes: int = MIN_FREE_BYTES,
    ) -> None:
        self._output = FileOutput(Path(path), in_place=True, min_free_bytes=min_free_bytes)
        self._simulation = simulation
        self._is_jpeg, self._size_px = False, (0, 0)
        self._encoder: VideoCodecContext | None = None
        self._first_us: int | None = None
        self._last_us = 0
        self._duration_at = self._segment_at = 0

    @property
    def size_bytes(self) -> int:
        """The file's present size."""
        return self._output.size_bytes

    def write(self, item: EventPacket | Picture) -> None:
        """Appends a picture, or the frames of a packet; in order of time.

        Raises:
            RecordingError: a packet has events, the pictures change their size or kind, they are
                not in order of time, or the disk is full or gone.
        """
        if isinstance(item, Picture):
            self._write(item)
            return
        if len(item.events):
            raise RecordingError(
                f"'{self._output.path}' cannot keep events, and this source has them.",
                hint="Give a name that ends in .aedat4.",
            )
        for frame in item.frames:
            self._write(Picture(frame.pixels, frame.exposure_begin_us, frame.exposure_end_us))

    def _write(self, picture: Picture) -> None:
        t_us = (picture.exposure_begin_us + picture.exposure_end_us) // 2
        if self._first_us is None:
            self._begin(picture)
            self._first_us = t_us
        height, width = picture.pixels.shape
        if (width, height) != self._size_px or (picture.jpeg is not None) != self._is_jpeg:
            raise RecordingError(
                f"'{self._output.path}': the pictures changed their size or format.",
                hint="Record each mode of the camera to a file of its own.",
            )
        since_us = t_us - self._first_us
        if since_us < self._last_us:
            raise RecordingError(f"{self._output.path}: pictures must be written in order of time.")
        content = picture.jpeg if picture.jpeg is not None else self._encode(picture)
        block = _pack(_SIMPLE_BLOCK, _BLOCK_HEAD + content)
        self._output.append(_pack(_CLUSTER, _pack_number(_TIMESTAMP, since_us) + block))
        self._last_us = since_us

    def _begin(self, picture: Picture) -> None:
        """Writes everything before the first picture."""
        height, width = picture.pixels.shape
        self._size_px, self._is_jpeg = (width, height), picture.jpeg is not None
        private = b"" if self._is_jpeg else self._open_encoder()
        head = _pack(
            _EBML,
            *(_pack_number(name, value) for name, value in _VERSIONS.items()),
            _pack(0x4282, b"matroska"),
        )
        self._segment_at = len(head) + 4
        head += _SEGMENT.to_bytes(4, "big") + _UNKNOWN_SIZE
        program = f"neurotouch-hid {__version__}".encode()
        info = [
            _pack_number(_TIMESTAMP_SCALE, 1000),
            _pack(_MUXING_APP, program),
            _pack(_WRITING_APP, program),
            _pack(_DURATION, struct.pack(">d", 0.0)),
        ]
        head += _pack(_INFO, *info)
        self._duration_at = len(head) - 8
        video = _pack_number(_PIXEL_WIDTH, width) + _pack_number(_PIXEL_HEIGHT, height)
        track = [
            _pack_number(_TRACK_NUMBER, 1),
            _pack_number(_TRACK_UID, 1),
            _pack_number(_TRACK_TYPE, 1),
            _pack_number(_FLAG_LACING, 0),
            _pack(_CODEC_ID, b"V_MJPEG" if self._is_jpeg else b"V_FFV1"),
            _pack(_VIDEO, video),
        ]
        if private:
            track.append(_pack(_CODEC_PRIVATE, private))
        head += _pack(_TRACKS, _pack(_TRACK_ENTRY, *track))
        if self._simulation is not None:
            comment = format_comment(self._simulation).encode()
            simple = _pack(_TAG_NAME, b"COMMENT") + _pack(_TAG_STRING, comment)
            head += _pack(_TAGS, _pack(_TAG, _pack(_TARGETS), _pack(_SIMPLE_TAG, simple)))
        self._output.append(head)

    def _open_encoder(self) -> bytes:
        """Opens the encoder and returns what its decoder must know."""
        from av.video.codeccontext import VideoCodecContext  # noqa: PLC0415  # large

        encoder = VideoCodecContext.create("ffv1", "w")
        assert isinstance(encoder, VideoCodecContext)  # noqa: S101 - FFV1 is a video codec
        encoder.width, encoder.height = self._size_px
        encoder.pix_fmt, encoder.time_base = "gray", Fraction(1, 1_000_000)
        encoder.options = {"level": "3", "g": "1", "slicecrc": "1", "slices": "4"}
        encoder.open()
        self._encoder = encoder
        return bytes(encoder.extradata or b"")

    def _encode(self, picture: Picture) -> bytes:
        from av.video.frame import VideoFrame  # noqa: PLC0415  # large

        assert self._encoder is not None  # noqa: S101 - opened with the first picture
        frame = VideoFrame.from_ndarray(np.ascontiguousarray(picture.pixels), format="gray")
        frame.pts, frame.time_base = picture.exposure_end_us, Fraction(1, 1_000_000)
        return b"".join(bytes(packet) for packet in self._encoder.encode(frame))

    def close(self) -> None:
        """Finishes the file; a second call does nothing."""
        if self._output.is_closed:
            return
        if self._first_us is not None:
            size = self._output.size_bytes - self._segment_at - len(_UNKNOWN_SIZE)
            self._output.patch(self._segment_at, b"\x01" + size.to_bytes(7, "big"))
            self._output.patch(self._duration_at, struct.pack(">d", float(self._last_us)))
        self._output.close()


_VERSIONS: Final = {0x4286: 1, 0x42F7: 1, 0x42F2: 4, 0x42F3: 8, 0x4287: 4, 0x4285: 2}
"""Versions and limits in the head of every file: of EBML, of its reader, and of Matroska."""


def _pack(name: int, *content: bytes) -> bytes:
    """Returns an element: its name, the size of its content, the content."""
    data = b"".join(content)
    size = (len(data) | 1 << 56).to_bytes(8, "big")
    return name.to_bytes((name.bit_length() + 7) // 8, "big") + size + data


def _pack_number(name: int, value: int) -> bytes:
    return _pack(name, value.to_bytes(max((value.bit_length() + 7) // 8, 1), "big"))

"""Video clips out: a Matroska file, written so that it is readable up to the last picture.

A picture that came as a JPEG is written as it came, any other one as a PNG, without loss.
"""

import struct
from pathlib import Path

from neurotouch_hid.closing import Closing
from neurotouch_hid.errors import RecordingError
from neurotouch_hid.messages import EventPacket
from neurotouch_hid.recording.clip import Picture
from neurotouch_hid.recording.file_output import MIN_FREE_BYTES, FileOutput
from neurotouch_hid.recording.simulation import Simulation, format_comment
from neurotouch_hid.recording.video import MatroskaHead, make_bitmap_head, make_cluster, make_head


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
        self._head: MatroskaHead | None = None
        self._first_us = self._last_us = 0

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
        if self._head is None:
            self._head = self._begin(picture)
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
        content = picture.jpeg if picture.jpeg is not None else _encode(picture)
        self._output.append(make_cluster(since_us, content))
        self._last_us = since_us

    def _begin(self, picture: Picture) -> MatroskaHead:
        """Writes everything before the first picture, and returns it."""
        height, width = picture.pixels.shape
        self._size_px, self._is_jpeg = (width, height), picture.jpeg is not None
        comment = "" if self._simulation is None else format_comment(self._simulation)
        if self._is_jpeg:
            head = make_head(b"V_MJPEG", width, height, comment=comment)
        else:  # Matroska has no name of its own for PNG
            setup = make_bitmap_head(b"MPNG", width, height)
            head = make_head(b"V_MS/VFW/FOURCC", width, height, setup, comment)
        self._output.append(head.data)
        return head

    def close(self) -> None:
        """Finishes the file; a second call does nothing."""
        if self._output.is_closed:
            return
        if self._head is not None:
            size = self._output.size_bytes - self._head.segment_at - 8
            self._output.patch(self._head.segment_at, b"\x01" + size.to_bytes(7, "big"))
            self._output.patch(self._head.duration_at, struct.pack(">d", float(self._last_us)))
        self._output.close()


def _encode(picture: Picture) -> bytes:
    """Returns a PNG: each value as the difference to the mean of its neighbours, Huffman-coded.

    The noise of a camera repeats nothing, so that to look for repetitions costs time only.
    """
    import cv2  # noqa: PLC0415  # 0.1 s, which a clip of JPEG pictures does not need

    options = [cv2.IMWRITE_PNG_FILTER, cv2.IMWRITE_PNG_FILTER_AVG]
    options += [cv2.IMWRITE_PNG_STRATEGY, cv2.IMWRITE_PNG_STRATEGY_HUFFMAN_ONLY]
    return bytes(cv2.imencode(".png", picture.pixels, options)[1])

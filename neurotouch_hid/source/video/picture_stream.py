"""The pictures of a V4L2 camera: the driver's buffers, mapped; the newest picture wins."""

import ctypes
import mmap
import time
from contextlib import suppress
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.closing import Closing
from neurotouch_hid.errors import CameraError
from neurotouch_hid.source.camera_errors import CameraGoneError
from neurotouch_hid.source.video import v4l2
from neurotouch_hid.source.video.capture import MAX_IMAGE_BYTES, CaptureDevice

N_BUFFERS: Final = 4
"""One is being filled, one is being read, and two bridge a thread that wakes late."""
MAX_LOST: Final = 10_000
"""A jump of the picture number above this is a counter that started again."""
LATE_US: Final = 1_000_000
"""A picture whose stamp is older than this has no usable stamp."""
EARLY_US: Final = 100_000
"""Nor has one whose stamp lies so far in the future; a driver may calculate stamps in advance."""


@dataclass(frozen=True, slots=True, eq=False)
class CapturedPicture:
    """A picture in a buffer of the driver; valid until the next call of ``take``.

    Attributes:
        data: (n,) uint8, the bytes that the camera has written.
        t_us: the stamp, µs of CLOCK_MONOTONIC.
        is_start: the stamp is that of the start of the exposure, not that of the picture's end.
        n_lost: pictures that were lost since the one before, as far as known.
        is_damaged: the driver says that parts are missing.
        has_stamp: the driver gave a usable stamp; otherwise it is what it would be if the picture
            had taken as long to arrive as the last one with a stamp.
    """

    data: NDArray[np.uint8]
    t_us: int
    is_start: bool
    n_lost: int
    is_damaged: bool
    has_stamp: bool


class PictureStream(Closing):
    """A camera that streams, from now until ``close``.

    Args:
        device: the camera, set up.

    Raises:
        CameraBusyError: another program streams from it.
        CameraError: it refuses, or its answers make no sense.
    """

    def __init__(self, device: CaptureDevice) -> None:
        self._device = device
        self._buffers: list[mmap.mmap] = []
        self._views: list[NDArray[np.uint8]] = []
        self._taken: int | None = None
        self._last_sequence: int | None = None
        self._last_us = 0
        self._delay_us: int | None = None  # from the last usable stamp to its picture's arrival
        try:
            self._start()
        except CameraError:
            self.close()
            raise

    def take(self, timeout_s: float) -> CapturedPicture | None:
        """Returns the newest picture; gives the driver back the one returned before.

        Args:
            timeout_s: how long to wait for one.

        Returns:
            The picture, or None after the timeout.

        Raises:
            CameraGoneError: the camera is gone.
            CameraError: it has failed.
        """
        if self._taken is not None:
            index, self._taken = self._taken, None
            self._queue(index)
        if not self._device.wait(timeout_s):
            return None
        newest, n_older, n_empty = self._take_newest()
        if newest is None:
            if n_empty:
                return None
            raise CameraGoneError(
                f"The camera {self._device} reports an error instead of a picture."
            )
        self._taken = newest.index
        return self._describe(newest, n_older)

    def close(self) -> None:
        """Stops the stream and unmaps the buffers; a second call does nothing."""
        if not self._views:
            return
        self._taken = None
        off = ctypes.c_int32(v4l2.BUF_TYPE_VIDEO_CAPTURE)
        with suppress(CameraError):  # it is gone, or it has never started
            self._device.call(v4l2.STREAMOFF, off, "stopped")
        self._views.clear()
        for buffer in self._buffers:
            with suppress(BufferError):  # a picture is still in use; it is unmapped after that
                buffer.close()
        self._buffers.clear()
        none = v4l2.RequestBuffers(type=v4l2.BUF_TYPE_VIDEO_CAPTURE, memory=v4l2.MEMORY_MMAP)
        with suppress(CameraError):  # closing frees them too
            self._device.call(v4l2.REQBUFS, none, "stopped")

    def _start(self) -> None:
        """Maps the driver's buffers and starts the stream."""
        request = v4l2.RequestBuffers(
            count=N_BUFFERS, type=v4l2.BUF_TYPE_VIDEO_CAPTURE, memory=v4l2.MEMORY_MMAP
        )
        self._device.call(v4l2.REQBUFS, request, "asked for buffers")
        if not 2 <= request.count <= 32:  # V4L2's limit
            raise self._device.refuse(f"{request.count} buffers")
        for index in range(request.count):
            buffer = self._make_buffer(index)
            self._device.call(v4l2.QUERYBUF, buffer, "asked for a buffer")
            if not 0 < buffer.length <= MAX_IMAGE_BYTES:
                raise self._device.refuse(f"a buffer of {buffer.length} bytes")
            mapped = self._device.map(buffer.length, buffer.offset)
            self._buffers.append(mapped)
            self._views.append(np.frombuffer(mapped, np.uint8))
        for index in range(request.count):
            self._queue(index)
        on = ctypes.c_int32(v4l2.BUF_TYPE_VIDEO_CAPTURE)
        self._device.call(v4l2.STREAMON, on, "started")

    def _take_newest(self) -> tuple[v4l2.Buffer | None, int, int]:
        """Returns the newest picture's buffer, and how many older and how many empty ones came.

        After an error on the wire ``uvcvideo`` gives all buffers back empty, without number and
        stamp; the numbers of the next pictures tell what was lost.
        """
        newest: v4l2.Buffer | None = None
        n_older = n_empty = 0
        for _ in range(2 * len(self._views)):  # a driver that fills them faster than this lies
            buffer = self._make_buffer(0)
            if not self._device.try_call(v4l2.DQBUF, buffer, "read"):
                break
            if buffer.index >= len(self._views):
                raise self._device.refuse(f"buffer {buffer.index} of {len(self._views)}")
            if buffer.flags & v4l2.BUF_FLAG_ERROR and not buffer.bytesused:
                n_empty += 1
                self._queue(buffer.index)
                continue
            if newest is not None:
                n_older += 1
                self._queue(newest.index)
            newest = buffer
        return newest, n_older, n_empty

    def _describe(self, buffer: v4l2.Buffer, n_older: int) -> CapturedPicture:
        view = self._views[buffer.index]
        n_bytes = min(buffer.bytesused, len(view))
        stamp_us = buffer.timestamp.seconds * 1_000_000 + buffer.timestamp.microseconds
        now_us = time.monotonic_ns() // 1000
        is_monotonic = (
            buffer.flags & v4l2.BUF_FLAG_TIMESTAMP_MASK == v4l2.BUF_FLAG_TIMESTAMP_MONOTONIC
        )
        earliest_us = max(self._last_us, now_us - LATE_US)
        has_stamp = is_monotonic and earliest_us < stamp_us < now_us + EARLY_US
        if has_stamp:
            t_us, self._delay_us = stamp_us, max(0, now_us - stamp_us)
        else:  # the time of arrival alone might be later than the stamps of all later pictures
            t_us = max(now_us - (self._delay_us or 0), self._last_us + 1)
        n_lost = n_older
        if self._last_sequence is not None:
            n_missing = (buffer.sequence - self._last_sequence - 1) & 0xFFFFFFFF
            n_lost = max(n_older, n_missing if n_missing <= MAX_LOST else 0)
        self._last_sequence, self._last_us = buffer.sequence, t_us
        source = buffer.flags & v4l2.BUF_FLAG_TSTAMP_SRC_MASK
        return CapturedPicture(
            data=view[:n_bytes],
            t_us=t_us,
            is_start=self._delay_us is not None and source == v4l2.BUF_FLAG_TSTAMP_SRC_SOE,
            n_lost=n_lost,
            is_damaged=bool(buffer.flags & v4l2.BUF_FLAG_ERROR) or buffer.bytesused > len(view),
            has_stamp=has_stamp,
        )

    def _make_buffer(self, index: int) -> v4l2.Buffer:
        return v4l2.Buffer(index=index, type=v4l2.BUF_TYPE_VIDEO_CAPTURE, memory=v4l2.MEMORY_MMAP)

    def _queue(self, index: int) -> None:
        self._device.call(v4l2.QBUF, self._make_buffer(index), "given a buffer")

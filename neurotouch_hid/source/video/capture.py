"""A camera through V4L2: what it says is checked before anything relies on it."""

import ctypes
import errno
import mmap
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Final, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.closing import Closing
from neurotouch_hid.errors import CameraBusyError, CameraError
from neurotouch_hid.printable import make_printable
from neurotouch_hid.source.camera_errors import CameraGoneError
from neurotouch_hid.source.video import v4l2
from neurotouch_hid.source.video.v4l2 import Linux

N_BUFFERS: Final = 4
"""One is being filled, one is being read, and two bridge a thread that wakes late."""
MAX_FORMATS: Final = 64
MAX_SIZES: Final = 256
MAX_INTERVALS: Final = 256
MAX_SIDE_PX: Final = 8_192
MAX_IMAGE_BYTES: Final = 4 * MAX_SIDE_PX * MAX_SIDE_PX
MAX_LOST: Final = 10_000
"""A jump of the picture number above this is a counter that started again."""
LATE_US: Final = 1_000_000
"""A picture whose stamp is older than this has no usable stamp."""
EARLY_US: Final = 100_000
"""Nor has one whose stamp lies so far in the future; a driver may calculate stamps in advance."""

USUAL_SIZES: Final = ((320, 240), (640, 480), (800, 600), (1280, 720), (1280, 800), (1920, 1080))
"""The sizes that are tried of a camera that offers any size between two limits."""


_Answer = TypeVar("_Answer", bound=ctypes.Structure)


class PictureFormat(NamedTuple):
    """The format of the pictures that a camera agreed to send.

    Attributes:
        fourcc: V4L2's four letters, such as ``YUYV``.
        width: in px.
        height: in px.
        stride: bytes from one row to the next; 0 for compressed pictures.
    """

    fourcc: str
    width: int
    height: int
    stride: int


class ControlRange(NamedTuple):
    """The values that a control accepts."""

    least: int
    most: int
    step: int
    usual: int

    def clip(self, value: float) -> int:
        """Returns the nearest value that the control accepts."""
        steps = round((min(max(value, self.least), self.most) - self.least) / self.step)
        return min(self.least + steps * self.step, self.most)


@dataclass(frozen=True, slots=True, eq=False)
class Picture:
    """A picture in a buffer of the driver; valid until the next call of ``take``.

    Attributes:
        data: (n,) uint8, the bytes that the camera has written.
        t_us: the stamp, µs of CLOCK_MONOTONIC.
        is_start: the stamp is that of the start of the exposure, not that of the picture's end.
        n_lost: pictures that were lost since the one before, as far as known.
        is_damaged: the driver says that parts are missing.
        has_stamp: the driver gave a usable stamp; otherwise it is the time of the arrival.
    """

    data: NDArray[np.uint8]
    t_us: int
    is_start: bool
    n_lost: int
    is_damaged: bool
    has_stamp: bool


class CaptureDevice(Closing):
    """An open camera.

    Args:
        node: its device node, such as ``/dev/video0``.
        linux: the calls into Linux.

    Attributes:
        node: the same.
        driver: name of its driver in Linux.
        name: its name.
        bus_info: where it is plugged in, such as ``usb-0000:00:14.0-2``.
        is_camera: it captures pictures into memory that can be mapped.

    Raises:
        CameraGoneError: it is not there.
        CameraError: it cannot be opened.
    """

    def __init__(self, node: Path, linux: Linux | None = None) -> None:
        self.node = node
        self._linux = linux or Linux()
        self._buffers: list[mmap.mmap] = []
        self._views: list[NDArray[np.uint8]] = []
        self._taken: int | None = None
        self._last_sequence: int | None = None
        self._last_us = 0
        self.name = ""
        try:
            self._descriptor: int | None = self._linux.open(node)
        except OSError as error:
            raise self._explain(error, "opened") from error
        capability = v4l2.Capability()
        try:
            self._call(v4l2.QUERYCAP, capability, "asked for its name")
        except CameraError:
            self.close()
            raise
        self.driver = _read_text(capability.driver)
        self.name = _read_text(capability.card) or self.driver
        self.bus_info = _read_text(capability.bus_info)
        has_own = capability.capabilities & v4l2.CAP_DEVICE_CAPS
        able = capability.device_caps if has_own else capability.capabilities
        needed = v4l2.CAP_VIDEO_CAPTURE | v4l2.CAP_STREAMING
        self.is_camera = able & needed == needed

    def list_formats(self) -> list[str]:
        """Returns the four letters of all its formats, in its own order."""

        def ask(index: int) -> v4l2.FormatDescription:
            answer = v4l2.FormatDescription(index=index, type=v4l2.BUF_TYPE_VIDEO_CAPTURE)
            self._call(v4l2.ENUM_FMT, answer, "asked for its formats")
            return answer

        codes = [_name_fourcc(answer.pixelformat) for answer in self._ask_all(ask, MAX_FORMATS)]
        return list(dict.fromkeys(codes))

    def list_sizes(self, fourcc: str) -> list[tuple[int, int]]:
        """Returns the sizes (width, height) of a format, in px."""
        code = _read_fourcc(fourcc)

        def ask(index: int) -> v4l2.FrameSize:
            answer = v4l2.FrameSize(index=index, pixel_format=code)
            self._call(v4l2.ENUM_FRAMESIZES, answer, "asked for its sizes")
            return answer

        sizes: list[tuple[int, int]] = []
        for answer in self._ask_all(ask, MAX_SIZES):
            if answer.type == v4l2.SIZE_DISCRETE:
                sizes.append((answer.size[0], answer.size[1]))
                continue
            sizes += [size for size in USUAL_SIZES if _is_within(size, answer.size)]
            break
        return [size for size in dict.fromkeys(sizes) if max(size) <= MAX_SIDE_PX and min(size) > 0]

    def list_intervals(self, fourcc: str, width: int, height: int) -> list[Fraction]:
        """Returns the times from picture to picture, in s; empty if the camera does not say."""
        code = _read_fourcc(fourcc)

        def ask(index: int) -> v4l2.FrameInterval:
            answer = v4l2.FrameInterval(index=index, pixel_format=code, width=width, height=height)
            self._call(v4l2.ENUM_FRAMEINTERVALS, answer, "asked for its rates")
            return answer

        intervals: list[Fraction | None] = []
        for answer in self._ask_all(ask, MAX_INTERVALS):
            intervals.append(_read_interval(answer.interval[0]))
            if answer.type != v4l2.INTERVAL_DISCRETE:  # of a range, the shortest
                break
        return [interval for interval in dict.fromkeys(intervals) if interval is not None]

    def set_format(self, fourcc: str, width: int, height: int) -> PictureFormat:
        """Asks for a format; returns the one that the camera agreed to.

        Raises:
            CameraError: it refuses, or its answer makes no sense.
        """
        wanted = v4l2.Format(type=v4l2.BUF_TYPE_VIDEO_CAPTURE)
        pix = wanted.pix
        pix.width, pix.height = width, height
        pix.pixelformat, pix.field = _read_fourcc(fourcc), v4l2.FIELD_NONE
        self._call(v4l2.S_FMT, wanted, f"set to {width}x{height} {fourcc}")
        agreed = PictureFormat(
            _name_fourcc(pix.pixelformat), pix.width, pix.height, pix.bytesperline
        )
        if not (0 < agreed.width <= MAX_SIDE_PX and 0 < agreed.height <= MAX_SIDE_PX):
            raise self._refuse(f"a picture of {agreed.width}x{agreed.height} px")
        if pix.sizeimage > MAX_IMAGE_BYTES or agreed.stride > 8 * MAX_SIDE_PX:
            raise self._refuse(f"pictures of {pix.sizeimage} bytes, {agreed.stride} a row")
        return agreed

    def set_interval(self, interval: Fraction) -> Fraction | None:
        """Asks for the time from picture to picture; returns the one that the camera agreed to.

        Returns:
            The interval in s; None if the camera has no such setting.
        """
        wanted = v4l2.StreamParameters(type=v4l2.BUF_TYPE_VIDEO_CAPTURE)
        time_per_frame = wanted.capture.timeperframe
        time_per_frame.numerator = interval.numerator
        time_per_frame.denominator = interval.denominator
        try:
            self._call(v4l2.S_PARM, wanted, "set to a rate")
        except CameraGoneError:
            raise
        except CameraError:  # many an old driver has none
            return None
        return _read_interval(wanted.capture.timeperframe)

    def find_control(self, control: int) -> ControlRange | None:
        """Returns the range of a control; None if the camera does not have it."""
        answer = v4l2.QueryControl(id=control)
        try:
            self._call(v4l2.QUERYCTRL, answer, "asked for a control")
        except CameraGoneError:
            raise
        except CameraError:
            return None
        if answer.flags & (v4l2.CTRL_FLAG_DISABLED | v4l2.CTRL_FLAG_READ_ONLY):
            return None
        if answer.minimum > answer.maximum:
            return None
        step = answer.step if answer.step > 0 else 1
        return ControlRange(answer.minimum, answer.maximum, step, answer.default_value)

    def set_control(self, control: int, value: int) -> bool:
        """Sets a control; returns whether the camera took it."""
        try:
            self._call(v4l2.S_CTRL, v4l2.Control(id=control, value=value), "set")
        except CameraGoneError:
            raise
        except CameraError:
            return False
        return True

    def get_control(self, control: int) -> int | None:
        """Returns the value of a control; None if the camera does not say."""
        answer = v4l2.Control(id=control)
        try:
            self._call(v4l2.G_CTRL, answer, "asked for a control")
        except CameraGoneError:
            raise
        except CameraError:
            return None
        return int(answer.value)

    def start(self) -> None:
        """Maps the driver's buffers and starts the stream.

        Raises:
            CameraBusyError: another program streams from it.
            CameraError: it refuses, or its answers make no sense.
        """
        request = v4l2.RequestBuffers(
            count=N_BUFFERS, type=v4l2.BUF_TYPE_VIDEO_CAPTURE, memory=v4l2.MEMORY_MMAP
        )
        self._call(v4l2.REQBUFS, request, "asked for buffers")
        if not 2 <= request.count <= 32:  # V4L2's limit
            raise self._refuse(f"{request.count} buffers")
        for index in range(request.count):
            buffer = self._make_buffer(index)
            self._call(v4l2.QUERYBUF, buffer, "asked for a buffer")
            if not 0 < buffer.length <= MAX_IMAGE_BYTES:
                raise self._refuse(f"a buffer of {buffer.length} bytes")
            try:
                mapped = self._linux.map(self._require_open(), buffer.length, buffer.offset)
            except (OSError, ValueError) as error:
                raise CameraError(
                    f"The camera {self}: a buffer cannot be mapped: {error}."
                ) from error
            self._buffers.append(mapped)
            self._views.append(np.frombuffer(mapped, np.uint8))
        for index in range(request.count):
            self._queue(index)
        on = ctypes.c_int32(v4l2.BUF_TYPE_VIDEO_CAPTURE)
        self._call(v4l2.STREAMON, on, "started")

    def take(self, timeout_s: float) -> Picture | None:
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
        if not self._linux.wait(self._require_open(), timeout_s):
            return None
        newest, n_older, n_empty = self._take_newest()
        if newest is None:
            if n_empty:
                return None
            raise CameraGoneError(f"The camera {self} reports an error instead of a picture.")
        self._taken = newest.index
        return self._describe(newest, n_older)

    def _take_newest(self) -> tuple[v4l2.Buffer | None, int, int]:
        """Returns the newest picture's buffer, and how many older and how many empty ones came.

        After an error on the wire ``uvcvideo`` gives all buffers back empty, without number and
        stamp; the numbers of the next pictures tell what was lost.
        """
        newest: v4l2.Buffer | None = None
        n_older = n_empty = 0
        for _ in range(2 * len(self._views)):  # a driver that fills them faster than this lies
            buffer = self._make_buffer(0)
            try:
                self._linux.call(self._require_open(), v4l2.DQBUF, buffer)
            except OSError as error:
                if error.errno in (errno.EAGAIN, errno.EINTR):
                    break
                raise self._explain(error, "read") from error
            if buffer.index >= len(self._views):
                raise self._refuse(f"buffer {buffer.index} of {len(self._views)}")
            if buffer.flags & v4l2.BUF_FLAG_ERROR and not buffer.bytesused:
                n_empty += 1
                self._queue(buffer.index)
                continue
            if newest is not None:
                n_older += 1
                self._queue(newest.index)
            newest = buffer
        return newest, n_older, n_empty

    def _describe(self, buffer: v4l2.Buffer, n_older: int) -> Picture:
        view = self._views[buffer.index]
        n_bytes = min(buffer.bytesused, len(view))
        stamp_us = buffer.timestamp.seconds * 1_000_000 + buffer.timestamp.microseconds
        now_us = time.monotonic_ns() // 1000
        is_monotonic = (
            buffer.flags & v4l2.BUF_FLAG_TIMESTAMP_MASK == v4l2.BUF_FLAG_TIMESTAMP_MONOTONIC
        )
        earliest_us = max(self._last_us, now_us - LATE_US)
        has_stamp = is_monotonic and earliest_us < stamp_us < now_us + EARLY_US
        t_us = stamp_us if has_stamp else max(now_us, self._last_us + 1)
        n_lost = n_older
        if self._last_sequence is not None:
            n_missing = (buffer.sequence - self._last_sequence - 1) & 0xFFFFFFFF
            n_lost = max(n_older, n_missing if n_missing <= MAX_LOST else 0)
        self._last_sequence, self._last_us = buffer.sequence, t_us
        source = buffer.flags & v4l2.BUF_FLAG_TSTAMP_SRC_MASK
        return Picture(
            data=view[:n_bytes],
            t_us=t_us,
            is_start=has_stamp and source == v4l2.BUF_FLAG_TSTAMP_SRC_SOE,
            n_lost=n_lost,
            is_damaged=bool(buffer.flags & v4l2.BUF_FLAG_ERROR) or buffer.bytesused > len(view),
            has_stamp=has_stamp,
        )

    def stop(self) -> None:
        """Stops the stream and unmaps the buffers; a second call does nothing."""
        if self._descriptor is None or not self._views:
            return
        self._taken = self._last_sequence = None
        off = ctypes.c_int32(v4l2.BUF_TYPE_VIDEO_CAPTURE)
        with suppress(CameraError):  # it is gone, or it has never started
            self._call(v4l2.STREAMOFF, off, "stopped")
        self._views.clear()
        for buffer in self._buffers:
            with suppress(BufferError):  # a picture is still in use; it is unmapped after that
                buffer.close()
        self._buffers.clear()
        none = v4l2.RequestBuffers(type=v4l2.BUF_TYPE_VIDEO_CAPTURE, memory=v4l2.MEMORY_MMAP)
        with suppress(CameraError):  # closing frees them too
            self._call(v4l2.REQBUFS, none, "stopped")

    def close(self) -> None:
        """Stops and closes; a second call does nothing."""
        if self._descriptor is None:
            return
        self.stop()
        descriptor, self._descriptor = self._descriptor, None
        with suppress(OSError):
            self._linux.close(descriptor)

    def __str__(self) -> str:
        return f"{self.name} ({self.node})" if self.name else str(self.node)

    def _require_open(self) -> int:
        if self._descriptor is None:
            raise CameraGoneError(f"The camera {self} is closed.")
        return self._descriptor

    def _make_buffer(self, index: int) -> v4l2.Buffer:
        return v4l2.Buffer(index=index, type=v4l2.BUF_TYPE_VIDEO_CAPTURE, memory=v4l2.MEMORY_MMAP)

    def _queue(self, index: int) -> None:
        self._call(v4l2.QBUF, self._make_buffer(index), "given a buffer")

    def _ask_all(self, ask: Callable[[int], _Answer], most: int) -> Iterator[_Answer]:
        """Yields the answers to an index that counts up, until the camera has no more."""
        for index in range(most):
            try:
                yield ask(index)
            except CameraGoneError:
                raise
            except CameraError:
                return

    def _call(self, number: int, argument: ctypes.Structure | ctypes.c_int32, what: str) -> None:
        try:
            self._linux.call(self._require_open(), number, argument)
        except OSError as error:
            raise self._explain(error, what) from error

    def _explain(self, error: OSError, what: str) -> CameraError:
        if error.errno in (errno.ENODEV, errno.ENXIO, errno.ENOENT):
            return CameraGoneError(f"The camera {self} is not plugged in.")
        if error.errno == errno.EBUSY:
            return CameraBusyError(
                f"The camera {self} is in use by another program.", hint="End that program first."
            )
        if error.errno in (errno.EACCES, errno.EPERM):
            return CameraError(
                f"The camera {self} cannot be {what}: no right to use it.",
                hint="Log in at the machine itself, or give your user the group 'video'.",
            )
        return CameraError(f"The camera {self} cannot be {what}: {error.strerror or error}.")

    def _refuse(self, answer: str) -> CameraError:
        return CameraError(
            f"The camera {self} offers {answer}, which makes no sense.",
            hint="Unplug it and plug it in again.",
        )


def _read_text(raw: bytes) -> str:
    return make_printable(raw.decode("utf-8", errors="replace")).strip()


def _name_fourcc(code: int) -> str:
    """Returns the four letters of a code; those that cannot be printed become question marks."""
    letters = bytes(code >> shift & 0x7F for shift in (0, 8, 16, 24)).decode("ascii")
    return "".join(letter if letter.isprintable() else "?" for letter in letters)


def _read_fourcc(fourcc: str) -> int:
    return int.from_bytes(fourcc.encode("ascii"), "little")


def _read_interval(fraction: v4l2.Fraction) -> Fraction | None:
    """Returns an interval in s; None if it makes no sense: 1 to 2000 pictures/s do."""
    if not fraction.numerator or not fraction.denominator:
        return None
    interval = Fraction(fraction.numerator, fraction.denominator)
    return interval if Fraction(1, 2000) <= interval <= 1 else None


def _is_within(size: tuple[int, int], limits: "ctypes.Array[ctypes.c_uint32]") -> bool:
    for value, least, most, step in (
        (size[0], *limits[0:3]),
        (size[1], *limits[3:6]),
    ):
        if not least <= value <= most or (value - least) % max(step, 1):
            return False
    return True

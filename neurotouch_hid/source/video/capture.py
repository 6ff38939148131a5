"""A camera through V4L2, its formats and settings: what it says is checked before it is used."""

import ctypes
import errno
import mmap
from collections.abc import Callable, Iterator
from contextlib import suppress
from fractions import Fraction
from pathlib import Path
from typing import Final, NamedTuple, TypeVar

from neurotouch_hid.closing import Closing
from neurotouch_hid.errors import CameraBusyError, CameraError
from neurotouch_hid.printable import make_printable
from neurotouch_hid.source.camera_errors import CameraGoneError
from neurotouch_hid.source.video import v4l2
from neurotouch_hid.source.video.v4l2 import Linux

MAX_FORMATS: Final = 64
MAX_SIZES: Final = 256
MAX_INTERVALS: Final = 256
MAX_SIDE_PX: Final = 8_192
MAX_IMAGE_BYTES: Final = 4 * MAX_SIDE_PX * MAX_SIDE_PX

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
        self.name = ""
        try:
            self._descriptor: int | None = self._linux.open(node)
        except OSError as error:
            raise self._explain(error, "opened") from error
        capability = v4l2.Capability()
        try:
            self.call(v4l2.QUERYCAP, capability, "asked for its name")
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
            self.call(v4l2.ENUM_FMT, answer, "asked for its formats")
            return answer

        codes = [_name_fourcc(answer.pixelformat) for answer in self._ask_all(ask, MAX_FORMATS)]
        return list(dict.fromkeys(codes))

    def list_sizes(self, fourcc: str) -> list[tuple[int, int]]:
        """Returns the sizes (width, height) of a format, in px."""
        code = _read_fourcc(fourcc)

        def ask(index: int) -> v4l2.FrameSize:
            answer = v4l2.FrameSize(index=index, pixel_format=code)
            self.call(v4l2.ENUM_FRAMESIZES, answer, "asked for its sizes")
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
            self.call(v4l2.ENUM_FRAMEINTERVALS, answer, "asked for its rates")
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
        self.call(v4l2.S_FMT, wanted, f"set to {width}x{height} {fourcc}")
        agreed = PictureFormat(
            _name_fourcc(pix.pixelformat), pix.width, pix.height, pix.bytesperline
        )
        if not (0 < agreed.width <= MAX_SIDE_PX and 0 < agreed.height <= MAX_SIDE_PX):
            raise self.refuse(f"a picture of {agreed.width}x{agreed.height} px")
        if pix.sizeimage > MAX_IMAGE_BYTES or agreed.stride > 8 * MAX_SIDE_PX:
            raise self.refuse(f"pictures of {pix.sizeimage} bytes, {agreed.stride} a row")
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
            self.call(v4l2.S_PARM, wanted, "set to a rate")
        except CameraGoneError:
            raise
        except CameraError:  # many an old driver has none
            return None
        return _read_interval(wanted.capture.timeperframe)

    def find_control(self, control: int) -> ControlRange | None:
        """Returns the range of a control; None if the camera does not have it."""
        answer = v4l2.QueryControl(id=control)
        try:
            self.call(v4l2.QUERYCTRL, answer, "asked for a control")
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
            self.call(v4l2.S_CTRL, v4l2.Control(id=control, value=value), "set")
        except CameraGoneError:
            raise
        except CameraError:
            return False
        return True

    def get_control(self, control: int) -> int | None:
        """Returns the value of a control; None if the camera does not say."""
        answer = v4l2.Control(id=control)
        try:
            self.call(v4l2.G_CTRL, answer, "asked for a control")
        except CameraGoneError:
            raise
        except CameraError:
            return None
        return int(answer.value)

    def wait(self, timeout_s: float) -> bool:
        """Waits for a picture or the end of the device; returns False after the timeout."""
        return self._linux.wait(self._require_open(), timeout_s)

    def map(self, length: int, offset: int) -> mmap.mmap:
        """Returns a buffer of the driver, mapped for reading.

        Raises:
            CameraError: it cannot be mapped.
        """
        try:
            return self._linux.map(self._require_open(), length, offset)
        except (OSError, ValueError) as error:
            raise CameraError(f"The camera {self}: a buffer cannot be mapped: {error}.") from error

    def call(self, number: int, argument: ctypes.Structure | ctypes.c_int32, what: str) -> None:
        """Makes one call of V4L2; the answer is in ``argument``.

        Args:
            number: the call.
            argument: what is asked.
            what: what the camera cannot be, if it refuses.

        Raises:
            CameraError: it refuses.
        """
        try:
            self._linux.call(self._require_open(), number, argument)
        except OSError as error:
            raise self._explain(error, what) from error

    def try_call(self, number: int, argument: ctypes.Structure, what: str) -> bool:
        """Makes one call of V4L2; returns False if there is nothing yet."""
        try:
            self._linux.call(self._require_open(), number, argument)
        except OSError as error:
            if error.errno in (errno.EAGAIN, errno.EINTR):
                return False
            raise self._explain(error, what) from error
        return True

    def refuse(self, answer: str) -> CameraError:
        """Returns the error for an answer that makes no sense."""
        return CameraError(
            f"The camera {self} offers {answer}, which makes no sense.",
            hint="Unplug it and plug it in again.",
        )

    def close(self) -> None:
        """Closes it; a second call does nothing."""
        if self._descriptor is None:
            return
        descriptor, self._descriptor = self._descriptor, None
        with suppress(OSError):
            self._linux.close(descriptor)

    def __str__(self) -> str:
        return f"{self.name} ({self.node})" if self.name else str(self.node)

    def _require_open(self) -> int:
        if self._descriptor is None:
            raise CameraGoneError(f"The camera {self} is closed.")
        return self._descriptor

    def _ask_all(self, ask: Callable[[int], _Answer], most: int) -> Iterator[_Answer]:
        """Yields the answers to an index that counts up, until the camera has no more."""
        for index in range(most):
            try:
                yield ask(index)
            except CameraGoneError:
                raise
            except CameraError:
                return

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

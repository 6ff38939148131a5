"""The part of Linux's video interface (V4L2) that this driver uses: numbers, records and calls.

Names and values are those of ``linux/videodev2.h`` and ``linux/v4l2-controls.h``; a test compares
them with what a C compiler makes of these files. The records are the same on all 64-bit machines.
"""

import ctypes
import fcntl
import mmap
import os
import select
from ctypes import Structure, Union, c_char, c_int32, c_long, c_uint8, c_uint32
from pathlib import Path
from typing import Final

CAP_VIDEO_CAPTURE: Final = 0x00000001
CAP_STREAMING: Final = 0x04000000
CAP_DEVICE_CAPS: Final = 0x80000000
BUF_TYPE_VIDEO_CAPTURE: Final = 1
MEMORY_MMAP: Final = 1
FIELD_NONE: Final = 1
SIZE_DISCRETE: Final = 1
INTERVAL_DISCRETE: Final = 1
CAP_TIMEPERFRAME: Final = 0x1000

BUF_FLAG_ERROR: Final = 0x40
BUF_FLAG_TIMESTAMP_MASK: Final = 0xE000
BUF_FLAG_TIMESTAMP_MONOTONIC: Final = 0x2000
BUF_FLAG_TSTAMP_SRC_MASK: Final = 0x70000
BUF_FLAG_TSTAMP_SRC_SOE: Final = 0x10000

CTRL_FLAG_DISABLED: Final = 0x1
CTRL_FLAG_READ_ONLY: Final = 0x4

CID_AUTO_WHITE_BALANCE: Final = 0x0098090C
CID_EXPOSURE: Final = 0x00980911
CID_AUTOGAIN: Final = 0x00980912
CID_GAIN: Final = 0x00980913
CID_POWER_LINE_FREQUENCY: Final = 0x00980918
CID_EXPOSURE_AUTO: Final = 0x009A0901
CID_EXPOSURE_ABSOLUTE: Final = 0x009A0902
CID_EXPOSURE_AUTO_PRIORITY: Final = 0x009A0903
CID_FOCUS_ABSOLUTE: Final = 0x009A090A
CID_FOCUS_AUTO: Final = 0x009A090C
EXPOSURE_MANUAL: Final = 1


class Capability(Structure):
    """``struct v4l2_capability``."""

    _fields_ = (
        ("driver", c_char * 16),
        ("card", c_char * 32),
        ("bus_info", c_char * 32),
        ("version", c_uint32),
        ("capabilities", c_uint32),
        ("device_caps", c_uint32),
        ("reserved", c_uint32 * 3),
    )


class FormatDescription(Structure):
    """``struct v4l2_fmtdesc``."""

    _fields_ = (
        ("index", c_uint32),
        ("type", c_uint32),
        ("flags", c_uint32),
        ("description", c_char * 32),
        ("pixelformat", c_uint32),
        ("mbus_code", c_uint32),
        ("reserved", c_uint32 * 3),
    )


class FrameSize(Structure):
    """``struct v4l2_frmsizeenum``; of ``size``, a discrete one uses the first two: width, height.

    A stepwise one uses least, most and step of the width, then of the height.
    """

    _fields_ = (
        ("index", c_uint32),
        ("pixel_format", c_uint32),
        ("type", c_uint32),
        ("size", c_uint32 * 6),
        ("reserved", c_uint32 * 2),
    )


class Fraction(Structure):
    """``struct v4l2_fract``."""

    _fields_ = (("numerator", c_uint32), ("denominator", c_uint32))


class FrameInterval(Structure):
    """``struct v4l2_frmivalenum``; a discrete one uses the first interval.

    A stepwise one uses three: shortest, longest, step.
    """

    _fields_ = (
        ("index", c_uint32),
        ("pixel_format", c_uint32),
        ("width", c_uint32),
        ("height", c_uint32),
        ("type", c_uint32),
        ("interval", Fraction * 3),
        ("reserved", c_uint32 * 2),
    )


class PixelFormat(Structure):
    """``struct v4l2_pix_format``."""

    _fields_ = (
        ("width", c_uint32),
        ("height", c_uint32),
        ("pixelformat", c_uint32),
        ("field", c_uint32),
        ("bytesperline", c_uint32),
        ("sizeimage", c_uint32),
        ("colorspace", c_uint32),
        ("priv", c_uint32),
        ("flags", c_uint32),
        ("ycbcr_enc", c_uint32),
        ("quantization", c_uint32),
        ("xfer_func", c_uint32),
    )


class _FormatUnion(Union):
    # A pointer, as in v4l2_window, aligns the union.
    _fields_ = (("pix", PixelFormat), ("raw", c_uint8 * 200), ("align", ctypes.c_void_p))


class Format(Structure):
    """``struct v4l2_format``."""

    _anonymous_ = ("fmt",)
    _fields_ = (("type", c_uint32), ("fmt", _FormatUnion))


class CaptureParameters(Structure):
    """``struct v4l2_captureparm``."""

    _fields_ = (
        ("capability", c_uint32),
        ("capturemode", c_uint32),
        ("timeperframe", Fraction),
        ("extendedmode", c_uint32),
        ("readbuffers", c_uint32),
        ("reserved", c_uint32 * 4),
    )


class _StreamUnion(Union):
    _fields_ = (("capture", CaptureParameters), ("raw", c_uint8 * 200))


class StreamParameters(Structure):
    """``struct v4l2_streamparm``."""

    _anonymous_ = ("parm",)
    _fields_ = (("type", c_uint32), ("parm", _StreamUnion))


class RequestBuffers(Structure):
    """``struct v4l2_requestbuffers``."""

    _fields_ = (
        ("count", c_uint32),
        ("type", c_uint32),
        ("memory", c_uint32),
        ("capabilities", c_uint32),
        ("flags", c_uint8),
        ("reserved", c_uint8 * 3),
    )


class _Time(Structure):
    _fields_ = (("seconds", c_long), ("microseconds", c_long))


class _BufferUnion(Union):
    _fields_ = (("offset", c_uint32), ("userptr", ctypes.c_ulong))


class Buffer(Structure):
    """``struct v4l2_buffer``."""

    _anonymous_ = ("m",)
    _fields_ = (
        ("index", c_uint32),
        ("type", c_uint32),
        ("bytesused", c_uint32),
        ("flags", c_uint32),
        ("field", c_uint32),
        ("timestamp", _Time),
        ("timecode", c_uint8 * 16),
        ("sequence", c_uint32),
        ("memory", c_uint32),
        ("m", _BufferUnion),
        ("length", c_uint32),
        ("reserved2", c_uint32),
        ("request_fd", c_int32),
    )


class QueryControl(Structure):
    """``struct v4l2_queryctrl``."""

    _fields_ = (
        ("id", c_uint32),
        ("type", c_uint32),
        ("name", c_char * 32),
        ("minimum", c_int32),
        ("maximum", c_int32),
        ("step", c_int32),
        ("default_value", c_int32),
        ("flags", c_uint32),
        ("reserved", c_uint32 * 2),
    )


class Control(Structure):
    """``struct v4l2_control``."""

    _fields_ = (("id", c_uint32), ("value", c_int32))


_WRITE, _READ, _BOTH = 1, 2, 3


def _number(direction: int, number: int, argument: type[Structure] | type[c_int32]) -> int:
    """Returns the number of a call as ``_IOC`` of asm-generic/ioctl.h makes it."""
    return direction << 30 | ctypes.sizeof(argument) << 16 | ord("V") << 8 | number


QUERYCAP: Final = _number(_READ, 0, Capability)
ENUM_FMT: Final = _number(_BOTH, 2, FormatDescription)
G_FMT: Final = _number(_BOTH, 4, Format)
S_FMT: Final = _number(_BOTH, 5, Format)
REQBUFS: Final = _number(_BOTH, 8, RequestBuffers)
QUERYBUF: Final = _number(_BOTH, 9, Buffer)
QBUF: Final = _number(_BOTH, 15, Buffer)
DQBUF: Final = _number(_BOTH, 17, Buffer)
STREAMON: Final = _number(_WRITE, 18, c_int32)
STREAMOFF: Final = _number(_WRITE, 19, c_int32)
G_PARM: Final = _number(_BOTH, 21, StreamParameters)
S_PARM: Final = _number(_BOTH, 22, StreamParameters)
G_CTRL: Final = _number(_BOTH, 27, Control)
S_CTRL: Final = _number(_BOTH, 28, Control)
QUERYCTRL: Final = _number(_BOTH, 36, QueryControl)
ENUM_FRAMESIZES: Final = _number(_BOTH, 74, FrameSize)
ENUM_FRAMEINTERVALS: Final = _number(_BOTH, 75, FrameInterval)


class Linux:
    """The calls into Linux; a test puts a driver of its own in their place."""

    def list_nodes(self) -> list[Path]:
        """Returns the device nodes of all video devices, by number."""
        nodes = [path for path in Path("/dev").glob("video*") if path.name[5:].isdecimal()]
        return sorted(nodes, key=lambda path: int(path.name[5:]))

    def open(self, node: Path) -> int:
        """Returns a descriptor of the node."""
        return os.open(node, os.O_RDWR | os.O_NONBLOCK | os.O_CLOEXEC)

    def close(self, descriptor: int) -> None:
        """Closes it."""
        os.close(descriptor)

    def call(self, descriptor: int, number: int, argument: Structure | c_int32) -> None:
        """Makes one call; the answer is in ``argument``."""
        fcntl.ioctl(descriptor, number, argument)

    def map(self, descriptor: int, length: int, offset: int) -> mmap.mmap:
        """Returns a buffer of the driver, mapped for reading."""
        return mmap.mmap(descriptor, length, mmap.MAP_SHARED, mmap.PROT_READ, offset=offset)

    def wait(self, descriptor: int, timeout_s: float) -> bool:
        """Waits for a picture or the end of the device; returns False after the timeout."""
        poll = select.poll()
        poll.register(descriptor, select.POLLIN)
        return bool(poll.poll(1e3 * timeout_s))

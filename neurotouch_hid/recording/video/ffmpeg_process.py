"""The process that decodes for ``ffmpeg.py``: a Matroska stream comes in, pictures go out.

Each picture is written as its time in µs, its width and height, and its grey values, row by row.
The process ends with 0 if everything that came in was decoded.
"""

import os
import resource
import signal
import struct
from pathlib import Path
from typing import Any, Final

PICTURE_HEAD: Final = struct.Struct("<qII")
_MOST_MORE_BYTES: Final = 256 << 20
"""Memory for decoding, above that of the libraries. 16 pictures of the largest size need 160 MB."""
_PLANAR: Final = frozenset((b"I420", b"Y42B", b"444P", b"Y800", b"GREY"))
"""Pixel formats whose first plane is the grey picture, as OpenCV names them."""


def run() -> int:
    """Decodes what comes through standard input; returns the exit code."""
    import cv2  # noqa: PLC0415  # for this process only

    cv2.setNumThreads(1)
    _limit()
    options = [cv2.CAP_PROP_N_THREADS, 1]
    capture = cv2.VideoCapture("pipe:0", cv2.CAP_FFMPEG, options)
    tag = int(capture.get(cv2.CAP_PROP_CODEC_PIXEL_FORMAT)) & 0xFFFFFFFF
    if tag.to_bytes(4, "little") in _PLANAR:
        capture.set(cv2.CAP_PROP_CONVERT_RGB, 0)
    while True:
        has_picture, pixels = capture.read()
        if not has_picture:
            break
        grey: Any = pixels if pixels.ndim == 2 else cv2.cvtColor(pixels, cv2.COLOR_BGR2GRAY)
        height, width = grey.shape
        t_us = round(capture.get(cv2.CAP_PROP_POS_MSEC) * 1000)
        _write(PICTURE_HEAD.pack(t_us, width, height))
        _write(memoryview(grey).cast("B"))
    return 1 if os.read(0, 1) else 0


def _limit() -> None:
    """Lets this process open nothing more than the stream, write no file and grow only so far."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the command that wants pictures
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    most = pages * resource.getpagesize() + _MOST_MORE_BYTES
    # FFmpeg copies the input to the first free number. libffi 3.5 keeps a file open: it is not 3.
    free = os.dup(0)
    os.close(free)
    for limit, value in (
        (resource.RLIMIT_AS, most),
        (resource.RLIMIT_CORE, 0),
        (resource.RLIMIT_FSIZE, 0),
        (resource.RLIMIT_NOFILE, free + 1),
    ):
        resource.setrlimit(limit, (value, value))


def _write(data: bytes | memoryview) -> None:
    view = memoryview(data)
    while view:
        view = view[os.write(1, view) :]


if __name__ == "__main__":
    raise SystemExit(run())

"""A V4L2 driver at the edge of ours, in the place of Linux: cameras that a test plugs in.

It behaves as ``Documentation/userspace-api/media/v4l`` says. A test may let it lie: a function in
``lies`` changes the honest answer to a call.
"""

import errno
import mmap
import os
import time
from collections import deque
from fractions import Fraction
from pathlib import Path

import cv2
import numpy as np

from neurotouch_hid.source.video import v4l2

UVC_CONTROLS = {
    v4l2.CID_EXPOSURE_AUTO: (0, 3, 1, 3),
    v4l2.CID_EXPOSURE_AUTO_PRIORITY: (0, 1, 1, 1),
    v4l2.CID_EXPOSURE_ABSOLUTE: (1, 5000, 1, 157),
    v4l2.CID_GAIN: (0, 100, 1, 20),
    v4l2.CID_AUTO_WHITE_BALANCE: (0, 1, 1, 1),
    v4l2.CID_POWER_LINE_FREQUENCY: (0, 2, 1, 1),
    v4l2.CID_FOCUS_AUTO: (0, 1, 1, 1),
}
YUYV = {"YUYV": {(640, 480): (30, 60), (320, 240): (125, 60)}}
PAGE = mmap.PAGESIZE


class FakeCamera:
    """One camera, plugged in as long as it is among ``FakeLinux.cameras``.

    Attributes:
        controls: the value of each control now.
        fps: pictures/s that it sends, if others than it agreed to.
        lies: functions that change an answer, by the number of the call.
        is_silent: sends nothing.
        is_asked: sends a picture only when it is waited for, or by ``send``; at no time of its own.
        in_use: another program streams from it.
    """

    def __init__(
        self, name="UVC Camera", bus_info="usb-0000:00:14.0-2", formats=YUYV, controls=UVC_CONTROLS
    ):
        self.name, self.bus_info = name, bus_info
        self.formats = formats
        self.ranges = dict(controls)
        self.controls = {control: values[3] for control, values in controls.items()}
        self.fps = None
        self.lies = {}
        self.capabilities = v4l2.CAP_VIDEO_CAPTURE | v4l2.CAP_STREAMING
        self.flags = v4l2.BUF_FLAG_TIMESTAMP_MONOTONIC | v4l2.BUF_FLAG_TSTAMP_SRC_SOE
        self.is_silent = self.in_use = self.is_asked = False
        self.draw = lambda k: np.full((480, 640), k % 256, np.uint8)
        self.encode = None  # bytes of a picture, in the place of those of its format
        self.fourcc, self.size, self.interval = "YUYV", (640, 480), Fraction(1, 30)
        self.n_open = self.n_mapped = 0
        self.stop()

    def stop(self):
        self.begun_s = None
        self.n_sent = 0
        self.sent_s = []
        self.memory, self.queued, self.filled = [], deque(), deque()

    @property
    def stride(self):
        return self.size[0] * (2 if self.fourcc in ("YUYV", "UYVY") else 1)

    def answer(self, number, argument):
        getattr(self, f"_{NAMES[number]}")(argument)
        if number in self.lies:
            self.lies[number](argument)

    def fill(self):
        """Fills queued buffers with the pictures that were due by now; those without are lost."""
        if self.begun_s is None or self.is_silent:
            return
        if self.is_asked:
            return
        fps = self.fps or float(1 / self.interval)
        n_due = int((time.monotonic() - self.begun_s) * fps)
        self._send([self.begun_s + (k + 1) / fps for k in range(self.n_sent, n_due)])

    def send(self, n):
        """Sends some pictures now."""
        self._send([time.monotonic() for _ in range(n)])

    def fail(self):
        """An error on the wire: a picture is lost, and all buffers come back empty (uvcvideo)."""
        self.n_sent += 1
        while self.queued:
            self.filled.append((self.queued.popleft(), None, 0, 0.0))

    def _send(self, times_s):
        for at_s in times_s:
            k = self.n_sent
            self.n_sent += 1
            if not self.queued:
                continue
            index = self.queued.popleft()
            data = self.encode(k) if self.encode else self._encode(k)
            memory = self.memory[index % len(self.memory)] or bytearray()
            data = data[: len(memory)]  # of another size, if it has lied
            memory[: len(data)] = data
            self.filled.append((index, k, len(data), at_s))
            self.sent_s.append(at_s)

    def _encode(self, k):
        width, height = self.size
        grey = self.draw(k)
        if grey.shape != (height, width):
            grey = cv2.resize(grey, (width, height), interpolation=cv2.INTER_AREA)
        if self.fourcc in ("MJPG", "JPEG"):
            return cv2.imencode(".jpg", grey)[1].tobytes()
        if self.fourcc == "YUYV":
            return np.stack([grey, np.full_like(grey, 128)], axis=-1).tobytes()
        if self.fourcc == "UYVY":
            return np.stack([np.full_like(grey, 128), grey], axis=-1).tobytes()
        return grey.tobytes() + bytes([128]) * (width * height // 2 * (self.fourcc != "GREY"))

    def _querycap(self, answer):
        answer.driver, answer.card = b"fake", self.name.encode()
        answer.bus_info = self.bus_info.encode()
        answer.capabilities = self.capabilities | v4l2.CAP_DEVICE_CAPS
        answer.device_caps = self.capabilities

    def _enum_fmt(self, answer):
        answer.pixelformat = code_of(pick(list(self.formats), answer.index))

    def _enum_framesizes(self, answer):
        sizes = self.formats.get(name_of(answer.pixel_format), {})
        answer.type = v4l2.SIZE_DISCRETE
        answer.size[0], answer.size[1] = pick(list(sizes), answer.index)

    def _enum_frameintervals(self, answer):
        sizes = self.formats.get(name_of(answer.pixel_format), {})
        rates = sizes.get((answer.width, answer.height), ())
        interval = Fraction(1, pick(rates, answer.index))
        answer.type = v4l2.INTERVAL_DISCRETE
        answer.interval[0].numerator = interval.numerator
        answer.interval[0].denominator = interval.denominator

    def _s_fmt(self, answer):
        if self.in_use or self.begun_s is not None:
            raise OSError(errno.EBUSY, "busy")
        pix = answer.pix
        known = name_of(pix.pixelformat)
        self.fourcc = known if known in self.formats else next(iter(self.formats))
        sizes = self.formats[self.fourcc]
        self.size = min(
            sizes, key=lambda size: abs(size[0] - pix.width) + abs(size[1] - pix.height)
        )
        pix.pixelformat = code_of(self.fourcc)
        pix.width, pix.height = self.size
        pix.bytesperline = 0 if self.fourcc in ("MJPG", "JPEG") else self.stride
        pix.sizeimage = self.size[0] * self.size[1] * 2

    def _s_parm(self, answer):
        rates = self.formats[self.fourcc][self.size]
        wanted = answer.capture.timeperframe
        fps = min(rates, key=lambda rate: abs(rate - wanted.denominator / wanted.numerator))
        self.interval = Fraction(1, fps)
        wanted.numerator, wanted.denominator = 1, fps
        answer.capture.capability = v4l2.CAP_TIMEPERFRAME

    def _queryctrl(self, answer):
        if answer.id not in self.ranges:
            raise OSError(errno.EINVAL, "no such control")
        answer.minimum, answer.maximum, answer.step, answer.default_value = self.ranges[answer.id]

    def _g_ctrl(self, answer):
        if answer.id not in self.ranges:
            raise OSError(errno.EINVAL, "no such control")
        answer.value = self.controls[answer.id]

    def _s_ctrl(self, answer):
        if answer.id not in self.ranges:
            raise OSError(errno.EINVAL, "no such control")
        least, most, _, _ = self.ranges[answer.id]
        if not least <= answer.value <= most:
            raise OSError(errno.ERANGE, "out of range")
        self.controls[answer.id] = answer.value

    def _reqbufs(self, answer):
        if answer.count:
            answer.count = min(max(answer.count, 2), 32)
            size = self.size[0] * self.size[1] * 2
            self.n_bytes = -(-size // PAGE) * PAGE
            self.memory = [None] * answer.count

    def _querybuf(self, answer):
        answer.length, answer.offset = self.n_bytes, answer.index * self.n_bytes

    def _qbuf(self, answer):
        if answer.index in self.queued:
            raise OSError(errno.EINVAL, "queued already")
        self.queued.append(answer.index)

    def _dqbuf(self, answer):
        self.fill()
        if not self.filled:
            raise OSError(errno.EAGAIN, "nothing there")
        index, k, n_bytes, at_s = self.filled.popleft()
        answer.index, answer.bytesused, answer.sequence = index, n_bytes, k or 0
        answer.flags = self.flags | v4l2.BUF_FLAG_ERROR * (k is None)
        answer.timestamp.seconds, rest_s = divmod(at_s, 1)[0].__int__(), at_s % 1
        answer.timestamp.microseconds = int(1e6 * rest_s)

    def _streamon(self, _):
        self.begun_s, self.n_sent = time.monotonic(), 0

    def _streamoff(self, _):
        self.begun_s = None
        self.queued.clear()
        self.filled.clear()


NAMES = {
    getattr(v4l2, name.upper()): name
    for name in (
        *("querycap", "enum_fmt", "enum_framesizes", "enum_frameintervals", "s_fmt", "s_parm"),
        *("queryctrl", "g_ctrl", "s_ctrl", "reqbufs", "querybuf", "qbuf", "dqbuf"),
        *("streamon", "streamoff"),
    )
}


class FakeLinux:
    """The cameras that are plugged in, by the number of their nodes."""

    def __init__(self, *cameras):
        self.cameras = dict(enumerate(cameras))
        self._open = {}
        self._next = 100

    def list_nodes(self):
        return [Path(f"/dev/video{number}") for number in sorted(self.cameras)]

    def open(self, node):
        camera = self.cameras.get(int(node.name[5:]))
        if camera is None:
            raise OSError(errno.ENOENT, os.strerror(errno.ENOENT))
        self._next += 1
        self._open[self._next] = camera
        camera.n_open += 1
        return self._next

    def close(self, descriptor):
        self._open.pop(descriptor).n_open -= 1

    def call(self, descriptor, number, argument):
        camera = self._open[descriptor]
        if not self._is_there(camera):
            raise OSError(errno.ENODEV, os.strerror(errno.ENODEV))
        camera.answer(number, argument)

    def map(self, descriptor, length, offset):
        camera = self._open[descriptor]
        memory = mmap.mmap(-1, length)
        camera.memory[offset // camera.n_bytes % len(camera.memory)] = memory
        camera.n_mapped += 1
        return memory

    def wait(self, descriptor, timeout_s):
        camera = self._open[descriptor]
        deadline = time.monotonic() + timeout_s
        while self._is_there(camera):
            camera.fill()
            if camera.is_asked and not camera.filled and not camera.is_silent:
                camera.send(1)
            if camera.filled:
                return True
            if time.monotonic() >= deadline:
                return False
            time.sleep(0.0005)
        return True

    def unplug(self, number):
        camera = self.cameras.pop(number)
        camera.stop()
        return camera

    def _is_there(self, camera):
        return any(each is camera for each in self.cameras.values())


def code_of(fourcc):
    return int.from_bytes(fourcc.encode(), "little")


def name_of(code):
    return code.to_bytes(4, "little").decode("latin-1")


def pick(values, index):
    if index >= len(values):
        raise OSError(errno.EINVAL, "no more")
    return values[index]

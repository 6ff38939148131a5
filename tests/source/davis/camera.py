"""A scripted camera at the driver's edge: a table of registers, and what its stream brings."""

import struct
import time
from collections import deque

from neurotouch_hid.source.camera_errors import CameraAbsentError, CameraGoneError
from neurotouch_hid.source.davis.enumeration import CameraInfo
from tests.source.davis.words import pack

VALUES = {
    **dict.fromkeys([(0, 80), (2, 6), (4, 10), (6, 7)], 1),
    **dict.fromkeys([(1, p) for p in (10, 30, 40, 50, 60, 80)], 1),
    **dict(zip([(1, 0), (1, 1), (1, 2), (2, 2)], (260, 346, 4, 4), strict=True)),
    **dict(zip([(6, p) for p in (0, 1, 3, 4, 5, 6)], (18, 5, 120, 30, 80, 1008), strict=True)),
}
INFO = CameraInfo(2, 5, "2-1", "00001055", "DAVIS 346", 5000, 6)
RESET = b"\x01\x00"
EDGE = b"\x02\x00"
"""Of the external input, which is not connected."""


class ScriptedCamera:
    """Its own bus, and its own transport.

    ``script`` is what ``pump`` meets, in order: bytes, an error to raise, or a call to make. After
    the script nothing comes but a sign of life, or the driver would look after it; nothing at all
    if it is ``silent``.
    """

    def __init__(self, values=(), infos=(INFO,)):
        self.values = VALUES | dict(values)
        self.infos = list(infos)
        self.script = deque()
        self.silent = False
        self.log = []
        self.rests = []  # when ``pump`` was called, and until when it may sleep
        self.at_reset = deque()  # a stream for each time the clock is reset
        self.fail_at = {}  # number of a request -> error
        self.n_requests = 0
        self.n_open = self.n_opened = self.n_queued = 0
        self.receive = None

    # The bus.

    def choose(self, serial):
        for info in self.infos:
            if serial in ("", info.serial):
                return info
        raise CameraAbsentError(f"No camera {serial} is plugged in.")

    def open(self, info):
        assert not self.n_open
        self.n_open += 1
        self.n_opened += 1
        return self

    def watch(self):
        return self

    def wait(self, timeout_s):
        time.sleep(0.001)

    # The transport, and the watch's close.

    def request(self, code, value, index, data):
        self.n_requests += 1
        error = self.fail_at.get(self.n_requests)
        if error is not None:
            raise error
        if isinstance(data, int):
            return self.values.get((value, index), 0).to_bytes(4, "big")
        writes = (
            [struct.unpack(">BBI", data[k : k + 6]) for k in range(0, len(data), 6)]
            if code == 0xC2
            else [(value, index, int.from_bytes(data, "big"))]
            if code == 0xBF
            else []
        )
        for module, parameter, word in writes:
            self.log.append((module, parameter, word))
            if module != 6:
                self.values[module, parameter] = word
            if (module, parameter, word) == (0, 2, 1):
                self.script.append(RESET)
                if self.at_reset:
                    self.script.extend(self.at_reset.popleft())
        return b""

    def queue(self, receive):
        self.log.append("queue")
        self.receive = receive
        self.n_queued += 1

    def pump(self, timeout_s, rest_until_s, time_word, most_noise):
        self.rests.append((time.monotonic(), rest_until_s))
        self.most_noise = most_noise
        if not self.script:
            time.sleep(0.002)
            if not self.silent:
                self.receive(EDGE)
            return
        item = self.script.popleft()
        if isinstance(item, bytes):
            self.receive(item)
        elif isinstance(item, Exception):
            raise item
        else:
            item()

    def close(self):
        self.n_open = 0


def gone():
    return CameraGoneError("The camera is gone.")


def make_events(begin_ms, end_ms):
    """One ON event a millisecond, at x = row = ms % 346; wraps included."""
    words, base = [], begin_ms * 1000 // 0x8000
    if base and begin_ms:
        words.append(f"{0x7000 | base:04X}")
    for ms in range(begin_ms, end_ms):
        wraps, low = divmod(ms * 1000 + 1, 0x8000)
        if wraps > base:
            words.append(f"{0x7000 | (wraps - base):04X}")
            base = wraps
        words += [f"{0x8000 | low:04X}", f"{0x1000 | ms % 346:04X}", "3005"]
    return pack(" ".join(words))

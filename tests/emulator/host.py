"""A host on the other side of an emulated camera, with a clock of its own."""

import numpy as np
from neurotouch_devtools.emulator import CameraConfig, EmulatedCamera
from neurotouch_devtools.emulator.port import Port
from neurotouch_devtools.emulator.usb import Setup

from neurotouch_hid.messages import EVENT_DTYPE, EventPacket, Frame
from tests.emulator.listener import Listener

OUT, IN = 0x40, 0xC0
PART = (100, 50, 163, 81)
SWITCH_ON = [(0, 3), (9, 0), (0, 1), (0, 0), (1, 3), (2, 4)]


def make_scene(seed=0, n_events=2000, length_us=200_000, n_frames=3, slice_us=10_000):
    """Random events and frames, in packets."""
    rng = np.random.default_rng(seed)
    events = np.zeros(n_events, EVENT_DTYPE)
    events["t"] = np.sort(rng.integers(0, length_us, n_events))
    events["x"] = rng.integers(0, 346, n_events)
    events["y"] = rng.integers(0, 260, n_events)
    events["p"] = rng.integers(0, 2, n_events)
    begins = [20_000 + 50_000 * k for k in range(n_frames)]
    frames = [
        Frame(rng.integers(0, 256, (260, 346)).astype(np.uint8), begin, begin + 4000)
        for begin in begins
    ]
    return [
        EventPacket(
            t,
            t + slice_us,
            events[(events["t"] >= t) & (events["t"] < t + slice_us)],
            tuple(f for f in frames if t <= f.exposure_end_us < t + slice_us),
        )
        for t in range(0, length_us, slice_us)
    ]


def list_events(packets):
    return [(t, x, y, bool(on)) for packet in packets for t, x, y, on in packet.events.tolist()]


class Host:
    """Asks, reads, listens; ``now_us`` is its clock."""

    def __init__(self, packets, config=None, faults=()):
        self.now_us = 0
        self.camera = EmulatedCamera(
            packets, config or CameraConfig(), faults, clock_ns=lambda: 1000 * self.now_us
        )
        self.port = Port(self.camera, clock_ns=lambda: 1000 * self.now_us)
        self.listener = Listener(self.camera.config.orientation)
        self.answers = []
        self.data = b""
        self._number = 0

    def request(self, kind, request, value, index, data=b"", length=0):
        self._number += 1
        setup = Setup(kind, request, value, index, length or len(data))
        return self.port.control(self._number, setup, data)

    def read(self, module, parameter):
        return int.from_bytes(self.request(IN, 0xBF, module, parameter, length=4).data, "big")

    def write(self, module, parameter, value):
        return self.request(OUT, 0xBF, module, parameter, value.to_bytes(4, "big"))

    def switch_on(self, *, exclude=()):
        self.queue()
        for module, parameter in SWITCH_ON:
            if (module, parameter) not in exclude:
                self.write(module, parameter, 1)

    def read_part(self):
        """Have a small part of the frames read: plain Python decodes it soon."""
        for parameter, value in zip((8, 9, 10, 11), PART, strict=True):
            self.write(2, parameter, value)

    def reset_time(self):
        self.request(OUT, 0xC2, 2, 0, bytes([0, 2, 0, 0, 0, 1, 0, 2, 0, 0, 0, 0]))

    def queue(self, n=8, length=8192):
        for _ in range(n):
            self._number += 1
            self.port.submit(self._number, 0x82, length)

    def wait(self, us, *, step_us=500):
        """Let time pass, take what comes, queue as many transfers again."""
        for _ in range(us // step_us):
            self.now_us += step_us
            answers = list(self.port.completions())
            self.answers += answers
            self.data += b"".join(answer.data for answer in answers)
            self.queue(len(answers))

    def listen(self):
        """Decode all that has come."""
        data, self.data = self.data, b""
        return self.listener.hear(data)

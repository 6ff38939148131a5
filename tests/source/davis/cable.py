"""A cable without a kernel: the emulated camera's endpoints as the driver's transport."""

import time

from neurotouch_devtools.emulator import CameraConfig, EmulatedCamera
from neurotouch_devtools.emulator.faults import FaultError, FaultKind
from neurotouch_devtools.emulator.requests import ControlEndpoint
from neurotouch_devtools.emulator.transfers import DataEndpoint
from neurotouch_devtools.emulator.usb import Setup

from neurotouch_hid.errors import CameraError
from neurotouch_hid.source.camera_errors import CameraAbsentError, CameraGoneError
from neurotouch_hid.source.davis.enumeration import CameraInfo
from neurotouch_hid.source.davis.transport import StreamHaltedError

TRANSFER_BYTES = 8_192
LOOK_S = 0.000_25


class Clock:
    """The camera's time, if it passes only while the driver looks: a busy machine changes nothing.

    The camera's ``clock_ns``; ``step`` is for its ``Cable``.
    """

    def __init__(self):
        self.now_ns = 0

    def __call__(self):
        return self.now_ns

    def step(self):
        self.now_ns += round(1e9 * LOOK_S)


def sleep():
    time.sleep(LOOK_S)


class Cable:
    """Where the driver finds the camera, and what it reaches it through. ``plug`` puts one in.

    ``step`` lets time pass between two looks for data.
    """

    def __init__(self, camera=None, step=sleep):
        self.step = step
        self.camera = self.info = None
        self.n_open = self.n_plugs = 0
        if camera is not None:
            self.plug(camera)

    def plug(self, camera):
        identity = camera.config.identity
        self.data = DataEndpoint(camera)
        self.control = ControlEndpoint(camera, self.data)
        self.n_plugs += 1
        self.info = CameraInfo(
            bus=2,
            address=self.n_plugs,
            port_path="2-1",
            serial=identity.serial,
            product="DAVIS 346",
            speed_mbit_s=5000 if identity.super_speed else 480,
            firmware=identity.firmware,
        )
        self.camera = camera  # last: another thread may be looking for it

    def unplug(self):
        self.camera = None

    def choose(self, serial):
        if self.camera is None or serial not in ("", self.info.serial):
            raise CameraAbsentError("No DAVIS camera is plugged in.")
        return self.info

    def open(self, info):
        assert not self.n_open
        self.n_open += 1
        return self

    def watch(self):
        return Nothing()

    def request(self, code, value, index, data):
        reads = isinstance(data, int)
        setup = Setup(0xC0 if reads else 0x40, code, value, index, data if reads else len(data))
        if self.camera is None:
            raise CameraGoneError("The camera is gone.")
        try:
            return self.control.answer(setup, b"" if reads else data)
        except FaultError as error:
            if error.kind is FaultKind.UNPLUG:
                self.unplug()
                raise CameraGoneError("The camera is gone.") from error
            raise CameraError(f"The camera cannot be asked: {error.kind}.") from error

    def queue(self, receive):
        self.receive = receive
        self.data.clear_halt()

    def pump(self, timeout_s, rest_until_s, time_word, most_noise):
        for _ in range(round(timeout_s / LOOK_S)):
            self.step()
            camera = self.camera  # another thread may pull it out
            if camera is None:
                raise CameraGoneError("The camera is gone.")
            try:
                data = self.data.answer(TRANSFER_BYTES)
            except FaultError as error:
                if error.kind is FaultKind.UNPLUG:
                    self.unplug()
                elif error.kind is not FaultKind.TIMEOUT:
                    self.receive(b"")
                if error.kind is FaultKind.STALL:
                    raise StreamHaltedError("The camera's stream has stalled.") from error
                continue
            if data is not None:
                self.receive(data)
                if camera.ended:  # only empty slices follow: no flood of them
                    time.sleep(0.01)
                return
        time.sleep(0.005)  # a camera that sends nothing at all shall not keep the processor busy

    def close(self):
        self.n_open = 0


class Nothing:
    """Hears of no camera."""

    def wait(self, timeout_s):
        time.sleep(0.005)

    def close(self):
        pass


def emulate(packets, faults=(), clock_ns=time.monotonic_ns, **options):
    """An emulated camera whose scene begins when it has been started."""
    config = CameraConfig(**{"lead_us": 100_000, "fifo_bytes": 1 << 26} | options)
    return EmulatedCamera(packets, config, faults, clock_ns=clock_ns)

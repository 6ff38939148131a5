"""The emulated PS3 Eye, seen from its port, as Linux's driver speaks to it."""

import struct

import numpy as np
import pytest
from neurotouch_devtools.emulator import Fault
from neurotouch_devtools.emulator.port import Port, UnpluggedError
from neurotouch_devtools.emulator.ps3eye import PAYLOAD_BYTES, EyeCamera
from neurotouch_devtools.emulator.usb import Setup
from neurotouch_devtools.emulator.uvc import Film

TRANSFER_BYTES = 16_384
PICTURE, END, HAS_TIME = 1, 2, 4
FILM = Film(np.random.default_rng(1).integers(0, 256, (40, 24, 32)).astype(np.uint8))
QVGA, VGA = (320, 240), (640, 480)
RATES = [
    (QVGA, 187, 0x01, 0x81, 0x02),
    (QVGA, 150, 0x01, 0xC1, 0x04),
    (QVGA, 125, 0x02, 0x81, 0x02),
    (QVGA, 100, 0x02, 0xC1, 0x04),
    (QVGA, 75, 0x03, 0xC1, 0x04),
    (QVGA, 60, 0x04, 0xC1, 0x04),
    (QVGA, 50, 0x02, 0x41, 0x04),
    (QVGA, 37, 0x03, 0x41, 0x04),
    (QVGA, 30, 0x04, 0x41, 0x04),
    (VGA, 60, 0x01, 0xC1, 0x04),
    (VGA, 50, 0x01, 0x41, 0x02),
    (VGA, 40, 0x02, 0xC1, 0x04),
    (VGA, 30, 0x04, 0x81, 0x02),
    (VGA, 15, 0x03, 0x41, 0x04),
]
"""Size, pictures a second, and three registers of which the driver says that they give them."""


class Host:
    """Speaks to the bridge, and puts pictures together; ``now_us`` is its clock."""

    def __init__(self, *faults, **config):
        self.now_us = 0

        def read_clock():
            return 1000 * self.now_us

        faults = [Fault.parse(fault) for fault in faults]
        self.camera = EyeCamera(FILM, faults=faults, clock_ns=read_clock, **config)
        self.port = Port(self.camera, clock_ns=read_clock)
        self.pictures = []
        self.statuses = []
        self._parts = []
        self._last = None
        self._number = 0

    def control(self, kind, index, data=b"", request=1):
        self._number += 1
        return self.port.control(self._number, Setup(kind, request, 0, index, 1), data)

    def write(self, register, value):
        assert self.control(0x40, register, bytes([value])).status == 0

    def read(self, register):
        return self.control(0xC0, register).data[0]

    def write_sensor(self, register, value):
        self.write(0xF2, register)
        self.write(0xF3, value)
        self.write(0xF5, 0x37)
        assert self.read(0xF6) == 0

    def read_sensor(self, register):
        self.write(0xF2, register)
        for operation in (0x33, 0xF9):
            self.write(0xF5, operation)
            assert self.read(0xF6) == 0
        return self.read(0xF4)

    def start(self, size=QVGA, clock=0x01, multiplier=0x81, factor=0x02):
        self.write(0xC0, size[0] // 8)
        self.write(0xC1, size[1] // 8)
        self.write(0xC2, 0x0C)
        self.write_sensor(0x11, clock)
        self.write_sensor(0x0D, multiplier)
        self.write(0xE5, factor)
        self.write(0xE0, 0x00)

    def stream(self, for_us):
        until_us = self.now_us + for_us
        for _ in range(2):
            self._number += 1
            self.port.submit(self._number, 0x81, TRANSFER_BYTES)
        while self.now_us < until_us:
            for done in list(self.port.completions()):  # an unpaced camera always has more
                self.statuses.append(done.status)
                self._take(done.data)
                self._number += 1
                self.port.submit(self._number, 0x81, TRANSFER_BYTES)
            self.now_us += 500

    def _take(self, data):
        """Does with a transfer what the driver does."""
        for at in range(0, len(data), PAYLOAD_BYTES):
            part = data[at : at + PAYLOAD_BYTES]
            size, flags, time = struct.unpack_from("<BBI", part)
            assert size == 12
            assert flags & HAS_TIME
            if (flags & PICTURE, time) != self._last:
                self._parts, self._last = [], (flags & PICTURE, time)
            self._parts.append(part[size:])
            if flags & END:
                self.pictures.append(b"".join(self._parts))


def test_the_sensor_answers_by_its_number_also_after_a_reset():
    host = Host()
    assert (host.read_sensor(0x0A), host.read_sensor(0x0B)) == (0x77, 0x21)
    host.write_sensor(0x13, 0xFF)
    assert host.read_sensor(0x13) == 0xFF
    host.write_sensor(0x0A, 0x11)
    host.write_sensor(0x12, 0x80)
    assert host.read_sensor(0x13) == 0
    assert (host.read_sensor(0x0A), host.read_sensor(0x0B)) == (0x77, 0x21)


def test_registers_of_the_bridge_keep_what_is_written():
    host = Host()
    host.write(0x21, 0x80)
    assert host.read(0x21) == 0x80
    assert host.control(0x40, 0x100, b"1").status < 0
    assert host.control(0x40, 0x21, b"").status < 0
    assert host.control(0x40, 0x21, b"1", request=2).status < 0


@pytest.mark.parametrize(("size", "fps", "clock", "multiplier", "factor"), RATES)
def test_the_registers_give_the_rate_that_the_driver_promises(size, fps, clock, multiplier, factor):
    host = Host()
    host.start(size, clock, multiplier, factor)
    agreed = host.camera.agreement
    assert (agreed.mode.width, agreed.mode.height) == size
    assert 1e7 / agreed.interval == pytest.approx(fps, rel=0.015)


@pytest.mark.parametrize("size", [QVGA, VGA])
def test_pictures_arrive_whole_and_in_order(size):
    host = Host(unpaced=True)
    host.start(size)
    host.stream(400_000)
    host.write(0xE0, 0x09)
    assert len(host.pictures) > 10
    assert host.camera.n_lost == 0
    assert {len(picture) for picture in host.pictures} == {2 * size[0] * size[1]}
    assert host.camera.agreement is None
    for picture in host.pictures:
        luma = np.frombuffer(picture, np.uint8)[::2].reshape(size[::-1])
        assert luma.std() > 10


def test_it_sends_as_many_pictures_as_it_should():
    host = Host()
    host.start()
    host.stream(1_000_000)
    assert 155 <= host.camera.n_sent <= 187  # it waits for 0.1 s at first


def test_a_host_that_does_not_read_loses_pictures_and_the_camera_counts_them():
    host = Host()
    host.start()
    host.stream(300_000)
    host.now_us += 200_000
    host.stream(100_000)
    assert host.camera.n_lost == pytest.approx(0.2 * 187, abs=4)


def test_a_pulled_cable_and_a_failed_transfer():
    host = Host("unplug@picture+4", unpaced=True)
    host.start()
    with pytest.raises(UnpluggedError):
        host.stream(400_000)
    assert len(host.pictures) == 4
    host = Host("protocol@stream+12", unpaced=True)
    host.start()
    host.stream(400_000)
    assert sorted(set(host.statuses))[-1] == 0
    assert len([status for status in host.statuses if status]) == 1


def test_a_mode_that_the_driver_never_chooses_is_refused():
    host = Host()
    host.start()
    host.write(0xE0, 0x09)
    host.write(0xC2, 0x01)
    assert host.control(0x40, 0xE0, b"\x00").status < 0

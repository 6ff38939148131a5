"""The emulated UVC camera, seen from its port: what it agrees to, sends, refuses and gets wrong."""

import errno
import struct
from dataclasses import replace

import cv2
import numpy as np
import pytest
from neurotouch_devtools.emulator import Fault
from neurotouch_devtools.emulator.port import Port, UnpluggedError
from neurotouch_devtools.emulator.usb import Setup
from neurotouch_devtools.emulator.uvc import (
    CONTROLS,
    Film,
    Mode,
    PixelFormat,
    UvcCamera,
    UvcConfig,
    UvcIdentity,
)
from neurotouch_devtools.emulator.uvc.filming import film_script

from neurotouch_hid.errors import SourceError
from neurotouch_hid.source.simulator import find_scene

OUT, IN = 0x21, 0xA1
SET_CUR, GET_CUR, GET_INFO = 0x01, 0x81, 0x86
PROBE, COMMIT = 1, 2
AGREED = struct.Struct("<HBBIHHHHHIIIBBBB")
INTERVAL = 80_000
PERIOD_US = INTERVAL // 10
FAULTY, END, PICTURE = 0x40, 2, 1
FILM = Film(np.random.default_rng(1).integers(0, 256, (40, 24, 32)).astype(np.uint8))
MODES = tuple(Mode(pixel_format, 320, 240) for pixel_format in PixelFormat)


class Host:
    """Asks, reads and puts pictures together; ``now_us`` is its clock."""

    def __init__(self, *faults, film=FILM, **config):
        self.now_us = 0
        self.camera = UvcCamera(
            film,
            UvcConfig(**{"identity": UvcIdentity(modes=MODES), **config}),
            [Fault.parse(fault) for fault in faults],
            clock_ns=lambda: 1000 * self.now_us,
        )
        self.port = Port(self.camera, clock_ns=lambda: 1000 * self.now_us)
        self.pictures = []  # (data, faulty, exposure in µs, time of arrival in µs)
        self.ends = []
        self._parts = []
        self._last = None
        self._number = 0

    def request(self, kind, request, selector, index, data=b"", length=64):
        self._number += 1
        setup = Setup(kind, request, selector << 8, index, length or len(data))
        return self.port.control(self._number, setup, data)

    def get(self, name, request=GET_CUR):
        control = CONTROLS[name]
        done = self.request(IN, request, control.selector, control.unit << 8)
        return done.status or control.read(done.data)

    def set(self, name, value):
        control = CONTROLS[name]
        data = control.write(value)
        return self.request(OUT, SET_CUR, control.selector, control.unit << 8, data).status

    def error(self):
        return self.request(IN, GET_CUR, 2, 0).data[0]

    def agree(self, n_format=1, n_size=1, interval=INTERVAL, selector=PROBE):
        wish = AGREED.pack(1, n_format, n_size, interval, *[0] * 12)
        self.request(OUT, SET_CUR, selector, 1, wish)
        return AGREED.unpack(self.request(IN, GET_CUR, PROBE, 1).data)

    def start(self, n_format=1):
        self.agree(n_format, selector=COMMIT)
        for _ in range(5):
            self.queue()
        self.now_us += 200_000  # the port waits until a host has queued its transfers
        self.take()

    def queue(self):
        self._number += 1
        self.port.submit(self._number, 0x81, 32 * 1024)

    def wait(self, n_periods, *, step_us=500):
        for _ in range(n_periods * PERIOD_US // step_us):
            self.now_us += step_us
            self.take()

    def take(self):
        while done := list(self.port.completions()):
            for end in done:
                self.ends.append(end.status)
                if not end.status:
                    self.take_payload(end.data)
                self.queue()

    def take_payload(self, payload):
        size, flags, exposed_us, _, _ = struct.unpack_from("<BBIIH", payload)
        assert size == 12
        if not self._parts:
            assert flags & PICTURE != self._last, "each picture has another number than the last"
        self._last = flags & PICTURE
        self._parts.append(payload[size:])
        if flags & END:
            data = b"".join(self._parts)
            self.pictures.append((data, bool(flags & FAULTY), exposed_us, self.now_us))
            self._parts = []

    def shown(self):
        """Which picture of the film each one is."""
        known = {MODES[0].write(FILM.pictures[k]): k for k in range(len(FILM.pictures))}
        return [known.get(data, -1) for data, *_ in self.pictures]


def watch(*faults, n_periods=12, **config):
    host = Host(*faults, **config)
    host.start()
    host.wait(n_periods)
    return host


def test_every_picture_comes_once_and_in_time():
    host = watch()
    first = host.shown()[0]
    assert host.shown() == [first + k for k in range(12)]
    times = np.diff([arrived for *_, arrived in host.pictures])
    assert set(times) == {PERIOD_US}
    assert set(np.diff([exposed for _, _, exposed, _ in host.pictures])) == {PERIOD_US}
    assert host.camera.n_lost == 0


@pytest.mark.parametrize("pixel_format", PixelFormat)
def test_each_format_has_the_brightness_of_the_film(pixel_format):
    host = Host()
    host.start(1 + list(PixelFormat).index(pixel_format))
    host.wait(2)
    data = np.frombuffer(host.pictures[0][0], np.uint8)
    grey = MODES[0].write(FILM.pictures[0])
    expected = np.frombuffer(grey, np.uint8).reshape(240, 320)
    if pixel_format is PixelFormat.MJPEG:
        decoded = cv2.imdecode(data, cv2.IMREAD_GRAYSCALE)
        assert np.abs(decoded.astype(int) - expected).mean() < 3
        return
    luma = data[::2] if pixel_format is PixelFormat.YUYV else data[: 320 * 240]
    assert (luma == expected.ravel()).all()
    assert len(data) == MODES[list(PixelFormat).index(pixel_format)].max_bytes


def test_a_wish_that_is_not_offered_becomes_the_nearest():
    host = Host(identity=UvcIdentity())
    assert host.agree(2, 3, 170_000)[1:4] == (2, 3, 166_666)
    assert host.agree(9, 9, 1)[1:4] == (4, 3, 80_000)
    assert not host.camera.streaming


def test_the_stream_ends_with_the_request_that_uvcvideo_sends():
    host = watch()
    n = len(host.pictures)
    host.port.control(999, Setup(0x02, 1, 0, 0x81, 0), b"")
    host.wait(5)
    assert len(host.pictures) == n
    assert not host.camera.streaming


def test_a_host_that_does_not_read_loses_the_oldest_pictures():
    host = watch(n_periods=3)
    n = len(host.pictures)
    host.now_us += 10 * PERIOD_US
    host.take()
    host.wait(1)
    shown = host.shown()
    assert host.camera.n_lost == 8
    assert shown[n] == shown[n - 1] + 9
    assert len(shown) == n + 3


def test_settings_are_kept_and_checked():
    host = Host()
    assert host.get("brightness") == 0
    assert host.set("brightness", -20) == 0
    assert host.get("brightness") == -20
    assert host.set("brightness", 65) == -errno.EPIPE
    assert host.error() == 4
    assert host.set("focus", 30) == -errno.EPIPE
    assert host.error() == 2
    assert host.set("autofocus", 0) == 0
    assert host.set("focus", 30) == 0
    assert host.error() == 0


def test_a_setting_that_the_camera_has_not_is_refused():
    host = Host(identity=UvcIdentity(without=frozenset({"gain"})))
    assert host.get("gain") == -errno.EPIPE
    assert host.error() == 6
    assert host.get("brightness") == 0


def test_a_long_exposure_slows_the_camera_down():
    host = Host()
    host.set("auto_exposure", 1)
    host.set("exposure", 3 * PERIOD_US // 100)
    host.start()
    host.wait(12)
    assert set(np.diff([arrived for *_, arrived in host.pictures])) == {3 * PERIOD_US}


def test_dropped_and_doubled_pictures():
    dropped, doubled = watch("dropped+3x2").shown(), watch("doubled+3").shown()
    first = dropped[0]
    assert dropped == [first + k for k in range(12) if k not in (3, 4)]
    assert doubled == [first + (2 if k == 3 else k) for k in range(12)]


def test_a_picture_is_called_faulty():
    host = watch("error+3x2")
    assert [faulty for _, faulty, *_ in host.pictures] == [k in (3, 4) for k in range(12)]


def test_a_picture_is_damaged():
    host = watch("damaged+3")
    assert [k for k, shown in enumerate(host.shown()) if shown < 0] == [3]
    assert len(host.pictures[3][0]) == 320 * 240


def test_a_camera_sends_half_of_what_it_promised():
    host = watch("slow+3x1000")
    times = np.diff([arrived for *_, arrived in host.pictures])
    assert times[:3].tolist() == [PERIOD_US] * 3
    assert set(times[3:]) == {2 * PERIOD_US}


def test_a_camera_stops_sending_for_a_while():
    times = np.diff([arrived for *_, arrived in watch("silence@picture+3", n_periods=24).pictures])
    assert times[2] == 100_000 + 2 * PERIOD_US
    assert set(times[3:]) == {PERIOD_US}


def test_a_camera_is_unplugged_in_the_middle():
    host = Host("unplug@picture+3")
    host.start()
    with pytest.raises(UnpluggedError):
        host.wait(12)
    assert len(host.pictures) == 3


def test_a_transfer_fails():
    host = watch("protocol@stream+3")
    assert host.ends.count(-errno.EPROTO) == 1


@pytest.mark.parametrize("fault", ["odd", "garbage", "silence"])
def test_faults_of_other_cameras_are_refused(fault):
    with pytest.raises(SourceError, match="never happens to a UVC camera"):
        Host(fault)


def test_a_scene_is_filmed():
    script = replace(find_scene("tour"), duration_us=100_000)
    film = film_script(script)
    assert film.pictures.shape == (12, 260, 346)
    assert film.pictures.std() > 10

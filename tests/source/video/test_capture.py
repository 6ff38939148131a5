"""The V4L2 layer on a driver that answers well, and on one that lies."""

import errno
import time
from contextlib import suppress
from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from neurotouch_hid.errors import CameraBusyError, CameraError
from neurotouch_hid.source.camera_errors import CameraGoneError
from neurotouch_hid.source.video import picture_stream, v4l2
from neurotouch_hid.source.video.camera import VideoCamera
from neurotouch_hid.source.video.capture import MAX_SIZES, CaptureDevice
from neurotouch_hid.source.video.config import VideoConfig
from neurotouch_hid.source.video.enumeration import find_video_cameras, select_video_cameras
from neurotouch_hid.source.video.picture_stream import LATE_US, N_BUFFERS
from tests.source.video.fake_camera import NAMES, FakeCamera, FakeLinux

NODE = Path("/dev/video0")


def put(**values):
    """A lie: these fields have these values."""

    def change(answer):
        for name, value in values.items():
            setattr(answer, name, value)

    return change


def open_camera(camera, **config):
    return VideoCamera(NODE, VideoConfig(**config), FakeLinux(camera))


def take(camera, n=1):
    pictures = []
    deadline = time.monotonic() + 30.0
    while len(pictures) < n:
        assert time.monotonic() < deadline
        picture = camera.take(1.0)
        if picture is not None:
            pictures.append((picture.exposure_begin_us, int(picture.pixels[9, 9])))
    return pictures


def play(fake):
    with open_camera(fake) as camera:
        camera.start()
        take(camera)


def test_pictures_come_with_the_stamps_of_the_driver_and_none_is_lost():
    fake = FakeCamera()
    fake.is_asked = True
    with open_camera(fake) as camera:
        camera.start()
        pictures = take(camera, 12)
        sent_us = [1e6 * sent_s for sent_s in fake.sent_s]
        assert (camera.n_lost, camera.n_damaged, camera.n_unstamped) == (0, 0, 0)
        assert camera.mode == ("YUYV", 320, 240, Fraction(1, 125))
    assert [level for _, level in pictures] == list(range(12))
    assert [t_us for t_us, _ in pictures] == pytest.approx(sent_us, abs=2, rel=0)
    assert fake.n_open == 0


def test_the_newest_picture_wins_and_older_ones_count_as_lost():
    fake = FakeCamera()
    fake.is_asked = True
    with open_camera(fake) as camera:
        camera.start()
        assert take(camera)[0][1] == 0
        fake.send(12)  # the first is still in use, so there are buffers for three
        assert take(camera)[0][1] == N_BUFFERS - 1
        assert camera.n_lost == N_BUFFERS - 2
        assert take(camera)[0][1] == 13
        assert camera.n_lost == 12 - 1


def test_an_end_of_exposure_is_not_taken_for_its_start():
    fake = FakeCamera()
    fake.is_asked = True
    fake.flags = v4l2.BUF_FLAG_TIMESTAMP_MONOTONIC
    with open_camera(fake, exposure_us=5_000) as camera:
        camera.start()
        picture = camera.take(1.0)
        assert picture.exposure_end_us == pytest.approx(1e6 * fake.sent_s[0], abs=2, rel=0)
        assert picture.exposure_end_us - picture.exposure_begin_us == 5_000


@pytest.mark.parametrize(
    "lie",
    [
        lambda buffer: setattr(buffer, "flags", 0),
        lambda buffer: setattr(buffer.timestamp, "seconds", 0),
        lambda buffer: setattr(buffer.timestamp, "seconds", 1 << 40),
        lambda buffer: setattr(
            buffer.timestamp, "seconds", buffer.timestamp.seconds - 2 * LATE_US // 1_000_000
        ),
    ],
)
def test_without_a_usable_stamp_the_time_of_arrival_counts(lie):
    fake = FakeCamera()
    fake.lies[v4l2.DQBUF] = lie
    with open_camera(fake, exposure_us=1_000) as camera:
        camera.start()
        before_us = time.monotonic_ns() // 1000
        pictures = take(camera, 5)
        after_us = time.monotonic_ns() // 1000
        assert camera.n_unstamped == 5
    stamps = [before_us - 1_000, *(t_us for t_us, _ in pictures), after_us]
    assert stamps == sorted(stamps)


@pytest.mark.parametrize("jump_us", [-10_000_000, -200_000, 300_000, 10_000_000])
def test_after_a_stamp_that_jumps_the_stamps_of_the_driver_count_again(monkeypatch, jump_us):
    fake = FakeCamera()
    fake.is_asked = True
    true_us = []

    def lie(buffer):
        """A picture each 8 ms; it comes 40 ms after its stamp."""
        true_us.append(10_000_000 + 8_000 * buffer.sequence)
        t_us = true_us[-1] + jump_us * (buffer.sequence == 4)
        buffer.timestamp.seconds, buffer.timestamp.microseconds = divmod(t_us, 1_000_000)

    clock = SimpleNamespace(monotonic_ns=lambda: 1_000 * (true_us[-1] + 40_000))
    monkeypatch.setattr(picture_stream, "time", clock)
    fake.lies[v4l2.DQBUF] = lie
    with open_camera(fake) as camera:
        camera.start()
        assert [t_us for t_us, _ in take(camera, 12)] == true_us
        assert camera.n_unstamped == 1


@pytest.mark.parametrize(
    ("number", "lie", "words"),
    [
        (v4l2.S_FMT, lambda a: put(width=0)(a.pix), "0x240"),
        (v4l2.S_FMT, lambda a: put(height=1 << 30)(a.pix), "makes no sense"),
        (v4l2.S_FMT, lambda a: put(pixelformat=0x41424344)(a.pix), "DCBA, which cannot be read"),
        (v4l2.S_FMT, lambda a: put(sizeimage=0xFFFFFFFF)(a.pix), "4294967295 bytes"),
        (v4l2.S_FMT, lambda a: put(bytesperline=0xFFFFFFFF)(a.pix), "makes no sense"),
        (v4l2.REQBUFS, put(count=0), "0 buffers"),
        (v4l2.REQBUFS, put(count=1 << 20), "1048576 buffers"),
        (v4l2.QUERYBUF, put(length=0), "a buffer of 0 bytes"),
        (v4l2.QUERYBUF, put(length=0xFFFFFFFF), "a buffer of 4294967295 bytes"),
        (v4l2.DQBUF, put(index=77), "buffer 77 of 4"),
        (v4l2.ENUM_FMT, put(pixelformat=0), "no pictures that can be read"),
        (v4l2.ENUM_FRAMESIZES, lambda a: a.size.__setitem__(0, 0), "no pictures that can be read"),
    ],
)
def test_an_answer_that_makes_no_sense_is_refused_in_a_sentence(number, lie, words):
    fake = FakeCamera()
    fake.lies[number] = lie
    with pytest.raises(CameraError, match=words):
        play(fake)
    assert fake.n_open == 0


@pytest.mark.parametrize("seed", range(20))
def test_whatever_a_driver_answers_ends_in_pictures_or_in_a_sentence(seed):
    """Words of some answers are replaced by others: often small ones, which are nearly right."""
    rng = np.random.default_rng(seed)

    def lie(answer):
        words = np.frombuffer(answer, np.uint32)
        if len(words) and rng.random() < 0.3:
            most = (4, 1 << 12, 1 << 32)[rng.integers(3)]
            words[rng.integers(len(words))] = rng.integers(most)

    fake = FakeCamera(formats={"YUYV": {(640, 480): (60,)}, "MJPG": {(1280, 720): (60,)}})
    fake.is_asked = True
    fake.lies = dict.fromkeys(NAMES, lie)
    for _ in range(5):
        with suppress(CameraError), open_camera(fake) as camera:
            camera.start()
            for _ in range(10):
                picture = camera.take(0.01)
                assert picture is None or picture.pixels.ndim == 2
        assert fake.n_open == 0
        fake.stop()


def test_a_camera_that_never_ends_its_list_is_asked_a_bounded_number_of_times():
    fake = FakeCamera()
    asked = []
    fake._enum_framesizes = lambda a: (asked.append(a.index), a.size.__setitem__(0, 640))
    fake.lies[v4l2.ENUM_FRAMESIZES] = lambda a: (put(type=1)(a), a.size.__setitem__(1, 480))
    with CaptureDevice(NODE, FakeLinux(fake)) as device:
        assert device.list_sizes("YUYV") == [(640, 480)]
    assert len(asked) == MAX_SIZES


@pytest.mark.parametrize("n_bytes", [0, 100, 320 * 240 * 2 - 1])
def test_a_picture_with_too_few_bytes_is_damaged(n_bytes):
    fake = FakeCamera()
    fake.lies[v4l2.DQBUF] = put(bytesused=n_bytes)
    with open_camera(fake) as camera:
        camera.start()
        assert [camera.take(1.0) for _ in range(3)] == [None] * 3
        assert camera.n_damaged == 3


def test_a_picture_with_more_bytes_than_its_buffer_is_damaged():
    fake = FakeCamera()
    fake.lies[v4l2.DQBUF] = put(bytesused=0xFFFFFFFF)
    with open_camera(fake) as camera:
        camera.start()
        assert camera.take(1.0) is None
        assert camera.n_damaged == 1


def test_a_counter_that_does_not_count_or_starts_again_loses_nothing():
    for sequence in (0, 0xFFFFFFFF):
        fake = FakeCamera()
        fake.lies[v4l2.DQBUF] = put(sequence=sequence)
        with open_camera(fake) as camera:
            camera.start()
            take(camera, 4)
            assert camera.n_lost <= 3 * N_BUFFERS


def test_after_an_error_on_the_wire_only_the_lost_picture_counts():
    fake = FakeCamera()
    fake.is_asked = True
    with open_camera(fake) as camera:
        camera.start()
        take(camera, 4)
        fake.fail()
        assert camera.take(1.0) is None
        (_, level), *_ = take(camera, 5)
        assert level == 5
        assert (camera.n_lost, camera.n_damaged, camera.n_unstamped) == (1, 0, 0)


def test_a_picture_that_the_driver_marks_as_damaged_is_none():
    fake = FakeCamera()
    fake.is_asked = True
    fake.flags |= v4l2.BUF_FLAG_ERROR
    with open_camera(fake) as camera:
        camera.start()
        assert camera.take(1.0) is None
        assert (camera.n_lost, camera.n_damaged) == (0, 1)


def test_an_unplugged_camera_is_gone_and_another_program_is_named_as_the_reason():
    fake = FakeCamera()
    linux = FakeLinux(fake)
    with VideoCamera(NODE, VideoConfig(), linux) as camera:
        camera.start()
        camera.take(1.0)
        linux.unplug(0)
        with pytest.raises(CameraGoneError):
            camera.take(1.0)
    assert fake.n_open == 0
    with pytest.raises(CameraGoneError, match="not plugged in"):
        VideoCamera(NODE, VideoConfig(), linux)
    linux.cameras[0] = fake
    fake.in_use = True
    with pytest.raises(CameraBusyError, match="in use by another program") as caught:
        VideoCamera(NODE, VideoConfig(), linux)
    assert caught.value.exit_code == 75


def test_an_error_of_the_driver_is_told_by_name():
    fake = FakeCamera()

    def fail(_):
        raise OSError(errno.EIO, "Input/output error")

    with open_camera(fake) as camera:
        camera.start()
        fake.lies[v4l2.DQBUF] = fail
        with pytest.raises(CameraError, match=r"cannot be read: Input/output error"):
            take(camera)


def test_cameras_are_listed_without_nodes_that_are_none_and_found_by_name():
    webcam = FakeCamera("Front Camera", "usb-0000:00:14.0-7")
    other = FakeCamera("USB 2.0 Camera\n", "usb-0000:00:14.0-2")
    metadata = FakeCamera("Front Camera", "usb-0000:00:14.0-7")
    metadata.capabilities = v4l2.CAP_STREAMING
    linux = FakeLinux(webcam, metadata, other)
    cameras = find_video_cameras(linux)
    assert [(str(info.node), info.bus_info) for info in cameras] == [
        ("/dev/video0", "usb-0000:00:14.0-7"),
        ("/dev/video2", "usb-0000:00:14.0-2"),
    ]
    assert cameras[1].name.isprintable()

    def find(name):
        return [str(info.node) for info in select_video_cameras(cameras, name)]

    assert find("") == ["/dev/video0", "/dev/video2"]
    assert find("front") == ["/dev/video0"]
    assert find("usb-0000:00:14.0-2") == ["/dev/video2"]
    assert find("/dev/video2") == ["/dev/video2"]
    for name in ("/dev/video1", "Rear", "usb-0000:00:14.0"):
        with pytest.raises(CameraError, match="No video camera is called") as caught:
            select_video_cameras(cameras, name)
        assert "/dev/video0 (Front Camera), /dev/video2" in caught.value.hint
    with pytest.raises(CameraError, match="No video camera is plugged in"):
        select_video_cameras((), "")

"""A video camera as a source: slices, faults, the way back; which of several shows a gel."""

import logging
import threading
import time
from itertools import islice, pairwise

import numpy as np
import pytest

from neurotouch_hid.driver.source_opening import describe_source
from neurotouch_hid.errors import CameraError
from neurotouch_hid.source import (
    Periodic,
    PictureSource,
    PolledSource,
    Troubled,
    open_source,
)
from neurotouch_hid.source.camera_config import CameraConfig
from neurotouch_hid.source.video import v4l2
from neurotouch_hid.source.video.config import VideoConfig
from neurotouch_hid.source.video.live import VideoCameraSource
from neurotouch_hid.tracker import GelFinder
from tests.source.taking import take, take_until
from tests.source.video.fake_camera import FakeCamera, FakeLinux
from tests.source.video.gel_pictures import draw_gel, middle_rig

FAST = {"YUYV": {(320, 240): (100,)}}
GEL = draw_gel(middle_rig((640, 480), 5.0), (640, 480))


@pytest.fixture(autouse=True)
def no_waiting(monkeypatch):
    monkeypatch.setattr("neurotouch_hid.source.camera_source.RETRY_S", 0.02)


def open_video(linux, *args, **options):
    return VideoCameraSource(*args, linux=linux, **options)


def assert_sound(packets):
    for packet in packets:
        assert len(packet.events) == 0
        for frame in packet.frames:
            assert packet.t_begin_us <= frame.exposure_end_us < packet.t_end_us
    for before, after in pairwise(packets):
        assert after.t_begin_us >= before.t_end_us
        assert after.gap or after.t_begin_us == before.t_end_us


def test_each_picture_is_a_frame_of_one_of_the_slices():
    fake = FakeCamera(formats=FAST)
    with open_video(FakeLinux(fake)) as source:
        for protocol in (PolledSource, Periodic, Troubled):
            assert isinstance(source, protocol)
        assert source.name == "video:usb-0000:00:14.0-2"
        packets = take(source, 30)
        stats = source.stats()
    assert_sound(packets)
    assert {packet.t_end_us - packet.t_begin_us for packet in packets} == {10_000}
    levels = [int(frame.pixels[130, 173]) for packet in packets for frame in packet.frames]
    assert levels == sorted(set(levels))
    assert len(levels) + stats.n_lost >= 25
    assert packets[0].t_begin_us == 0
    assert (stats.n_connects, stats.n_damaged, stats.trouble) == (1, 0, "")
    assert source.n_lost == stats.n_lost
    words = f", pictures lost: {stats.n_lost}" if stats.n_lost else ""
    assert describe_source(source) == f"{source.name}{words}"
    assert 0.005 < source.period_s < 0.05
    assert fake.n_open == 0


def test_frames_keep_the_stamps_of_the_driver_also_within_a_slice():
    fake = FakeCamera(formats={"YUYV": {(320, 240): (100,)}})
    fake.is_asked = True
    with open_video(FakeLinux(fake), slice_us=50_000) as source:
        packets = take(source, 3)
    ends_us = [frame.exposure_end_us for packet in packets for frame in packet.frames]
    sent_us = [round(1e6 * (sent_s - fake.sent_s[0])) for sent_s in fake.sent_s[: len(ends_us)]]
    assert len(ends_us) > 5
    assert ends_us == pytest.approx(sent_us, abs=2, rel=0)


def test_a_camera_that_is_back_is_the_same_one_at_its_place_or_by_its_name(caplog):
    fake, other = FakeCamera(formats=FAST), FakeCamera("Other", "usb-0000:00:14.0-9", FAST)
    linux = FakeLinux(fake)
    with open_video(linux) as source:
        first = take(source, 3)
        linux.unplug(0)
        linux.cameras[1] = other
        take_until(source, lambda _: source.trouble)
        assert source.trouble.endswith("is not plugged in.")
        time.sleep(0.1)
        assert other.n_mapped == 0
        fake.bus_info = "usb-0000:00:14.0-3"
        linux.cameras[2] = fake
        after = take_until(source, lambda _: source.stats().n_connects == 2 and not source.trouble)
        after += take(source, 3)
        assert source.stats().info.bus_info == "usb-0000:00:14.0-3"
    new = [packet for packet in after if packet.gap]
    assert len(new) >= 1
    assert_sound([*first[-1:], *new[:1]])
    assert new[0].t_begin_us > first[-1].t_end_us
    assert "is not plugged in. The gamepad works again as soon as the camera does." in caplog.text
    assert "The camera usb-0000:00:14.0-3 plays." in caplog.text


def test_another_camera_of_the_same_model_never_takes_its_place():
    ours, twin = FakeCamera("Rig", "usb-2", FAST), FakeCamera("Rig", "usb-3", FAST)
    linux = FakeLinux(ours, twin)
    with open_video(linux, "usb-2") as source:
        take(source, 2)
        linux.unplug(0)
        take_until(source, lambda _: source.trouble)
        time.sleep(0.1)
        assert source.trouble == "The camera Rig is not plugged in."
        assert twin.n_mapped == 0
        ours.bus_info = "usb-4"
        linux.cameras[0] = ours
        take_until(source, lambda _: not source.trouble)
        assert source.stats().info.bus_info == "usb-4"


def test_a_camera_that_stops_is_started_again(monkeypatch):
    monkeypatch.setattr("neurotouch_hid.source.video.live.SILENCE_S", 0.1)
    fake = FakeCamera(formats=FAST)
    with open_video(FakeLinux(fake)) as source:
        take(source, 3)
        fake.is_silent = True
        take_until(source, lambda _: source.trouble)
        assert source.trouble == "The camera UVC Camera sends no pictures."
        fake.is_silent = False
        take_until(source, lambda _: not source.trouble)
        take(source, 3)
        assert source.stats().n_connects >= 2


def test_a_camera_that_sends_only_damaged_pictures_says_so(monkeypatch):
    monkeypatch.setattr("neurotouch_hid.source.video.live.SILENCE_S", 0.1)
    fake = FakeCamera(formats={"MJPG": {(640, 480): (100,)}})
    with open_video(FakeLinux(fake)) as source:
        take(source, 3)
        fake.encode = lambda _: b"\xff\xd8 nothing \xff\xd9"
        take_until(source, lambda _: source.trouble)
        assert source.trouble == "The camera UVC Camera sends only damaged pictures."
        assert source.stats().n_damaged > 0
        assert source.n_lost >= source.stats().n_damaged


@pytest.mark.parametrize("n_bytes", [0, 100, 0xFFFFFFFF])
@pytest.mark.parametrize("flag", [0, v4l2.BUF_FLAG_ERROR])
def test_play_goes_on_after_many_bad_buffers_in_a_row(n_bytes, flag):
    fake = FakeCamera(formats=FAST)

    def spoil(buffer):
        if 4 < fake.n_sent <= 24:
            buffer.bytesused, buffer.flags = n_bytes, buffer.flags | flag

    fake.lies[v4l2.DQBUF] = spoil
    with open_video(FakeLinux(fake)) as source:
        packets = take(source, 3) + take_until(source, lambda _: fake.n_sent > 40)
        assert (source.stats().n_connects, source.trouble) == (1, "")
        assert source.n_lost
    assert_sound(packets)
    levels = [frame.pixels[130, 173] for packet in packets for frame in packet.frames]
    assert max(levels) >= 24


def test_a_camera_that_lies_about_its_rate_is_told_once_and_its_true_period_counts(
    monkeypatch, caplog
):
    monkeypatch.setattr("neurotouch_hid.source.video.live._RATE_PICTURES", 5)
    fake = FakeCamera(formats={"YUYV": {(320, 240): (125,)}})
    fake.fps = 20
    with open_video(FakeLinux(fake)) as source:
        take_until(source, lambda _: "pictures/s instead of 125" in caplog.text)
        take_until(source, lambda _: source.period_s > 0.04)
    assert caplog.text.count("instead of 125") == 1


def test_what_a_camera_lacks_is_told_once(caplog):
    fake = FakeCamera(formats=FAST, controls={})
    linux = FakeLinux(fake)
    with open_video(linux) as source:
        take(source, 1)
        linux.unplug(0)
        take_until(source, lambda _: source.trouble)
        linux.cameras[0] = fake
        take_until(source, lambda _: source.stats().n_connects == 2)
    assert caplog.text.count("no fixed exposure") == 1
    assert len(source.stats().lacking) == 6


def test_of_several_cameras_the_only_one_that_shows_a_gel_is_taken(caplog):
    caplog.set_level(logging.INFO)
    room, shows = FakeCamera("Front", "usb-7", FAST), FakeCamera("Rig", "usb-2", FAST)
    shows.draw = lambda _: GEL
    linux = FakeLinux(room, shows)
    with open_video(linux, finder=GelFinder()) as source:
        assert source.name == "video:usb-2"
    assert "The camera /dev/video1 (Rig) shows the gel." in caplog.text
    assert room.n_open == shows.n_open == 0
    room.draw = shows.draw
    with pytest.raises(
        CameraError, match=r"Several cameras show a gel: /dev/video0 \(Front\), /dev"
    ):
        open_video(linux, finder=GelFinder())
    with open_video(linux, "front", finder=GelFinder()) as source:
        assert source.name == "video:usb-7"


def test_none_of_several_shows_a_gel(monkeypatch):
    monkeypatch.setattr("neurotouch_hid.source.video.live.SEARCH_S", 0.1)
    linux = FakeLinux(FakeCamera("Front", "usb-7", FAST), FakeCamera("Rig", "usb-2", FAST))
    with pytest.raises(CameraError, match="None of 2 cameras shows a gel") as caught:
        open_video(linux, finder=GelFinder())
    assert caught.value.hint == "Choose one, for example: --source video:/dev/video0"


def test_a_camera_need_not_be_there_yet():
    linux = FakeLinux()
    with open_video(linux, "Rig", wait=True) as source:
        assert source.name == "video:Rig"
        take_until(source, lambda _: source.trouble)
        assert source.trouble == "No video camera is plugged in."
        linux.cameras[4] = FakeCamera("My Rig", "usb-2", FAST)
        take(source, 2)
        assert source.stats().info.name == "My Rig"
        assert source.name == "video:usb-2"


def test_settings_reach_the_camera():
    fake = FakeCamera(formats={"YUYV": {(320, 240): (100,), (640, 480): (50,)}})
    config = VideoConfig(width=640, exposure_us=2_000, mirrored=True)
    fake.draw = lambda _: np.tile(np.linspace(0, 255, 640), (480, 1)).astype(np.uint8)
    with open_video(FakeLinux(fake), config=config) as source:
        (packet, *_) = take(source, 1)
        assert source.stats().mode[:3] == ("YUYV", 640, 480)
    assert fake.controls[v4l2.CID_EXPOSURE_ABSOLUTE] == 20
    (frame,) = packet.frames
    assert frame.exposure_end_us - frame.exposure_begin_us == 2_000
    assert frame.pixels[130, 20] > 200
    assert frame.pixels[130, 320] < 50


def test_closing_ends_a_waiting_iteration():
    fake = FakeCamera(formats=FAST)
    fake.is_silent = True
    source = open_video(FakeLinux(fake))
    closing = threading.Timer(0.1, source.close)
    closing.start()
    assert list(source) == []
    closing.join()
    assert fake.n_open == 0


def test_the_name_opens_it(monkeypatch):
    linux = FakeLinux(FakeCamera(formats=FAST))
    monkeypatch.setattr("neurotouch_hid.source.video.live.Linux", lambda: linux)
    config = CameraConfig(video=VideoConfig(exposure_us=3_000))
    with open_source("video:uvc", camera=config, slice_us=5_000) as source:
        (packet, *_) = take(source, 1)
    assert packet.t_end_us - packet.t_begin_us == 5_000
    assert linux.cameras[0].controls[v4l2.CID_EXPOSURE_ABSOLUTE] == 30


@pytest.mark.parametrize("fourcc", ["YUYV", "MJPG"])
def test_pictures_come_as_they_are_for_a_recorder(fourcc):
    fake = FakeCamera(formats={fourcc: {(640, 480): (50,)}})
    with open_video(FakeLinux(fake), finder=GelFinder()) as source:
        assert isinstance(source, PictureSource)
        pictures = list(islice(source.pictures(), 5))
    assert [picture.pixels.shape for picture in pictures] == [(480, 640)] * 5
    levels = [int(picture.pixels[9, 9]) for picture in pictures]
    assert levels == sorted(set(levels))
    ends_us = [picture.exposure_end_us for picture in pictures]
    assert ends_us == sorted(set(ends_us))
    assert ends_us[0] == 0
    assert all((picture.jpeg is not None) is (fourcc == "MJPG") for picture in pictures)

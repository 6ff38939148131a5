"""What the doctor says of a video camera."""

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest

from neurotouch_hid.doctor import video
from neurotouch_hid.doctor.finding import CheckStatus
from neurotouch_hid.doctor.gel import GelView
from neurotouch_hid.geometry import make_gel, place_square
from neurotouch_hid.source.simulator import Simulator, find_scene, uvc
from neurotouch_hid.source.video.enumeration import VideoInfo
from neurotouch_hid.source.video.live import VideoStats
from neurotouch_hid.source.video.modes import Mode
from tests.source.video.fake_camera import FakeCamera, FakeLinux
from tests.source.video.gel_pictures import draw_gel, middle_rig

INFO = VideoInfo(Path("/dev/video2"), "Rig", "usb-0000:00:14.0-2", "uvcvideo")
GOOD = VideoStats(
    info=INFO,
    mode=Mode("MJPG", 640, 480, Fraction(1, 60)),
    exposure_us=10_000,
    lacking=(),
    fps=59.6,
    n_connects=1,
    n_pictures=100,
    n_lost=0,
    n_damaged=0,
    n_unstamped=0,
    latency_us=3_200.0,
    trouble="",
)


def test_a_good_camera_is_described_by_its_figures():
    finding = video.judge_pictures("video:x", GOOD)
    assert finding.status is CheckStatus.OK
    assert finding.sentence == (
        "video:x: 640x480 MJPG, 60 of 60 pictures/s; exposure 10 ms, which blurs 2.5 px at "
        "100 mm/s; from its stamp to the driver 3.2 ms; 0 pictures lost, 0 damaged, 100 read."
    )


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"fps": 30.0}, "30 of 60 pictures/s"),
        ({"n_lost": 7}, "7 pictures lost"),
        ({"n_damaged": 6}, "6 damaged"),
        ({"exposure_us": 20_000}, "blurs 5.0 px"),
        ({"exposure_us": None, "lacking": ("It has no fixed exposure.",)}, "no fixed exposure"),
    ],
)
def test_each_fault_is_a_warning_with_a_fix(change, words):
    finding = video.judge_pictures("video:x", replace(GOOD, **change))
    assert finding.status is CheckStatus.WARNING
    assert words in finding.sentence
    assert finding.fix


def test_the_blur_is_that_of_the_gel_before_the_camera():
    small = make_gel("small", place_square(2.0, 15.0), radius_mm=15.0, pitch_mm=2.0, dot_mm=0.5)
    finding = video.judge_pictures("video:x", GOOD, small)
    assert finding.status is CheckStatus.WARNING
    assert "which blurs 5.0 px at 100 mm/s" in finding.sentence


def test_a_camera_without_pictures_has_failed():
    silent = replace(GOOD, fps=0.0, trouble="The camera Rig sends no pictures.")
    finding = video.judge_pictures("video:x", silent)
    assert finding.status is CheckStatus.FAILED
    assert "The camera Rig sends no pictures." in finding.sentence


@pytest.mark.parametrize(
    ("cameras", "status", "words"),
    [
        ((), CheckStatus.SKIPPED, "No video camera"),
        ((INFO,), CheckStatus.OK, "neurotouch doctor --source video:usb-0000:00:14.0-2"),
        ((replace(INFO, reason="no right"),), CheckStatus.WARNING, "cannot be used: no right"),
    ],
)
def test_the_cameras_are_listed(monkeypatch, cameras, status, words):
    monkeypatch.setattr(video, "find_video_cameras", lambda: cameras)
    finding = video.check_video_cameras()
    assert finding.status is status
    assert words in finding.sentence


def test_the_gel_before_a_video_camera_is_examined(monkeypatch, tmp_path):
    fake = FakeCamera(formats={"YUYV": {(640, 480): (30,)}})
    gel = draw_gel(middle_rig((640, 480), 5.0), (640, 480))
    fake.draw = lambda k: gel if k % 2 else gel - (gel > 99)  # no two pictures are the same
    linux = FakeLinux(fake)
    monkeypatch.setattr("neurotouch_hid.source.video.live.Linux", lambda: linux)
    monkeypatch.setattr("neurotouch_hid.doctor.gel.LOOK_S", 2.0)
    view = GelView(tmp_path / "gel.png", "video:")
    stream, markers, rest = view.check_stream(), view.check_markers(), view.check_rest()
    assert "640x480 YUYV" in stream.sentence
    assert "exposure 10 ms, which blurs 2.5 px" in stream.sentence
    assert "177 of 177 markers" in markers.sentence
    assert rest.status is CheckStatus.OK
    assert fake.n_open == 0


def test_an_overexposed_picture_is_called_too_bright_not_out_of_focus(monkeypatch, tmp_path):
    fake = FakeCamera(formats={"YUYV": {(640, 480): (30,)}})
    light = uvc.enlarge(take_picture({"overexposed": 14.0}))
    fake.draw = lambda k: light if k % 2 else light - (light > 200)  # no two are the same
    linux = FakeLinux(fake)
    monkeypatch.setattr("neurotouch_hid.source.video.live.Linux", lambda: linux)
    monkeypatch.setattr("neurotouch_hid.doctor.gel.LOOK_S", 2.0)
    markers = GelView(tmp_path / "gel.png", "video:").check_markers()
    assert markers.status is CheckStatus.WARNING
    assert "The gel is found: the picture is too bright." in markers.sentence
    assert "exposure_us" in markers.fix


def take_picture(nuisances):
    """Returns a simulated picture of the gel, (260, 346) uint8."""
    with Simulator(find_scene("rest"), nuisances={"uvc": 60.0} | nuisances, seed=3) as simulator:
        return next(packet.frames[0].pixels for packet in simulator if packet.frames)

"""Which pictures are chosen, and what is fixed of a camera."""

from pathlib import Path

import pytest

from neurotouch_hid.errors import CameraError
from neurotouch_hid.source.video import v4l2
from neurotouch_hid.source.video.capture import CaptureDevice
from neurotouch_hid.source.video.config import VideoConfig
from neurotouch_hid.source.video.controls import choose_exposure, fix_controls, is_flicker_free
from neurotouch_hid.source.video.modes import choose_mode, list_modes
from tests.source.video.fake_camera import UVC_CONTROLS, FakeCamera, FakeLinux

WEBCAM = {
    "YUYV": {(160, 120): (120,), (640, 480): (30, 15), (1280, 720): (10,)},
    "MJPG": {(640, 480): (60, 30), (1280, 720): (60, 30), (1920, 1080): (60, 30)},
    "H264": {(1920, 1080): (120,)},
}


def open_device(**options):
    return CaptureDevice(Path("/dev/video0"), FakeLinux(FakeCamera(**options)))


def choose(formats=WEBCAM, **config):
    with open_device(formats=formats) as device:
        mode = choose_mode(list_modes(device), VideoConfig(**config))
    return mode.fourcc, mode.width, mode.height, mode.fps


def test_the_most_pictures_a_second_win_then_pixels_then_no_compression():
    assert choose() == ("MJPG", 1280, 720, 60)
    assert choose({**WEBCAM, "GREY": {(1280, 720): (60,)}}) == ("GREY", 1280, 720, 60)
    assert choose({"MJPG": {(640, 480): (60,)}, "YUYV": {(320, 240): (61,)}})[0] == "YUYV"
    assert choose({"GREY": {(1920, 1080): (60,), (1600, 1200): (60,)}})[1] == 1600


@pytest.mark.parametrize(
    ("config", "found"),
    [
        ({"format": "YUYV"}, ("YUYV", 640, 480, 30)),
        ({"width": 640, "height": 480}, ("MJPG", 640, 480, 60)),
        ({"fps": 30}, ("MJPG", 1280, 720, 30)),
        ({"fps": 15}, ("YUYV", 640, 480, 15)),
        ({"width": 1920}, ("MJPG", 1920, 1080, 60)),
    ],
)
def test_settings_choose_among_the_modes(config, found):
    assert choose(**config) == found


def test_what_no_camera_offers_is_refused_with_what_it_offers():
    with pytest.raises(CameraError, match=r"camera\.yaml") as caught:
        choose(width=333)
    assert "640x480 YUYV" in caught.value.hint
    with pytest.raises(CameraError, match="320 px wide"):
        choose({"YUYV": {(160, 120): (120,)}, "H264": {(640, 480): (60,)}})


def test_a_camera_without_stated_rates_can_be_used():
    assert choose({"YUYV": {(640, 480): ()}}) == ("YUYV", 640, 480, 30)


@pytest.mark.parametrize(
    ("mains_hz", "fps", "exposure_us"),
    [
        (50, 30, 10_000),
        (60, 30, 8_333),
        (50, 60, 10_000),
        (50, 125, 4_000),
        (60, 110, 4_000),
    ],
)
def test_lamps_do_not_flicker_where_the_rate_allows_it(mains_hz, fps, exposure_us):
    chosen = choose_exposure(VideoConfig(mains_hz=mains_hz), 1e6 / fps)
    assert chosen == exposure_us
    assert is_flicker_free(chosen, mains_hz) is (exposure_us > 5_000)


def test_exposures_that_are_asked_for_are_taken():
    assert choose_exposure(VideoConfig(exposure_us=700), 8_000) == 700
    assert choose_exposure(VideoConfig(mains_hz=0), 33_333) == 4_000
    assert choose_exposure(VideoConfig(mains_hz=0), 2_000) == 1_800


def fix(config=None, **options):
    fake = FakeCamera(**options)
    with CaptureDevice(Path("/dev/video0"), FakeLinux(fake)) as device:
        return fix_controls(device, config or VideoConfig(), 33_333), fake.controls


def test_everything_that_changes_by_itself_is_fixed():
    fixed, controls = fix()
    assert fixed.lacking == ()
    assert fixed.exposure_us == 10_000
    assert controls == {
        v4l2.CID_EXPOSURE_AUTO: v4l2.EXPOSURE_MANUAL,
        v4l2.CID_EXPOSURE_AUTO_PRIORITY: 0,
        v4l2.CID_EXPOSURE_ABSOLUTE: 100,
        v4l2.CID_GAIN: 20,
        v4l2.CID_AUTO_WHITE_BALANCE: 0,
        v4l2.CID_POWER_LINE_FREQUENCY: 1,
        v4l2.CID_FOCUS_AUTO: 0,
    }
    fixed, controls = fix(VideoConfig(exposure_us=3_000, gain=5_000, mains_hz=60))
    assert (fixed.exposure_us, controls[v4l2.CID_GAIN]) == (3_000, 100)
    assert controls[v4l2.CID_POWER_LINE_FREQUENCY] == 2


@pytest.mark.parametrize(
    ("control", "words"),
    [
        (v4l2.CID_EXPOSURE_ABSOLUTE, "no fixed exposure"),
        (v4l2.CID_GAIN, "gain cannot be fixed"),
        (v4l2.CID_AUTO_WHITE_BALANCE, "white balance cannot be fixed"),
        (v4l2.CID_FOCUS_AUTO, "focus has no control"),
    ],
)
def test_each_control_that_is_missing_has_a_sentence(control, words):
    left = {each: values for each, values in UVC_CONTROLS.items() if each != control}
    fixed, _ = fix(controls=left)
    (sentence,) = fixed.lacking
    assert words in sentence


def test_a_camera_without_any_control_has_all_sentences_and_no_exposure():
    fixed, _ = fix(controls={})
    assert len(fixed.lacking) == 6
    assert fixed.exposure_us is None
    left = {
        each: values
        for each, values in UVC_CONTROLS.items()
        if each != v4l2.CID_POWER_LINE_FREQUENCY
    }
    assert fix(controls=left)[0].lacking == ()  # the exposure is enough
    (sentence,) = fix(VideoConfig(exposure_us=3_000), controls=left)[0].lacking
    assert "flicker" in sentence


def test_an_exposure_in_a_unit_of_its_own_is_fixed_all_the_same():
    """As a PS3 Eye has it."""
    left = {
        each: values
        for each, values in UVC_CONTROLS.items()
        if each not in (v4l2.CID_EXPOSURE_ABSOLUTE, v4l2.CID_EXPOSURE_AUTO_PRIORITY)
    }
    own = left | {v4l2.CID_EXPOSURE: (0, 255, 1, 120)}
    fixed, controls = fix(controls=own)
    (sentence,) = fixed.lacking
    assert "fixed at 120 in the camera's own unit" in sentence
    assert fixed.exposure_us is None
    assert controls[v4l2.CID_EXPOSURE_AUTO] == v4l2.EXPOSURE_MANUAL
    automatic = own | {v4l2.CID_EXPOSURE_AUTO: (0, 0, 1, 0)}
    assert "no fixed exposure" in fix(controls=automatic)[0].lacking[0]


def test_an_exposure_that_the_camera_changes_is_told():
    coarse = UVC_CONTROLS | {v4l2.CID_EXPOSURE_ABSOLUTE: (50, 5000, 1, 157)}
    fixed, _ = fix(VideoConfig(exposure_us=1_000), controls=coarse)
    assert fixed.exposure_us == 5_000
    assert "exposes for 5000 µs, not the 1000 µs" in fixed.lacking[0]

"""The file that sets up the camera."""

import pytest

from neurotouch_hid.driver.camera_settings import (
    CameraSettings,
    find_camera_file,
    load_camera_config,
)
from neurotouch_hid.errors import ProfileError
from neurotouch_hid.source.camera_config import CameraConfig
from neurotouch_hid.source.davis import Biases, DavisConfig
from neurotouch_hid.source.davis.registers import CoarseFine
from neurotouch_hid.source.events.config import EventsConfig
from neurotouch_hid.source.strobe.config import StrobeConfig
from neurotouch_hid.source.video.config import VideoConfig


@pytest.fixture
def file(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    path = find_camera_file()
    path.parent.mkdir(parents=True)
    return path


def test_without_a_file_the_shipped_values_hold(file):
    assert load_camera_config() == CameraConfig(DavisConfig(), VideoConfig())


def test_every_key_reaches_the_driver(file):
    file.write_text(
        "version: 1\nexposure_us: 8000\nframe_interval_us: 20000\nactivity_filter_us: 0\n"
        "early_packet_delay_us: 1000\nmirrored: true\nhot_pixels: [[3, 4], [345, 259]]\n"
        "biases:\n  OnBn: [6, 7]\n"
    )
    assert load_camera_config().davis == DavisConfig(
        exposure_us=8000,
        frame_interval_us=20_000,
        activity_filter_us=0,
        early_packet_delay_us=1000,
        mirrored=True,
        hot_pixels=((3, 4), (345, 259)),
        biases=Biases(OnBn=CoarseFine(6, 7)),
    )


def test_every_key_of_a_video_camera_reaches_the_driver(file):
    file.write_text(
        "version: 1\nmirrored: true\nvideo:\n  width: 640\n  height: 480\n  fps: 60\n"
        "  format: MJPG\n  exposure_us: 5000\n  gain: 12\n  mains_hz: 60\n"
    )
    assert load_camera_config().video == VideoConfig(640, 480, 60.0, "MJPG", 5000, 12, 60, True)


@pytest.mark.parametrize(
    ("text", "place", "words"),
    [
        ("exposure_us: 0", ":1:14", "10"),
        ("exposure: 4000", ":1:1", "exposure_us"),
        ("biases:\n  OnBn: [8, 0]", ":2:3", "coarse 0 to 7"),
        ("biases:\n  onbn: [5, 0]", ":2:3", "biases.onbn"),
        ("mirrored: 1", ":1:11", "true or false"),
        ("video:\n  width: 100", ":2:10", "320"),
        ("video:\n  format: RGB3", ":2:11", "YUYV"),
        ("video:\n  mains_hz: 55", ":2:13", "60"),
    ],
)
def test_mistakes_are_told_with_their_place(file, text, place, words):
    file.write_text(text)
    with pytest.raises(ProfileError) as caught:
        load_camera_config()
    assert f"camera.yaml{place}" in caught.value.message
    assert words in caught.value.message


def test_the_words_name_the_values_that_hold():
    for name, field in CameraSettings.model_fields.items():
        default = field.default
        if isinstance(default, int) and not isinstance(default, bool):
            assert f"Default: {default}." in field.description, name


def test_every_key_of_another_event_camera_reaches_the_driver(file):
    file.write_text(
        "version: 1\nmirrored: true\nevents:\n  px_per_mm: 8.0\n  centre_px: [640, 360.5]\n"
        "  max_events_per_s: 5000000\n  biases:\n    prophesee_evk4: {diff_on: 20, diff_off: -5}\n"
        "    inivation_dvxplorer:\n      on: 9\n  strobe: {hz: 25, dark_us: 1000}\n"
    )
    biases = {"prophesee_evk4": {"diff_on": 20, "diff_off": -5}, "inivation_dvxplorer": {"on": 9}}
    assert load_camera_config().events == EventsConfig(
        8.0, (640.0, 360.5), 5_000_000, biases, mirrored=True, strobe=StrobeConfig(25.0, 1_000)
    )


def test_a_strobe_without_values_is_the_usual_one(file):
    file.write_text("version: 1\nevents:\n  strobe: {}\n")
    assert load_camera_config().events.strobe == StrobeConfig(20.0, 1_500)


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("events:\n  px_per_mm: 0.1", ":2:14"),
        ("events:\n  centre_px: [1]", ":2:3"),
        ("events:\n  strobe: {hz: 60}", ":2:16"),
        ("events:\n  strobe: {dark_us: 100}", ":2:21"),
        ("events:\n  biases:\n    evk4: {diff_on: 1}", ":3:5"),
        ("events:\n  biases:\n    prophesee_evk4: {diff_on: 100000}", ":3:31"),
    ],
)
def test_a_mistake_about_another_event_camera_has_its_place(file, text, place):
    file.write_text(f"version: 1\n{text}\n".replace("version: 1\n", "", 1))
    with pytest.raises(ProfileError) as caught:
        load_camera_config()
    assert place in str(caught.value)

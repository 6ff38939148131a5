"""The choices of the service: typed, strict, and shipped right."""

from pathlib import Path

import pytest

from neurotouch_hid.driver.service_settings import (
    ServiceSettings,
    find_service_file,
    load_service_settings,
)
from neurotouch_hid.errors import ProfileError
from neurotouch_hid.profile import load_user

SHIPPED = Path(__file__).parents[2] / "packaging/etc"


@pytest.fixture
def file(tmp_path, monkeypatch) -> Path:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))  # as the unit does with /etc
    (tmp_path / "neurotouch").mkdir()
    assert find_service_file() == tmp_path / "neurotouch/service.yaml"
    return find_service_file()


def test_without_a_file_the_first_camera_and_the_first_favourite(file):
    assert load_service_settings() == ServiceSettings()
    assert load_service_settings().source == "davis:"


def test_everything_chosen(file):
    file.write_text(
        "version: 1\nprofile: racing\ncamera: '00000042'\ndevice: hid\nidentity: generic\n"
    )
    settings = load_service_settings()
    assert (settings.profile, settings.source) == ("racing", "davis:00000042")
    assert (settings.device, settings.identity) == ("hid", "generic")


@pytest.mark.parametrize("name", ["video:", "video:usb-0000:00:14.0-2", "video:HD Camera"])
def test_a_video_camera_can_be_chosen(file, name):
    file.write_text(f"camera: '{name}'\n")
    assert load_service_settings().source == name


@pytest.mark.parametrize(
    ("text", "place", "word"),
    [
        ("version: 1\nprofil: racing\n", ":2:1", "profile"),
        ("version: 1\nprofile: ../racing\n", ":2:10", "profile"),
        ("version: 1\n\ncamera: 42\n", ":3:9", 'write "42"'),
        ("version: 2\n", ":1:10", "version"),
        ("device: memory\n", ":1:9", "uinput"),
    ],
)
def test_a_mistake_is_named_with_its_place(file, text, place, word):
    file.write_text(text)
    with pytest.raises(ProfileError) as caught:
        load_service_settings()
    assert f"service.yaml{place}" in caught.value.message
    assert word in caught.value.message


def test_the_shipped_files_change_nothing(file):
    for name in ("service.yaml", "user.yaml"):
        (file.parent / name).write_text((SHIPPED / name).read_text())
    assert load_service_settings() == ServiceSettings()
    assert load_user() == type(load_user())()


def test_what_the_shipped_file_offers_in_comments_can_be_chosen(file):
    text = (SHIPPED / "service.yaml").read_text()
    file.write_text(text.replace("#profile", "profile").replace("#camera", "camera"))
    settings = load_service_settings()
    assert settings.profile is not None
    assert settings.camera is not None

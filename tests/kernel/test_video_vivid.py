"""Our V4L2 layer and live source in a real kernel, on the camera that the kernel simulates."""

import pytest

from tests.kernel.guest.vivid import SIZE

NEEDED = ("GREY", "YUYV", "UYVY", "NV12", "NV21", "YU12", "YV12")


@pytest.fixture(scope="module")
def saw(guest):
    return guest("vivid")


def test_the_camera_is_listed_with_its_formats_and_modes(saw):
    assert saw["info"] == ["vivid", "vivid", "platform:vivid-000", ""]
    assert set(NEEDED) <= set(saw["formats"])
    assert [640, 480, 25.0] in saw["modes"]
    assert [320, 180, 60.0] in saw["modes"]
    assert saw["refused"] == []


@pytest.mark.parametrize("fourcc", NEEDED)
def test_every_format_shows_the_same_ramp(saw, fourcc):
    picture = saw["pictures"][fourcc]
    assert picture["agreed"][:3] == [fourcc, *SIZE]
    assert picture["same_rows"]
    row = picture["row"]
    full = 255 if fourcc == "GREY" else 219  # the others use 16 to 235
    first = 0 if fourcc == "GREY" else 16
    expected = [first + full * k / len(row) for k in range(len(row))]
    assert row == pytest.approx(expected, abs=1.5)


def test_controls_are_read_and_set_and_missing_ones_are_told(saw):
    assert saw["lacks_exposure"]
    assert saw["gain"] == [0, 255, 1, 100]
    assert saw["set"][0] is True
    assert saw["set"][2] is False
    assert len(saw["stream"]["1"]["lacking"]) == 5


@pytest.mark.parametrize("source", ["0", "1"])
def test_a_stream_has_all_its_pictures_with_ascending_stamps(saw, source):
    stream = saw["stream"][source]
    assert stream["mode"] == ["YUYV", *SIZE]
    assert stream["n"] + stream["lost"] >= 0.8 * 2 * stream["fps"]
    assert stream["ascend"]
    assert (stream["damaged"], stream["unstamped"]) == (0, 0)


def test_a_second_program_is_told_that_the_camera_is_in_use(saw):
    message, exit_code = saw["busy"]
    assert message == "The camera vivid (/dev/video0) is in use by another program."
    assert exit_code == 75


def test_lost_damaged_and_missing_pictures_are_told_apart(guest):
    saw = guest("vivid_faults")
    n, n_lost = saw["dropped"]
    assert 0.2 < n_lost / (n + n_lost) < 0.8
    assert saw["error"][0] < saw["error"][2]
    name, after_s = saw["unplugged"]
    assert name == "CameraGoneError"
    assert after_s < 1.0
    assert saw["left"] == []
    assert saw["again"]
    assert saw["interval"]


def test_the_live_source_comes_back_after_the_camera_was_unplugged(guest):
    saw = guest("vivid_replugged")
    (listed,) = saw["listed"]
    assert listed["name"] == "vivid"
    assert "320x180" in listed["mode"]
    assert saw["name"] == "video:/dev/video0"
    assert saw["frames"] > 0
    assert "not plugged in" in saw["trouble"][0] or "reports an error" in saw["trouble"][0]
    assert len(saw["gaps"]) >= 1
    assert saw["frames_after"] > 0
    assert saw["ascend"]

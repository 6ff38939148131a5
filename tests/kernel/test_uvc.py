"""The emulated UVC camera in the real kernel: ``uvcvideo`` and v4l2-ctl see what it promises."""

import re
from itertools import pairwise

import pytest
from neurotouch_devtools.emulator.uvc import MODES, PixelFormat

from tests.kernel.guest.minute import N_PICTURES
from tests.kernel.guest.uvc import FAULT_AT, N_FILM, N_READ, N_TAKEN
from tests.kernel.test_run import CLEARLY, NEUTRAL, read_reports

CONTROLS = {
    "auto_exposure",
    "brightness",
    "exposure_time_absolute",
    "focus_absolute",
    "focus_automatic_continuous",
    "gain",
    "power_line_frequency",
    "white_balance_automatic",
    "white_balance_temperature",
}
JPEG_ERROR = 3.0
"""Mean error of a pixel, of 255."""
ALL = list(range(N_TAKEN))
MOST_WAITING = 8
"""Pictures on their way when the stream ends: the kernel's buffers and what the camera holds."""
MOVES = (("leftx", 1), ("lefttrigger", 1))
"""Of ``tests/kernel/film.py``, as ``profiles/spacecraft.yaml`` has them."""


@pytest.fixture(scope="module")
def described(guest):
    return guest("uvc_description")


@pytest.fixture(scope="module")
def suffered(guest):
    return guest("uvc_faults")


def list_modes(said):
    """(format, width, height, frames a second) of each mode that v4l2-ctl lists."""
    modes = set()
    for line in said.splitlines():
        if found := re.search(r"'(\w+)'", line):
            pixel_format = found[1]
        elif found := re.search(r"Size: Discrete (\d+)x(\d+)", line):
            size = int(found[1]), int(found[2])
        elif found := re.search(r"\(([\d.]+) fps\)", line):
            modes.add((pixel_format, *size, round(float(found[1]))))
    return modes


def list_controls(said):
    return set(re.findall(r"(\w+) 0x", said))


def test_the_kernel_knows_it_by_name_and_place(described):
    for name, product in (("full", "Emulated UVC camera"), ("poor", "Poor camera")):
        said = described[name]["info"]["said"]
        assert re.search(r"Driver name +: uvcvideo\n", said)
        assert re.search(rf"Card type +: {product}\n", said)
        assert re.search(r"Bus info +: usb-vhci_hcd.0-1\n", said)


def test_every_mode_is_there_as_promised(described):
    promised = {
        (mode.pixel_format.value, mode.width, mode.height, round(1e7 / interval))
        for mode in MODES
        for interval in mode.intervals
    }
    assert list_modes(described["full"]["formats"]["said"]) == promised
    assert list_modes(described["poor"]["formats"]["said"]) == {("MJPG", 640, 480, 30)}


def test_a_camera_has_the_settings_that_it_should_have_and_no_others(described):
    assert list_controls(described["full"]["controls"]["said"]) == CONTROLS
    without = {"gain", "focus_absolute", "focus_automatic_continuous", "power_line_frequency"}
    assert list_controls(described["poor"]["controls"]["said"]) == CONTROLS - without


def test_a_setting_is_changed_only_when_it_is_not_automatic(described):
    refused, manual, exposed, darker = described["set"]
    assert refused["code"] != 0
    assert "Input/output error" in refused["said"] or "Permission denied" in refused["said"]
    assert [manual["code"], exposed["code"], darker["code"]] == [0, 0, 0]
    got = dict(re.findall(r"(\w+): (-?\d+)", described["got"]["said"]))
    assert got == {"exposure_time_absolute": "40", "brightness": "-20", "gain": "0"}


def test_the_driver_has_nothing_to_complain_about(described):
    assert described["log"]
    for line in described["log"]:
        assert "Found UVC 1.10 device" in line or "registered new interface driver" in line


@pytest.mark.parametrize("pixel_format", PixelFormat)
def test_pictures_arrive_as_they_were_sent(guest, pixel_format):
    saw = guest("uvc_pictures")[pixel_format]
    assert saw["code"] == 0
    assert saw["whole"]
    assert saw["numbers"] == ALL
    assert all(a < b for a, b in pairwise(saw["times"]))
    if pixel_format is PixelFormat.MJPEG:
        assert len(saw["errors"]) == N_TAKEN
        assert max(saw["errors"]) < JPEG_ERROR
    else:
        assert saw["found"] == ALL


def test_dropped_and_doubled_pictures_leave_no_gap_in_the_numbers(suffered):
    dropped, doubled = suffered["dropped+4x2"], suffered["doubled+4"]
    assert dropped["numbers"] == doubled["numbers"] == ALL
    assert dropped["found"] == [*range(FAULT_AT), *range(FAULT_AT + 2, N_TAKEN + 2)]
    assert doubled["found"] == [*ALL[:FAULT_AT], FAULT_AT - 1, *ALL[FAULT_AT + 1 :]]


def test_the_kernel_keeps_a_faulty_picture_to_itself_and_counts_it(suffered):
    numbers = [k for k in range(N_TAKEN + 1) if k != FAULT_AT]
    assert suffered["error+4"]["numbers"] == numbers
    assert suffered["error+4"]["found"] == numbers


@pytest.mark.parametrize("chapter", ["damaged+4", "damaged MJPG"])
def test_a_damaged_picture_arrives_damaged(suffered, chapter):
    saw = suffered[chapter]
    assert saw["numbers"] == ALL
    assert len(saw["errors"]) == N_TAKEN
    assert saw["errors"][FAULT_AT] > 3 * JPEG_ERROR
    assert max(saw["errors"][:FAULT_AT] + saw["errors"][FAULT_AT + 1 :]) < JPEG_ERROR


def test_a_failed_transfer_costs_a_picture_and_what_waits_for_the_reader(suffered):
    saw = suffered["protocol@stream+12"]
    numbers = [number for number, k in zip(saw["numbers"], saw["found"], strict=True) if k >= 0]
    assert numbers[:FAULT_AT] == ALL[:FAULT_AT]
    assert numbers == sorted(set(numbers) - {FAULT_AT})
    assert len(numbers) == N_TAKEN
    # The film begins again for a camera that is far ahead of a slow reader.
    assert [k for k in saw["found"] if k >= 0] == [number % N_FILM for number in numbers]
    assert saw["found"].count(-1) > 0, "the kernel gives the reader its buffers back, without data"


def test_a_pulled_cable_costs_no_more_than_what_waits_for_the_reader(suffered):
    found = suffered["unplug@picture+4"]["found"]
    assert found == ALL[: min(len(found), FAULT_AT)]


@pytest.fixture(scope="module")
def read(guest):
    return guest("uvc_source")


def test_every_picture_that_was_sent_was_read_or_is_counted_as_lost(read):
    assert read["n_shown"] >= N_READ
    assert 0 <= read["n_sent"] - read["n_read"] - read["n_lost"] <= MOST_WAITING


def test_the_settings_that_blur_pictures_are_fixed(read):
    assert read["settings"]["auto_exposure"] == 1
    assert 100 * read["settings"]["exposure"] == read["exposure_us"]
    assert (read["settings"]["autofocus"], read["settings"]["auto_white_balance"]) == (0, 0)
    assert "320x240" in read["mode"]


def test_the_gestures_of_the_film_move_the_pad(guest):
    saw = guest("uvc_play")
    seen = saw["sdl2"]
    for control, way in MOVES:
        low, high = seen.get(control, (0, 0))
        assert (high if way > 0 else -low) >= CLEARLY, (seen, saw["before"], saw["after"])
    assert {control for control, (low, high) in seen.items() if max(-low, high) >= CLEARLY} == {
        control for control, _ in MOVES
    }


def test_an_unplugged_camera_leaves_the_pad_neutral(guest):
    saw = guest("uvc_play")
    reports = read_reports(saw["events"][: saw["n_unplugged"]])
    assert any(report != NEUTRAL for report in reports)
    assert reports[-1] == NEUTRAL


def test_a_camera_that_is_back_plays_again(guest):
    saw = guest("uvc_play")
    reports = read_reports(saw["events"])
    assert len(reports) > len(read_reports(saw["events"][: saw["n_unplugged"]]))
    assert reports[-1] == NEUTRAL
    assert saw["exit_code"] == 0


def test_every_picture_that_was_played_into_the_pad_is_explained(guest):
    """NEUROTOUCH_PICTURES=7500 plays a minute's worth of 125 pictures a second."""
    saw = guest("minute")
    assert saw["n_sent"] >= N_PICTURES
    on_their_way = saw["n_sent"] - saw["n_read"] - saw["n_lost"] - saw["n_damaged"]
    assert 0 <= on_their_way <= MOST_WAITING
    # The others were too late for the slow guest's pipeline: old data moves no stick.
    assert 0 < saw["n_played"] <= saw["n_read"]

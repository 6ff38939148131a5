"""An emulated PS3 Eye in the real kernel: ``gspca_ov534`` takes it for one, and we read it."""

import re

import pytest

from tests.kernel.guest.eye import N_SHOWN

QVGA_HZ, VGA_HZ = (187, 150, 137, 125, 100, 75, 60, 50, 37, 30), (60, 50, 40, 30, 15)
MOST_WAITING = 8
"""Pictures on their way when the stream ends: the kernel's buffers and what the camera holds."""


@pytest.fixture(scope="module")
def saw(guest):
    return guest("eye")


def test_its_driver_offers_what_it_offers_of_a_real_one(saw):
    assert "ov534" in "".join(saw["log"])
    for code in ("YUYV", "GRBG"):  # the second has colours that we do not read
        part = saw["formats"].partition(f"'{code}'")[2].partition("]: '")[0]
        for size, rates in (("320x240", QVGA_HZ), ("640x480", VGA_HZ)):
            sized = part.partition(size)[2].partition("Size")[0]
            offered = [round(float(fps)) for fps in re.findall(r"\(([\d.]+) fps\)", sized)]
            assert tuple(offered[: len(rates)]) == rates


def test_the_fastest_mode_is_chosen_and_its_settings_are_fixed(saw):
    assert saw["mode"] == "320x240 YUYV at 187 pictures/s"
    assert saw["settings"]["automatic"] & 0b111 == 0  # gain, white balance, exposure
    lines = saw["settings"]["exposure_high"] << 8 | saw["settings"]["exposure_low"]
    assert any(f"fixed at {lines // 2} " in sentence for sentence in saw["lacking"])


def test_the_gel_is_seen_in_its_pictures(saw):
    assert saw["n_shown"] >= N_SHOWN
    assert saw["is_gel"]


def test_every_picture_that_was_sent_was_read_or_is_counted_as_lost(saw):
    assert 0 <= saw["n_sent"] - saw["n_read"] - saw["n_lost"] <= MOST_WAITING

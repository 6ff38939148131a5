"""The gel is found in pictures of all sizes, with all lenses, and brought to its place."""

import math

import numpy as np
import pytest

from neurotouch_hid.geometry import LATTICE_MM, fit_rig
from neurotouch_hid.source.video.source import PictureSlicer
from neurotouch_hid.tracker.gel_finder import GelFinder
from tests.source.video.gel_pictures import draw_gel, middle_rig, place_dots

PERIOD_US = 33_333


def watch(pictures):
    """The slicer after some pictures, and its frames."""
    slicer = PictureSlicer(GelFinder(), 10_000)
    packets = [
        packet
        for k, picture in enumerate(pictures)
        for packet in slicer.push(picture, k * PERIOD_US, k * PERIOD_US)
    ]
    return slicer, [frame for packet in packets for frame in packet.frames]


@pytest.mark.parametrize("rim", [-0.2, 0.0, 0.2])
@pytest.mark.parametrize(
    ("size_px", "px_per_mm"),
    [
        ((320, 240), 3.0),
        ((320, 240), 1.5),
        ((640, 480), 6.0),
        ((640, 480), 2.2),
        ((1280, 800), 9.0),
        ((1920, 1200), 15.0),
        ((1920, 1200), 2.5),
        ((480, 640), 6.0),
        ((1200, 1920), 8.0),
    ],
)
def test_a_gel_is_found_and_brought_to_its_place(size_px, px_per_mm, rim):
    rig = middle_rig(size_px, px_per_mm, math.radians(7))
    picture = draw_gel(rig, size_px, rim)
    slicer, frames = watch([picture] * 16)
    assert slicer.is_found
    shown = slicer.view.to_canonical(place_dots(rig, size_px, rim))
    found = fit_rig(shown)
    assert found.px_per_mm == pytest.approx(2.5, rel=0.03)
    assert found.centre_px == pytest.approx((172.5, 129.5), abs=1.0)
    assert found.rotation_rad == pytest.approx(rig.rotation_rad, abs=0.01)
    straight = found.to_px(LATTICE_MM)
    assert np.hypot(*(shown - straight).T).max() < 1.5  # of 15 px at the rim with 20 %
    seen = GelFinder().find(frames[-1].pixels)  # the dots are where the view says
    assert np.median(np.hypot(*(seen - shown).T)) < 0.25


@pytest.mark.parametrize("off_px", [(-500, -300), (500, 300), (0, 330), (-620, 10)])
def test_a_small_gel_beside_the_middle_of_a_cluttered_picture(off_px):
    size_px = (1920, 1200)
    rig = middle_rig(size_px, 3.5, off_px=off_px)
    slicer, _ = watch([draw_gel(rig, size_px, room=True)] * 16)
    assert slicer.is_found
    shown = slicer.view.to_canonical(rig.to_px(LATTICE_MM))
    assert fit_rig(shown).centre_px == pytest.approx((172.5, 129.5), abs=1.0)

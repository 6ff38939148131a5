"""The gel is found in pictures of all sizes, with all lenses, and brought to its place."""

import math

import numpy as np
import pytest

from neurotouch_hid.geometry import (
    PAPER_GEL,
    fit_rig,
    make_gel,
    place_grid,
    place_hex,
    place_rings,
)
from neurotouch_hid.source.video.source import PictureSlicer
from neurotouch_hid.tracker.gel_finder import GelFinder
from tests.source.video.gel_pictures import draw_gel, middle_rig, place_dots
from tests.source.video.pattern_pictures import PATTERNS

PERIOD_US = 33_333


def watch(pictures, gel=PAPER_GEL):
    """The slicer after some pictures, and its frames."""
    slicer = PictureSlicer(GelFinder(gel), 10_000)
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
    found = fit_rig(shown, PAPER_GEL)
    assert found.px_per_mm == pytest.approx(2.5, rel=0.03)
    assert found.centre_px == pytest.approx((172.5, 129.5), abs=1.0)
    assert found.rotation_rad == pytest.approx(rig.rotation_rad, abs=0.01)
    straight = found.to_px(PAPER_GEL.points_mm)
    assert np.hypot(*(shown - straight).T).max() < 1.5  # of 15 px at the rim with 20 %
    seen = GelFinder().find(frames[-1].pixels)  # the dots are where the view says
    assert np.median(np.hypot(*(seen - shown).T)) < 0.25


def test_a_gel_that_is_pushed_at_the_start_waits_for_its_rest():
    """A push looks like a lens: the view would be off by some pixels for as long as it lasts."""
    rig, size_px = middle_rig((640, 480), 6.0), (640, 480)
    pushed = [draw_gel(rig, size_px, push_mm=7.0, seed=seed) for seed in range(12)]
    resting = [draw_gel(rig, size_px, seed=seed) for seed in range(12)]
    assert GelFinder().find(watch(pushed)[1][-1].pixels) is not None
    assert not watch(pushed)[0].is_found
    view = watch(pushed + resting)[0].view
    assert view.lens == pytest.approx(0.0, abs=0.03)
    assert view.centre_px == pytest.approx((319.5, 239.5), abs=1.0)


@pytest.mark.parametrize("off_px", [(-500, -300), (500, 300), (0, 330), (-620, 10)])
def test_a_small_gel_beside_the_middle_of_a_cluttered_picture(off_px):
    size_px = (1920, 1200)
    rig = middle_rig(size_px, 3.5, off_px=off_px)
    slicer, _ = watch([draw_gel(rig, size_px, room=True)] * 16)
    assert slicer.is_found
    shown = slicer.view.to_canonical(rig.to_px(PAPER_GEL.points_mm))
    assert fit_rig(shown, PAPER_GEL).centre_px == pytest.approx((172.5, 129.5), abs=1.0)


def test_the_view_follows_a_camera_that_has_moved_far():
    size_px = (640, 480)
    before, after = middle_rig(size_px, 6.0), middle_rig(size_px, 3.0, off_px=(-180, 120))
    pictures = [draw_gel(before, size_px)] * 100 + [draw_gel(after, size_px)] * 400
    slicer, _ = watch(pictures)
    shown = fit_rig(slicer.view.to_canonical(after.to_px(PAPER_GEL.points_mm)), PAPER_GEL)
    assert shown.px_per_mm == pytest.approx(2.5, rel=0.02)
    assert shown.centre_px == pytest.approx((172.5, 129.5), abs=1.0)


def test_the_view_stays_where_it_is_under_a_hand_and_a_bump():
    size_px = (640, 480)
    rig, bumped = middle_rig(size_px, 6.0), middle_rig(size_px, 6.0, off_px=(20, -10))
    gel, hidden = draw_gel(rig, size_px), np.full((480, 640), 60, np.uint8)
    slicer, _ = watch([gel, gel])
    known = slicer.view
    slicer, _ = watch([gel] * 10 + [hidden] * 400 + [draw_gel(bumped, size_px)] * 400)
    assert slicer.view == known


HEX = make_gel("hex", place_hex(4.4, 28.0), pitch_mm=4.4, radius_mm=28.0)
RINGS = make_gel("rings", place_rings(4.5, 27.0), pitch_mm=4.5, radius_mm=27.0)
FINE = make_gel(
    "fine", place_grid(10, 7, 2.0, 2.0), pitch_mm=2.0, radius_mm=11.0, dot_mm=0.6, light=False
)


@pytest.mark.parametrize(
    ("gel", "px_per_mm"), [(HEX, 6.0), (RINGS, 6.0), (FINE, 16.0)], ids=["hex", "rings", "dark"]
)
def test_other_gels_are_shown_with_the_same_pitch(gel, px_per_mm):
    size_px = (640, 480)
    rig = middle_rig(size_px, px_per_mm, off_px=(30, -20))
    slicer, frames = watch([draw_gel(rig, size_px, gel=gel)] * 4, gel)
    assert slicer.is_found
    found = fit_rig(slicer.view.to_canonical(rig.to_px(gel.points_mm)), gel)
    assert found.px_per_mm * gel.pitch_mm == pytest.approx(10.0, rel=0.02)
    assert found.centre_px == pytest.approx((172.5, 129.5), abs=1.0)
    shown = frames[-1].pixels.astype(int)
    dots = found.to_px(gel.points_mm).round().astype(int)
    stands_out = np.median(shown[dots[:, 1], dots[:, 0]]) - np.median(shown)
    assert (stands_out if gel.light else -stands_out) > 60


@pytest.mark.parametrize("size_px", [(640, 480), (1920, 1200)], ids=["vga", "wuxga"])
@pytest.mark.parametrize("share", [1 / 24, 1 / 50], ids=["coarse", "fine"])
@pytest.mark.parametrize("name", PATTERNS)
def test_a_pattern_that_is_no_gel_is_not_taken_for_one(name, share, size_px):
    picture = PATTERNS[name](size_px, share * size_px[1])
    for gel in (PAPER_GEL, HEX) if name in ("plate", "hexagons") else (PAPER_GEL,):
        assert not watch([picture] * 3, gel)[0].is_found


def test_a_gel_before_a_pattern_is_found():
    size_px = (1280, 800)
    rig = middle_rig(size_px, 9.0)
    picture = PATTERNS["plate"](size_px, 30.0)
    far = np.hypot(*(np.mgrid[:800, :1280].transpose(1, 2, 0) - (399.5, 639.5)).transpose(2, 0, 1))
    near = far < (PAPER_GEL.radius_mm + 1.0) * 9.0
    picture[near] = draw_gel(rig, size_px)[near]
    slicer, _ = watch([picture] * 4)
    assert slicer.is_found
    shown = slicer.view.to_canonical(rig.to_px(PAPER_GEL.points_mm))
    assert fit_rig(shown, PAPER_GEL).centre_px == pytest.approx((172.5, 129.5), abs=1.0)

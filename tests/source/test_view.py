"""The view: both directions agree, and the picture it makes is the one its points tell."""

import numpy as np
import pytest

from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX
from neurotouch_hid.source.sensor_map import find_places
from neurotouch_hid.source.view import MIDDLE_PX, View, ViewTable, whole_view

SIZES = [(320, 240), (640, 480), (1920, 1200), (1200, 1920), (347, 211)]


def draw(view, pixels):
    out = np.empty((SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX), np.uint8)
    ViewTable(view).draw(pixels, out)
    return out


@pytest.mark.parametrize("size_px", SIZES)
@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("lens", [-0.4, 0.0, 0.2])
def test_both_directions_agree(size_px, mirrored, lens):
    width, height = size_px
    view = View(width, height, (width / 2 + 9, height / 2 - 7), 0.4, 0.3, mirrored, lens)
    points = np.random.default_rng(0).uniform((0, 0), (width - 1, height - 1), (500, 2))
    assert view.to_sensor(view.to_canonical(points)) == pytest.approx(points, abs=1e-6)


def test_a_dot_keeps_its_contrast_wherever_the_pixels_fall():
    """Boxes larger than a canonical pixel took a quarter of it."""
    y, x = np.mgrid[:480, :640]
    dot = (200 * np.clip(2.8 - np.hypot(x - 320, y - 239), 0, 1)).astype(np.uint8)
    centres_px = [(320.0 + 0.13 * k, 239.0 + 0.07 * k) for k in range(20)]
    peaks = [draw(View(640, 480, centre_px, 0.55), dot).max() for centre_px in centres_px]
    assert min(peaks) > 190


def test_a_barrel_is_pulled_straight():
    view = View(640, 480, (319.5, 239.5), 1.0, lens=-0.2)
    corner = np.array([[639.0, 479.0]])  # half a diagonal from the middle, a pixel less
    off = view.to_canonical(corner) - MIDDLE_PX
    assert off / (corner - (319.5, 239.5)) == pytest.approx(1 / 0.8, rel=0.01)


def test_clockwise_and_mirrored():
    right = np.array([[110.0, 50.0]])  # 10 px right of the centre
    turned = View(101, 101, (100.0, 50.0), 2.0, np.pi / 2)
    assert turned.to_canonical(right) - MIDDLE_PX == pytest.approx(np.array([[0.0, 20.0]]))
    flipped = View(101, 101, (100.0, 50.0), 2.0, mirrored=True)
    assert flipped.to_canonical(right) - MIDDLE_PX == pytest.approx(np.array([[-20.0, 0.0]]))


@pytest.mark.parametrize("size_px", SIZES)
def test_the_whole_view_shows_all_of_it_and_no_more(size_px):
    width, height = size_px
    view = whole_view(width, height)
    low, high = view.to_canonical(np.array([[-0.5, -0.5], [width - 0.5, height - 0.5]]))
    assert (low >= -0.5001).all()
    assert (high <= (SENSOR_WIDTH_PX - 0.4999, SENSOR_HEIGHT_PX - 0.4999)).all()
    margin = low + 0.5
    assert min(margin) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("scale", [1.0, 0.6, 0.31, 0.16, 2.3])
@pytest.mark.parametrize("lens", [0.0, -0.3])
def test_the_picture_is_the_one_its_points_tell(scale, lens):
    width, height = 1280, 800
    y, x = np.mgrid[:height, :width]
    pixels = (127 + 60 * np.sin(x / 60) + 60 * np.cos(y / 45)).astype(np.uint8)
    view = View(width, height, (600.0, 410.0), scale, 0.4, mirrored=True, lens=lens)
    yc, xc = np.mgrid[:SENSOR_HEIGHT_PX, :SENSOR_WIDTH_PX]
    at = view.to_sensor(np.stack([xc.ravel(), yc.ravel()], axis=1).astype(float))
    inside = ((at > 8) & (at < (width - 9, height - 9))).all(axis=1)
    told = 127 + 60 * np.sin(at[:, 0] / 60) + 60 * np.cos(at[:, 1] / 45)
    off = draw(view, pixels).ravel()[inside] - told[inside]
    assert inside.mean() > 0.2
    assert np.abs(off).max() < 3.0
    assert abs(off.mean()) < 0.7


def test_a_dot_stays_where_it_is():
    pixels = np.zeros((480, 640), np.uint8)
    pixels[200:208, 300:308] = 255
    view = View(640, 480, (310.0, 215.0), 0.45)
    picture = draw(view, pixels).astype(float)
    y, x = np.mgrid[:SENSOR_HEIGHT_PX, :SENSOR_WIDTH_PX]
    seen = np.array([[(picture * x).sum(), (picture * y).sum()]]) / picture.sum()
    assert seen == pytest.approx(view.to_canonical(np.array([[303.5, 203.5]])), abs=0.05)


def test_beyond_the_picture_is_its_edge():
    pixels = np.full((240, 320), 77, np.uint8)
    assert (draw(View(320, 240, (-500.0, 120.0), 1.0), pixels) == 77).all()


def test_a_picture_of_another_size_is_refused():
    with pytest.raises(ValueError, match="640×480"):
        draw(whole_view(320, 240), np.zeros((480, 640), np.uint8))


@pytest.mark.parametrize("rotation_rad", [0.0, 0.3])
@pytest.mark.parametrize("mirrored", [False, True])
def test_each_sensor_pixel_has_the_canonical_pixel_of_its_middle(rotation_rad, mirrored):
    view = View(640, 480, (300.3, 220.8), 0.613, rotation_rad, mirrored)
    y, x = np.mgrid[:480, :640]
    at = view.to_canonical(np.stack([x.ravel(), y.ravel()], axis=1))
    columns, rows = np.floor(at + 0.5).astype(int).T
    inside = (columns >= 0) & (columns < SENSOR_WIDTH_PX) & (rows >= 0) & (rows < SENSOR_HEIGHT_PX)
    tables = find_places(view)
    assert [table.dtype for table in tables] == [np.int16, np.int16]
    found = [np.broadcast_to(table, (480, 640)).ravel() for table in tables]
    assert 0.2 < inside.mean() < 0.98
    assert np.array_equal((found[0] >= 0) & (found[1] >= 0), inside)
    assert np.array_equal(found[0][inside], columns[inside])
    assert np.array_equal(found[1][inside], rows[inside])

"""The compiled loops on frames against their plain twins."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from neurotouch_hid.geometry import PAPER_GEL
from neurotouch_hid.tracker.blobs import BlobConfig, BlobFinder
from neurotouch_hid.tracker.kernels import chamfer, dots
from neurotouch_hid.tracker.kernels import image as kernels
from tests.reference import tracker as reference

BLOCK = kernels.BLOCK_PX


def draw_dots(rng, n=120):
    """Returns a frame (260, 346) of noise, a brightness slope and round dots of many sizes."""
    y, x = np.mgrid[:260, :346]
    image = 20.0 + 0.1 * x + rng.normal(0, 2, x.shape)
    for _ in range(n):
        u, v, r = rng.uniform(0, 346), rng.uniform(0, 260), rng.uniform(0.5, 4.0)
        image += rng.uniform(20, 150) * np.clip(r + 0.5 - np.hypot(x - u, y - v), 0, 1)
    return np.clip(image, 0, 255).astype(np.uint8)


@pytest.mark.parametrize("seed", range(3))
def test_threshold_equals_the_statistics_of_each_window(seed):
    pixels = draw_dots(np.random.default_rng(seed))
    threshold = np.empty((33, 44))
    background = np.empty_like(threshold)
    kernels.threshold_blocks(pixels, 1.5, 10.0, threshold, background)
    twin = np.array(reference.threshold(pixels, 1.5, 10.0, BLOCK))
    np.testing.assert_allclose(threshold, twin[:, :, 0], atol=1e-6)
    np.testing.assert_allclose(background, twin[:, :, 1], atol=1e-6)


@pytest.mark.parametrize("seed", range(3))
def test_blobs_are_the_connected_regions(seed):
    pixels = draw_dots(np.random.default_rng(seed))
    config = BlobConfig()
    blobs = BlobFinder(config).find(pixels)
    level = reference.threshold(pixels, config.n_sigma, config.min_contrast, BLOCK)
    twin = reference.find_blobs(
        pixels,
        lambda y, x: level[y // BLOCK][x // BLOCK][0],
        lambda y, x: level[y // BLOCK][x // BLOCK][1],
        config.min_area_px,
        config.max_area_px,
    )
    expected = {frozenset(y * 346 + x for y, x in members): (cx, cy) for members, cx, cy in twin}
    parts = np.split(blobs.members, blobs.begin[1:-1])
    assert len(parts) == len(expected) > 60
    for part, centroid in zip(parts, blobs.centroid_px, strict=True):
        np.testing.assert_allclose(centroid, expected[frozenset(part.tolist())], atol=1e-6)


def test_a_dot_that_goes_a_part_of_a_pixel_is_seen_to_go_as_far():
    """Which pixels exceed a threshold jumps, and with it the middle of those that do."""
    rng = np.random.default_rng(4)
    y, x = np.mgrid[:260, :346]
    start = PAPER_GEL.points_mm * 2.5 + (172.3, 130.4)
    seen = []
    for way_px in np.arange(0.0, 1.2, 0.15):
        at = start + way_px * np.array([0.8, 0.6])
        dots = sum(np.exp(-((x - u) ** 2 + (y - v) ** 2) / (2 * 0.9**2)) for u, v in at)
        pixels = np.rint(30.0 + 120.0 * dots + rng.normal(0.0, 1.5, x.shape)).astype(np.uint8)
        finder = BlobFinder()
        finder.is_fine = True
        found_px = finder.find(pixels).centroid_px
        near = np.hypot(*(found_px[None] - at[:, None]).transpose(2, 0, 1)).argmin(axis=1)
        seen.append(found_px[near] - at)
    off_px = np.array(seen) - seen[0]
    assert np.sqrt((off_px**2).mean()) < 0.03


def test_pixels_of_blobs_in_a_circle():
    blobs = BlobFinder().find(draw_dots(np.random.default_rng(5)))
    out = np.empty(90_000, np.int32)
    args = (blobs.centroid_px, blobs.begin, blobs.members)
    n = chamfer.gather_inside(*args, (150.0, 120.0), 60.0, out)
    parts = np.split(blobs.members, blobs.begin[1:-1])
    inside = np.hypot(*(blobs.centroid_px - (150.0, 120.0)).T) < 60.0
    assert 5 < inside.sum() < len(parts)
    expected = [part for part, near in zip(parts, inside, strict=True) if near]
    assert np.array_equal(out[:n], np.concatenate(expected))


def test_a_white_frame_and_a_black_frame_have_no_blobs():
    finder = BlobFinder()
    for level in (0, 255):
        pixels = np.full((260, 346), level, np.uint8)
        pixels.setflags(write=False)
        assert len(finder.find(pixels).centroid_px) == 0


def test_blobs_beyond_the_largest_number_are_left_out():
    finder = BlobFinder()
    pixels = np.zeros((260, 346), np.uint8)
    pixels[::4, ::4] = pixels[1::4, ::4] = 200
    assert len(finder.find(pixels).centroid_px) == 1024
    assert len(finder.find(np.zeros_like(pixels)).centroid_px) == 0  # nothing is left of it


def test_blobs_at_the_border_of_the_picture_are_whole():
    pixels = np.zeros((260, 346), np.uint8)
    for y, x in ((0, 0), (0, 344), (257, 0), (257, 344), (100, 344), (101, 0)):
        pixels[y : y + 3, x : x + 2] = 200
    blobs = BlobFinder(BlobConfig(min_clear=0)).find(pixels)
    assert (
        sorted(np.diff(blobs.begin).tolist()) == [6] * 6
    )  # the right and the left border do not touch


@pytest.mark.parametrize("gain", [1, kernels.GAIN])
def test_a_smoothed_picture_is_the_picture_in_binomials_of_five_pixels(gain):
    pixels = draw_dots(np.random.default_rng(2)) // 4
    smooth = np.empty_like(pixels)
    kernels.smooth(pixels, gain, 10.0, smooth)
    wide, weights = np.pad(pixels.astype(float), 2, mode="edge"), np.array([1, 4, 6, 4, 1]) / 16
    rows = sum(w * wide[k : k + 260] for k, w in enumerate(weights))
    twin = sum(w * rows[:, k : k + 346] for k, w in enumerate(weights))
    level = kernels.MIDDLE_DN + gain * (twin - 10.0)
    np.testing.assert_allclose(smooth, np.clip(level, 0, 255), atol=0.51)


def test_dots_on_a_gel_that_auto_exposure_made_grey_are_not_drowned_in_noise():
    """Dots saturate, and noise joins them to blobs that are too large: a third of them was lost."""
    rng = np.random.default_rng(5)
    y, x = np.mgrid[:260, :346]
    at = PAPER_GEL.points_mm * 2.5 + (172.3, 130.4)
    dots = sum(np.clip(1.75 - np.hypot(x - u, y - v), 0, 1) for u, v in at)
    gel = 40.0 + 165.0 / (1.0 + np.exp((np.hypot(x - 172, y - 130) - 84.0) / 4.0))
    noise = rng.normal(0.0, 0.16, gel.shape) * gel
    noisy = np.clip(gel + 150.0 * dots + noise, 0, 255).astype(np.uint8)
    found_px = BlobFinder().find(noisy).centroid_px
    off_px = np.hypot(*(found_px[None] - at[:, None]).transpose(2, 0, 1)).min(axis=1)
    assert (off_px > 1.5).mean() < 0.15
    assert len(found_px) < 2 * len(at)


def test_dots_out_of_focus_are_found_to_a_third_of_a_pixel():
    rng = np.random.default_rng(3)
    y, x = np.mgrid[:260, :346]
    at = np.stack(np.meshgrid(np.arange(60, 290, 10.0), np.arange(40, 220, 10.0)), -1)
    at = at.reshape(-1, 2) + rng.uniform(-0.5, 0.5, (at.size // 2, 2))
    image = np.full(x.shape, 12.0)
    for u, v in at:
        image += 13.0 * np.exp(-((x - u) ** 2 + (y - v) ** 2) / (2 * 2.6**2))
    pixels = np.rint(image + rng.normal(0, 1.5, x.shape)).astype(np.uint8)
    found = BlobFinder().find(pixels).centroid_px
    far = np.hypot(*(at[:, None] - found[None]).transpose(2, 0, 1)).min(axis=1)
    assert len(found) == len(at)
    assert np.sqrt((far**2).mean()) < 0.33


def test_a_picture_is_searched_once():
    finder, pixels = BlobFinder(), draw_dots(np.random.default_rng(1))
    assert finder.find(pixels) is finder.find(pixels)
    assert finder.find(pixels.copy()) is not finder.find(pixels)


@given(st.integers(0, 2**32 - 1), st.integers(1, 60), st.integers(1, 60))
@settings(max_examples=25, deadline=None)
def test_distances_and_chamfer_are_exact(seed, n, m):
    rng = np.random.default_rng(seed)
    h, w = 30, 40
    p, q = (np.unique(rng.integers(0, h * w, k)).astype(np.int32) for k in (n, m))
    mask = np.zeros((h, w), np.uint8)
    mask.flat[q] = chamfer.REFERENCE
    p_points, q_points = ([divmod(int(i), w) for i in index] for index in (p, q))
    for y, x in rng.integers(0, (h, w), (20, 2)).tolist():
        exact = reference.squared_distance((y, x), q_points)
        for most in (9, 1 << 30):
            found = chamfer.ring_distance(y * w + x, mask, chamfer.REFERENCE, most)
            assert found == min(exact, most)
    before = mask.copy()
    assert chamfer.chamfer(p, q, mask, 1 << 30) == pytest.approx(
        reference.chamfer(p_points, q_points)
    )
    assert chamfer.chamfer(p[:0], q, mask, 9) == np.inf
    assert np.array_equal(mask, before)


@pytest.mark.parametrize("n", [1, 6, 45])
def test_the_usual_dot_is_the_mean_of_the_middle_half_of_each_pixel(n):
    rng = np.random.default_rng(n)
    pixels = draw_dots(rng)
    x, y = rng.integers(5, 340, n), rng.integers(5, 254, n)
    step = np.arange(-5, 6)
    near = np.hypot(*np.meshgrid(step, step)) <= 5
    every = np.sort(pixels[y[:, None, None] + step[:, None], x[:, None, None] + step][:, near], 0)
    twin = every[n // 4 : n - n // 4].mean(axis=0)
    np.testing.assert_array_equal(dots.draw_usual(pixels, x, y, 5), twin)


def test_brightness_of_dots_and_of_those_around_them():
    rng, gel = np.random.default_rng(8), PAPER_GEL
    dots_px = gel.points_mm * 2.5 + (172.0, 130.0)
    dots_px = np.concatenate([dots_px, dots_px[:3] + 4.0, [(3.0, 3.0), (0.0, 259.4)]])
    pixels = rng.integers(0, 256, (260, 346)).astype(np.uint8)
    blob = np.where(rng.random(177) < 0.8, np.arange(177), -1).astype(np.int32)
    peak = dots.find_peaks(pixels, dots_px)
    assert peak[-1] == pixels[257:260, 0:3].max()  # the pixels nearest to it
    usual = dots.find_usual_peaks(peak, blob, gel.neighbours, 0.9)
    for i in range(177):
        around = sorted(peak[j] for j in gel.neighbours[i] if j >= 0 and blob[j] >= 0)
        assert usual[i] == around[int(0.9 * (len(around) - 1))]
    marker = dots.find_markers(dots_px, blob)
    assert marker[blob[blob >= 0]].tolist() == np.flatnonzero(blob >= 0).tolist()
    assert (marker[177:180] >= 0).all()
    assert (marker[180:] < 0).all()  # far from the gel

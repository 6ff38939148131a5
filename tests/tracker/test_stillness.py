"""A gel that is still is told from a hand, also in noise; and noise is no motion."""

import numpy as np
import pytest

from neurotouch_hid.geometry import PAPER_GEL, Rig
from neurotouch_hid.messages import Frame
from neurotouch_hid.tracker import RestDetector
from neurotouch_hid.tracker.stillness import StillConfig, Stillness
from tests.tracker.test_rest import push

RIG = Rig((172.0, 130.0), 2.4, 0.1)
REST_PX = RIG.to_px(PAPER_GEL.points_mm)
BLACK = np.zeros((260, 346), np.uint8)


def play(moves_px, noise_px=0.0, period_us=80_000, hidden=()):
    """Returns how many of some frames end a time without motion; dots of ``hidden`` are missing."""
    still, rng, n = Stillness(StillConfig(), 59), np.random.default_rng(4), 0
    for k, moved in enumerate(moves_px):
        t_us = period_us * k
        dots = np.empty((0, 2)) if k in hidden else REST_PX + moved
        if len(dots):
            dots = dots + rng.normal(0.0, noise_px, dots.shape)
            dots = dots[rng.random(len(dots)) > 0.04]
        n += still.update(Frame(BLACK, t_us, t_us), dots)
        if n:
            break
    return n


@pytest.mark.parametrize("noise_px", [0.0, 0.1, 0.2])
def test_noise_is_no_motion(noise_px):
    assert play(np.zeros((14, 1, 2)), noise_px)


def test_a_second_and_some_frames_must_pass():
    assert not play(np.zeros((12, 1, 2)))
    assert not play(np.zeros((9, 1, 2)), period_us=250_000)
    assert play(np.zeros((10, 1, 2)), period_us=250_000)


def test_a_black_picture_is_no_motion():
    assert play(np.zeros((16, 1, 2)), hidden=(3, 8))


@pytest.mark.parametrize("mm_s", [0.8, 3.0])
def test_a_slow_push_is_motion(mm_s):
    moved = [2.4 * mm_s * 0.08 * k * push(1.0) for k in range(40)]
    assert not play(moved, 0.1)


def test_a_fan_shakes_the_rig_and_not_the_gel():
    swing = 0.24 * np.sin(2 * np.pi * 24.0 * 0.08 * np.arange(20))
    assert play([(x, 0.0) for x in swing], 0.1)
    assert not play([(0.5 * k, 0.0) for k in range(40)], 0.1)


def picture(seed, moved_mm=0.0):
    """Returns a weak and noisy frame of a gel that is painted by hand and lacks dots."""
    rng = np.random.default_rng(7)
    mm = PAPER_GEL.points_mm + rng.normal(0.0, 0.3, PAPER_GEL.points_mm.shape)
    height = np.where(rng.random(len(mm)) < 0.1, 14.0, 45.0) * (rng.random(len(mm)) > 0.1)
    noise = np.random.default_rng((7, seed))
    y, x = np.mgrid[:260, :346]
    image = np.full(x.shape, 12.0)
    for (u, v), dn in zip(RIG.to_px(mm + moved_mm), height, strict=True):
        image += dn * np.exp(-((x - u) ** 2 + (y - v) ** 2) / (2 * 1.5**2))
    return np.clip(np.rint(image + noise.normal(0, 8, x.shape)), 0, 255).astype(np.uint8)


def test_a_gel_in_weak_light_and_noise_is_learnt_from_the_mean_of_its_pictures():
    detector, found, n_rest = RestDetector(), None, 0
    for k in range(40):
        rest = detector.update(Frame(picture(k), 80_000 * k, 80_000 * k))
        n_rest += rest is not None
        found = k if found is None and rest is not None else found
    assert found is not None
    assert found <= 14
    assert n_rest >= 0.8 * (40 - found)
    assert detector.update(Frame(picture(41, push(1.2)), 3_300_000, 3_300_000)) is None

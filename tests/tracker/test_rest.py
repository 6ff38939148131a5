"""The gel is found, and rest is distinguished from touch."""

from dataclasses import replace

import numpy as np
import pytest

from neurotouch_hid.geometry import PAPER_GEL, Rig
from neurotouch_hid.messages import Frame, GelProblem
from neurotouch_hid.tracker import BlobFinder, RestConfig, RestDetector
from neurotouch_hid.tracker.lattice import LatticeFinder
from neurotouch_hid.tracker.sharpness import measure_sharpness
from tests.source.video.pattern_pictures import draw_plate

RIG = Rig((172.0, 130.0), 2.5, 0.1)


def push(mm, contact_mm=(3.0, -2.0)):
    """Returns the displacement (177, 2) mm of a finger that drags to the right."""
    r = np.hypot(*(PAPER_GEL.points_mm - contact_mm).T)
    rim = np.clip(1 - (np.hypot(*PAPER_GEL.points_mm.T) / 31) ** 2, 0, 1) ** 0.4
    return np.stack([mm * rim / (1 + (r / 9.0) ** 2), np.zeros_like(r)], axis=1)


def picture(moved_mm=0.0, rig=RIG, level=150.0, spots=8, seed=0, brightness=None):
    """Returns a frame of the gel: dots of 1 mm, uneven light, noise, bright spots outside."""
    brightness = np.ones(len(PAPER_GEL.points_mm)) if brightness is None else brightness
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[:260, :346]
    light = level * (1 + 0.3 * (x - 173) / 173)
    image = 0.15 * light
    for (u, v), white in zip(rig.to_px(PAPER_GEL.points_mm + moved_mm), brightness, strict=True):
        a, b = slice(max(int(v) - 4, 0), int(v) + 6), slice(max(int(u) - 4, 0), int(u) + 6)
        near = np.hypot(x[a, b] - u, y[a, b] - v)
        image[a, b] += white * light[a, b] * np.clip(0.5 * rig.px_per_mm + 0.5 - near, 0, 1)
    spot = np.random.default_rng(99)
    for _ in range(spots):
        angle, far = spot.uniform(0, 2 * np.pi), spot.uniform(34, 50) * rig.px_per_mm
        u, v = rig.centre_px[0] + far * np.cos(angle), rig.centre_px[1] + far * np.sin(angle)
        image += 200 * np.exp(-((x - u) ** 2 + (y - v) ** 2) / (2 * spot.uniform(0.8, 3) ** 2))
    return np.clip(image + rng.normal(0, 2, image.shape), 0, 255).astype(np.uint8)


def show(detector, *pictures, period_us=40_000):
    """Returns the result of the detector for the last of some frames."""
    answer = None
    for pixels in pictures:
        begin_us = period_us * detector.stats().n_frames
        answer = detector.update(Frame(pixels, begin_us, begin_us + 10_000))
    return answer


@pytest.mark.parametrize("px_per_mm", [2.1, 2.5, 2.9])
@pytest.mark.parametrize("rotation_rad", [-0.26, 0.0, 0.2])
def test_the_first_picture_at_rest_gives_all_markers(px_per_mm, rotation_rad):
    rig = Rig((176.0, 127.0), px_per_mm, rotation_rad)
    detector = RestDetector()
    rest = show(detector, picture(rig=rig))
    assert rest is not None
    assert rest.t_us == 5_000
    assert rest.position_px.dtype == np.float32
    assert np.abs(rest.position_px - rig.to_px(PAPER_GEL.points_mm)).max() < 0.35
    assert detector.stats().n_found == 177
    assert not detector.stats().problem


def test_rest_is_measured_in_each_frame():
    rig = replace(RIG, centre_px=(172.3, 130.2))
    rest = show(RestDetector(), picture(), picture(rig=rig, seed=1))
    assert rest is not None
    assert np.abs((rest.position_px - rig.to_px(PAPER_GEL.points_mm)).mean(axis=0)).max() < 0.03


def blurred(seed, moved_mm=0.0):
    """Returns a frame with faint dots out of focus."""
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[:260, :346]
    image = np.full(x.shape, 12.0)
    for u, v in RIG.to_px(PAPER_GEL.points_mm + moved_mm):
        image += 12.0 * np.exp(-((x - u) ** 2 + (y - v) ** 2) / (2 * 2.6**2))
    return np.rint(image + rng.normal(0, 1.5, x.shape)).astype(np.uint8)


def test_a_gel_out_of_focus_is_found_and_is_at_rest():
    detector = RestDetector()
    n_rest = sum(show(detector, blurred(seed)) is not None for seed in range(40))
    assert n_rest >= 36
    assert show(detector, blurred(40, push(0.6))) is None


def test_reflections_are_sharp_even_if_the_lens_is_out_of_focus():
    pixels = blurred(0)
    for x, y in ((60, 30), (280, 40), (64, 220), (300, 210)):
        pixels[y : y + 2, x : x + 2] = 220
    blur_px, problem = measure_sharpness(pixels, BlobFinder().find(pixels), RIG.px_per_mm)
    assert blur_px is not None
    assert 1.6 < blur_px < 2.8
    assert problem is GelProblem.BLURRED


@pytest.mark.parametrize(("mm", "at_rest"), [(0.0, True), (0.1, True), (0.4, False), (9.0, False)])
def test_touch_is_not_rest(mm, at_rest):
    detector = RestDetector()
    rest = show(detector, picture(), picture(push(mm), seed=1))
    assert (rest is not None) == at_rest
    assert (not detector.stats().problem) == at_rest
    assert show(detector, picture(seed=2)) is not None


@pytest.mark.parametrize(("mm", "at_rest"), [(1.0, True), (4.0, False)])
def test_the_paper_has_the_chamfer_distance_only(mm, at_rest):
    detector = RestDetector(RestConfig(max_displacement_mm=np.inf, max_apart_px2=1 << 30))
    rest = show(detector, picture(), picture(push(mm), seed=1))
    assert (rest is not None) == at_rest
    assert (detector.stats().chamfer_px2 <= 2.5) == at_rest


@pytest.mark.parametrize("mm", [1.5, 3.0, 8.0])
def test_a_hand_on_the_gel_at_the_start_is_not_taken_for_rest(mm):
    detector = RestDetector()
    assert show(detector, picture(push(mm))) is None
    assert detector.stats().n_references == 0
    assert detector.stats().problem
    assert show(detector, picture(seed=1)) is not None


def test_the_end_of_a_touch_at_the_start_is_not_taken_for_rest():
    detector, found = RestDetector(), None
    sizes = (3.0, 1.2, 0.6, 0.45, 0.33, 0.24, 0.1, 0.04, 0.0)
    for seed, mm in enumerate(sizes):  # a hand that was on the gel from the start leaves it
        found = show(detector, picture(push(mm), seed=seed))
        if found is not None:
            break
    assert found is not None
    assert np.abs(found.position_px - RIG.to_px(PAPER_GEL.points_mm)).max() < 0.6


def test_a_lattice_that_stays_slightly_bent_is_accepted():
    bent = [picture(push(0.5), seed=seed) for seed in range(3)]
    detector = RestDetector()
    assert show(detector, bent[0]) is None
    assert detector.gel.problem is GelProblem.LEARNING
    assert show(detector, *bent[1:]) is not None


@pytest.mark.parametrize(
    ("pixels", "why"),
    [
        (np.zeros((260, 346), np.uint8), GelProblem.DARK),
        (np.full((260, 346), 255, np.uint8), GelProblem.BRIGHT),
        (picture(rig=replace(RIG, centre_px=(20.0, 130.0))), GelProblem.OUTSIDE),
        (draw_plate((346, 260), 10.0), GelProblem.PATTERN),
    ],
)
def test_it_says_why_there_is_no_gel(pixels, why):
    detector = RestDetector()
    assert show(detector, pixels) is None
    assert detector.gel.problem is why


def test_a_bumped_camera_gives_a_new_reference_but_a_long_push_does_not():
    detector = RestDetector()
    show(detector, picture())
    assert show(detector, *(picture(push(3.0), seed=s) for s in range(30))) is None
    assert detector.stats().n_references == 1
    bumped = replace(RIG, centre_px=(179.0, 126.0))
    answers = [show(detector, picture(rig=bumped, seed=s)) for s in range(60)]
    assert detector.stats().n_references == 2
    assert answers[-1] is not None
    assert np.abs(answers[-1].position_px - bumped.to_px(PAPER_GEL.points_mm)).max() < 0.35


@pytest.mark.parametrize(
    ("by_mm", "turn_rad", "scale"),
    [((2.0, 0.0), 0.0, 1.0), ((-3.0, 4.2), 0.0, 1.0), ((0.6, 0.0), 0.04, 1.0), ((0, 0), 0, 1.04)],
)
def test_what_moves_rigidly_is_the_rig_so_play_goes_on(by_mm, turn_rad, scale):
    rig = Rig(tuple(RIG.to_px(np.array(by_mm))), RIG.px_per_mm * scale, RIG.rotation_rad + turn_rad)
    detector = RestDetector()
    show(detector, picture())
    for seed in range(3):  # never at rest for longer than two frames
        show(detector, picture(push(3.0), rig, seed=seed))
        rest = show(detector, picture(rig=rig, seed=seed), picture(rig=rig, seed=seed + 9))
        assert rest is not None
        assert np.abs(rest.position_px - rig.to_px(PAPER_GEL.points_mm)).max() < 0.35
    assert detector.stats().n_references == 2


@pytest.mark.parametrize(("creep_mm", "turn_deg"), [(0.9, 0.0), (0.3, 1.0), (2.0, 0.0)])
def test_a_rig_that_creeps_or_turns_is_at_rest_though_dots_are_noisy(creep_mm, turn_deg):
    rng, detector, n = np.random.default_rng(3), RestDetector(), 150
    rests = []
    for k in range(n):
        centre_px = RIG.centre_px[0] + RIG.px_per_mm * creep_mm * k / n, RIG.centre_px[1]
        rig = replace(
            RIG, centre_px=centre_px, rotation_rad=RIG.rotation_rad + np.radians(turn_deg) * k / n
        )
        noise_mm = rng.normal(0.0, 0.05, PAPER_GEL.points_mm.shape)
        rests.append(show(detector, picture(noise_mm, rig=rig, seed=k)))
    assert sum(rest is None for rest in rests) <= 3
    assert show(detector, picture(push(0.45), rig=rig)) is None


@pytest.mark.parametrize("per_s", [25, 125])
@pytest.mark.parametrize(
    ("largest_mm", "left_mm", "tremble_mm", "at_rest"),
    [
        (15.0, 0.75, 0.0, True),  # the gel keeps a twentieth
        (15.0, 0.75, 0.1, False),  # a finger is on it
        (15.0, 1.5, 0.0, False),
        (0.75, 0.75, 0.0, False),  # a small push that lasts
    ],
)
def test_a_gel_that_keeps_a_part_of_a_large_motion_is_at_rest(
    largest_mm, left_mm, tremble_mm, at_rest, per_s
):
    period_us = 1_000_000 // per_s
    detector = RestDetector()
    for share in (0.0, 0.3, 0.6, 1.0):
        show(detector, picture(push(share * largest_mm)), period_us=period_us)
    # A finger trembles at about 12 Hz.
    times_s = np.arange(0.0, 0.32, 1e-6 * period_us)
    sizes_mm = left_mm + tremble_mm * np.sin(2 * np.pi * 12.5 * times_s + 0.5 * np.pi)
    left = [
        show(detector, picture(push(mm), seed=k), period_us=period_us)
        for k, mm in enumerate(sizes_mm)
    ]
    assert (left[-1] is not None) == at_rest
    assert left[2] is None
    if at_rest:
        assert (
            np.abs(left[-1].position_px - RIG.to_px(PAPER_GEL.points_mm + push(left_mm))).max()
            < 0.5
        )
    assert show(detector, picture(), period_us=period_us) is not None


def test_a_rig_on_its_way_is_not_followed_by_a_fast_camera():
    """A bump of 3 mm in 200 ms moves the gel by no more than 0.12 mm from frame to frame."""
    detector = RestDetector()
    show(detector, picture(), period_us=8_000)
    for k in range(1, 26):
        moved = replace(RIG, centre_px=(172.0 + 7.5 * k / 25, 130.0))
        show(detector, picture(rig=moved, seed=k), period_us=8_000)
    assert detector.stats().n_references == 1
    last = [show(detector, picture(rig=moved, seed=k), period_us=8_000) for k in range(26, 38)]
    assert detector.stats().n_references == 2
    assert np.abs(last[-1].position_px - moved.to_px(PAPER_GEL.points_mm)).max() < 0.35


def test_a_rig_that_stops_swinging_later_is_where_it_stands_in_the_end():
    """Its last swings are too small to be followed as a motion, and used to stay as an error."""
    detector = RestDetector()
    show(detector, *(picture(seed=k) for k in range(20)), period_us=8_000)
    for k in range(40):
        swing = 6.0 + 0.35 * (1.0 if k < 12 else 0.0)
        moved = replace(RIG, centre_px=(172.0 + swing, 130.0))
        show(detector, picture(rig=moved, seed=k), period_us=8_000)
    assert detector.stats().n_references == 2
    assert detector.stats().displacement_px < 0.3


def test_a_hand_on_the_gel_at_the_start_is_no_rest_after_a_moment():
    """Odd optics look like a soft touch; only a second without motion tells them apart."""
    detector = RestDetector()
    touched = [picture(push(1.2), seed=k) for k in range(5)]
    shown = [show(detector, touched[k % 5], period_us=8_000) for k in range(120)]
    assert shown == [None] * 120
    assert [show(detector, touched[k % 5], period_us=8_000) for k in range(10)][-1] is not None


def test_a_rig_that_swings_is_not_followed():
    detector = RestDetector()
    show(detector, picture())
    for seed in range(8):
        swung = replace(RIG, centre_px=(172.0 + (2.0 if seed % 2 else -2.0), 130.0))
        assert show(detector, picture(rig=swung, seed=seed)) is None
    assert detector.stats().n_references == 1


def test_a_light_that_grows_weaker_is_still_rest():
    detector = RestDetector()
    show(detector, picture())
    assert show(detector, picture(level=90.0, seed=1)) is not None
    assert detector.stats().n_found == 177


def beside(pixels, n=60):
    """Returns a frame with specks as large as dots on the gel's left half, between its dots."""
    pixels = pixels.copy()
    between = RIG.to_px(PAPER_GEL.points_mm + 0.5 * PAPER_GEL.pitch_mm)
    left = between[np.argsort(between[:, 0])][:n]
    for u, v in np.rint(left).astype(int):
        pixels[v : v + 2, u : u + 2] = 250
    return pixels


def test_specks_beside_the_dots_neither_move_nor_hide_a_rig_that_was_followed():
    detector, moved = RestDetector(), replace(RIG, centre_px=(174.0, 130.0))
    show(detector, *(picture(seed=k) for k in range(17)))
    show(detector, *(picture(rig=moved, seed=k) for k in range(3)))
    assert detector.stats().n_references == 2
    swung = replace(RIG, centre_px=(174.5, 130.0))
    show(detector, beside(picture(rig=swung, seed=3)))
    rest = show(detector, picture(rig=moved, seed=4))
    assert rest is not None
    assert np.abs(rest.position_px - moved.to_px(PAPER_GEL.points_mm)).max() < 0.35


def test_a_bumped_rig_is_followed_among_specks():
    detector, moved = RestDetector(), replace(RIG, centre_px=(173.0, 130.0))
    show(detector, *(picture(seed=k) for k in range(17)))
    show(detector, *(beside(picture(rig=moved, seed=k)) for k in range(3)))
    assert detector.stats().n_references == 2
    rest = show(detector, picture(rig=moved, seed=4))
    assert rest is not None
    assert np.abs(rest.position_px - moved.to_px(PAPER_GEL.points_mm)).max() < 0.35


def test_a_known_rig_is_taken():
    rig = Rig((172.0, 130.0), 2.5, 1.2)
    detector = RestDetector(rig=rig)
    rest = show(detector, picture(rig=rig))
    assert rest is not None
    assert np.abs(rest.position_px - rig.to_px(PAPER_GEL.points_mm)).max() < 0.35


def test_dots_that_come_and_go_beside_18_that_are_missing_do_not_end_the_rest():
    rng, n = np.random.default_rng(4), PAPER_GEL.n_markers
    gone = rng.permutation(n)[:18]
    detector, frames = RestDetector(), []
    for seed in range(25):  # one second
        brightness = np.where(rng.random(n) < 0.05, 0.0, 1.0)
        brightness[gone] = 0.0
        frames.append(show(detector, picture(brightness=brightness, seed=seed)))
    assert frames[0] is not None
    assert sum(frame is None for frame in frames) <= 1
    assert set(gone.tolist()) <= set(detector.gel.missing)
    assert np.abs(frames[-1].position_px - RIG.to_px(PAPER_GEL.points_mm)).max() < 0.8


def test_a_gel_with_missing_and_faint_dots_is_learnt():
    rng = np.random.default_rng(3)
    for light in (0.0, 0.15):
        brightness = np.ones(len(PAPER_GEL.points_mm))
        brightness[rng.permutation(len(PAPER_GEL.points_mm))[:46]] = light
        detector = RestDetector()
        first, later = (show(detector, picture(brightness=brightness, seed=s)) for s in (0, 1))
        assert first is not None
        assert later is not None
        assert np.abs(later.position_px - RIG.to_px(PAPER_GEL.points_mm)).max() < 0.8
        assert show(detector, picture(push(0.6), brightness=brightness, seed=2)) is None


@pytest.mark.parametrize("off_mm", [0.3, 0.6])
def test_a_gel_that_is_painted_by_hand_is_learnt_and_a_touch_of_it_is_not(off_mm):
    way = np.random.default_rng(5).uniform(-np.pi, np.pi, len(PAPER_GEL.points_mm))
    painted = off_mm * np.stack([np.cos(way), np.sin(way)], axis=1)
    detector = RestDetector()
    assert show(detector, picture(painted + push(1.5))) is None
    rest = show(detector, *(picture(painted, seed=s) for s in range(1, 35)))  # 1.3 s
    assert rest is not None
    assert np.abs(rest.position_px - RIG.to_px(PAPER_GEL.points_mm + painted)).max() < 0.35
    assert show(detector, picture(painted + push(0.5), seed=2)) is None


@pytest.mark.parametrize("bend", [-0.2, 0.2])
def test_a_lens_that_bends_by_a_fifth_is_no_hindrance(bend):
    bent = bend * PAPER_GEL.points_mm * ((PAPER_GEL.points_mm**2).sum(axis=1) / 900.0)[:, None]
    rest = show(RestDetector(), picture(bent))
    assert rest is not None
    assert np.abs(rest.position_px - RIG.to_px(PAPER_GEL.points_mm + bent)).max() < 0.35


@pytest.mark.parametrize("px_per_mm", [1.6, 3.6, 4.2])
def test_the_gel_may_be_small_in_the_picture_or_fill_it(px_per_mm):
    rig = Rig((172.0, 130.0), px_per_mm, 0.05)
    rest = show(RestDetector(), picture(rig=rig))
    assert rest is not None
    assert np.abs(rest.position_px - rig.to_px(PAPER_GEL.points_mm)).max() < 0.6


@pytest.mark.parametrize("off_px", [130.0, 160.0, 185.0])
def test_a_gel_half_out_of_the_picture_is_refused_however_still(off_px):
    rig = replace(RIG, centre_px=(172.0 + off_px, 130.0))
    assert show(RestDetector(), *(picture(rig=rig, seed=s) for s in range(30))) is None


def test_specks_at_the_border_do_not_end_a_long_push():
    """They looked like a gel that reaches beyond the picture, and the gel was given up."""
    detector = RestDetector()
    show(detector, picture())
    r = np.hypot(*PAPER_GEL.points_mm.T)
    right = 6.0 * np.clip(1 - (r / 31) ** 2, 0, 1) ** 0.4 * np.minimum(1, 10.0 / np.maximum(r, 1.0))
    moved_mm = np.stack([right, np.zeros_like(r)], axis=1)  # more than half of the markers

    def draw(seed):
        pixels = picture(moved_mm, seed=seed)
        for x in range(30, 330, 20):
            pixels[2:5, x : x + 4] = 200
        return pixels

    show(detector, *(draw(seed) for seed in range(1, 50)))
    assert detector.gel.is_found


@pytest.mark.parametrize("turned_deg", [0.0, 44.0, 46.0, 89.0, 91.0, 180.0, -91.0])
def test_of_four_turns_that_look_the_same_the_expected_one_is_taken(turned_deg):
    rig = replace(RIG, rotation_rad=np.radians(turned_deg))
    for expected_deg in (turned_deg - 30.0, turned_deg + 30.0):
        rest = show(RestDetector(near_rad=np.radians(expected_deg)), picture(rig=rig))
        assert np.abs(rest.position_px - rig.to_px(PAPER_GEL.points_mm)).max() < 0.35


def test_dots_that_are_too_far_apart_for_any_gel_are_no_fault():
    grid = np.stack(np.meshgrid(np.arange(10.0), np.arange(7.0)), axis=-1).reshape(-1, 2)
    assert LatticeFinder().find(20.0 + 33.0 * grid) is None


def test_a_hand_that_lies_still_from_the_start_is_refused():
    detector = RestDetector()
    assert show(detector, *(picture(push(3.0), seed=s) for s in range(50))) is None
    assert detector.gel.problem is GelProblem.BENT


def test_odd_optics_are_accepted_once_the_gel_is_still():
    swirl = 0.1 * np.sin(
        PAPER_GEL.points_mm[:, ::-1] / 4.0
    )  # waves of 1 mm, which no smooth model contains
    detector = RestDetector()
    answers = [show(detector, picture(4.0 * swirl, seed=s)) for s in range(27)]
    assert answers[0] is None
    assert answers[-1] is not None

"""The fingers that are followed are the real ones."""

import numpy as np
import pytest

from neurotouch_hid.geometry import PAPER_GEL, Rig, make_gel, place_grid
from neurotouch_hid.gesture.elastic.fingers import FingerConfig
from neurotouch_hid.gesture.elastic.kernels.arrays import NOW
from neurotouch_hid.gesture.elastic.kernels.field import fill_responses, find_site
from neurotouch_hid.gesture.elastic.kernels.fit import RIM_WIDTH_MM
from neurotouch_hid.messages import GestureKind
from neurotouch_hid.source.simulator.gel import solid
from neurotouch_hid.source.simulator.script import Finger, Stroke
from tests.gesture.elastic import field
from tests.gesture.stages import Fingers

SEES_ALL = np.ones(len(PAPER_GEL.points_mm), np.bool_)
RIG = Rig((0.0, 0.0), 1.0)  # a pixel a millimetre
REST_PX = PAPER_GEL.points_mm.astype(np.float32)
PLACES = np.array([[-9.0, 0.0], [9.0, 0.0]])


def pinch(size_mm):
    return field(PLACES, np.array([[size_mm, 0.0], [-size_mm, 0.0]]))


def follow(fingers, sizes_mm):
    for size_mm in sizes_mm:
        fingers.update(pinch(size_mm), SEES_ALL, 0.05, forming=False)


def found(fingers):
    fit = fingers.arrays.fits[NOW]
    order = np.argsort(fit["centres"][: fit["count"], 0])
    return fit["centres"][order], fit["motions"][order, 0]


def test_two_fingers_are_followed():
    fingers = Fingers()
    fingers.place(REST_PX, RIG)
    follow(fingers, [1.0, 2.0, 3.0, 4.0])
    centres, drags = found(fingers)
    np.testing.assert_allclose(centres, PLACES, atol=1.5)
    np.testing.assert_allclose(drags, [4.0, -4.0], atol=0.5)


@pytest.mark.parametrize("falling", [True, False])
def test_no_finger_is_added_while_fingers_leave(falling):
    fingers = Fingers()
    fingers.place(REST_PX, RIG)
    for size_mm in (1.0, 2.0, 3.0, 4.0):
        push = field(PLACES[:1], np.array([[size_mm, 0.0]]))
        assert fingers.update(push, SEES_ALL, 0.05, forming=False).n_fingers == 1
    late = field(PLACES, np.array([[3.0, 0.0], [0.0, 1.5]]))
    motion = fingers.update(late, SEES_ALL, 0.05, forming=False, falling=falling)
    assert motion.n_fingers == (1 if falling else 2)


@pytest.mark.parametrize(
    ("at_mm", "by_mm"),
    [((8.0, -28.0), (-1.2, 0.0)), ((0.0, -28.0), (0.0, 1.2)), ((-12.0, -24.0), (0.0, 1.2))],
)
def test_a_marker_that_follows_a_speck_is_no_finger(at_mm, by_mm):
    """Beside the rim, where a marker has few neighbours, a finger can be fitted to it alone."""
    fingers = Fingers()
    fingers.place(REST_PX, RIG)
    moved = np.zeros(REST_PX.shape)
    moved[np.hypot(*(PAPER_GEL.points_mm - at_mm).T).argmin()] = by_mm
    assert fingers.update(moved, SEES_ALL, 0.04, forming=True).n_fingers == 0
    beside = moved + field(PLACES[:1], np.array([[0.4, 0.0]]))
    motion = fingers.update(beside, SEES_ALL, 0.04, forming=True)
    assert motion.n_fingers == 1
    assert motion.largest_mm == pytest.approx(0.4, abs=0.1)


def test_a_marker_that_follows_a_speck_beside_a_finger_is_none():
    fingers = Fingers()
    fingers.place(REST_PX, RIG)
    push = field(PLACES[:1], np.array([[0.5, 0.0]]))
    for _ in range(3):
        assert fingers.update(push, SEES_ALL, 0.04, forming=True).n_fingers == 1
    push[np.hypot(*(PAPER_GEL.points_mm - [8.0, -28.0]).T).argmin()] = [-1.2, 0.0]
    for _ in range(4):
        assert fingers.update(push, SEES_ALL, 0.04, forming=True).n_fingers == 1


def test_tracks_that_stay_behind_one_by_one_are_no_fingers():
    fingers = Fingers()
    fingers.place(REST_PX, RIG)
    push = field(PLACES[:1], np.array([[1.0, 0.0]]))
    for share in (1.0, 0.6, 0.4):
        motion = fingers.update(share * push, SEES_ALL, 0.04, forming=False, falling=True)
        assert motion.n_fingers == 1
        assert not motion.is_lost
    near = np.hypot(*(PAPER_GEL.points_mm - PLACES[0]).T) < 12.0
    behind = near & (np.arange(len(near)) % 2 > 0)
    motion = fingers.update(behind[:, None] * push, SEES_ALL, 0.04, forming=False, falling=True)
    assert motion.is_lost


def test_overlapping_fingers_are_searched_for_again():
    fingers = Fingers()
    fingers.place(REST_PX, RIG)
    follow(fingers, [1.0, 2.0])
    fit = fingers.arrays.fits[NOW]
    fit["centres"][:] = fit["centres"][0]  # one place: nothing tells their motions apart
    fit["radii"][:] = fit["radii"][0]
    follow(fingers, [3.0, 4.0])
    centres, drags = found(fingers)
    np.testing.assert_allclose(centres, PLACES, atol=1.5)
    np.testing.assert_allclose(drags, [4.0, -4.0], atol=0.5)


def test_a_finger_in_the_wrong_place_is_searched_for_again():
    fingers = Fingers()
    fingers.place(REST_PX, RIG)
    follow(fingers, [1.0, 2.0])
    fingers.arrays.fits[NOW]["centres"][:2] = [[0.0, -24.0], [0.0, 24.0]]
    follow(fingers, [3.0, 4.0])
    np.testing.assert_allclose(found(fingers)[1], [4.0, -4.0], atol=0.5)


def test_fingers_whose_markers_have_lost_their_trust_are_searched_for_again():
    """A hand drags where no finger was found while it pressed."""
    hand = np.array([[-11.0, 5.0], [-13.5, -12.5], [1.0, -5.3]])
    inward = hand.mean(axis=0) - hand
    inward /= np.hypot(*inward.T)[:, None]
    fingers = Fingers()
    fingers.place(REST_PX, RIG)
    fingers.update(field(hand, 0.4 * inward), SEES_ALL, 0.05, forming=True)
    fit, moved = fingers.arrays.fits[NOW], field(hand, 3.0 * inward)
    fit["count"] = 3
    fit["centres"], fit["motions"] = [[0.0, -24.0], [-22.0, -9.0], [6.0, 6.0]], [0.3, 0.2, 0.0]
    fit["radii"], fit["trust"], fit["largest_mm"] = 6.5, 3.0, 0.5
    fingers.arrays.markers["residual"][0, NOW, : len(moved)] = moved
    for _ in range(4):
        motion = fingers.update(moved, SEES_ALL, 0.05, forming=False)
    assert motion.n_fingers == 3
    assert motion.largest_mm == pytest.approx(3.0, abs=0.3)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_single_marker_that_follows_a_wrong_dot_makes_no_finger(way):
    fingers = Fingers()
    fingers.place(REST_PX, RIG)
    rng = np.random.default_rng(4)
    for size_mm in np.minimum(np.arange(0.1, 5.0, 0.1), 0.6):
        moved = field(PLACES[:1], np.array([[size_mm, 0.0]]))
        moved[100] += (0.0, 4.0 * way)  # far from the finger, by the pitch
        moved += rng.normal(0.0, 0.03, moved.shape)
        motion = fingers.update(moved, SEES_ALL, 0.05, forming=True)
    assert motion.n_fingers == 1
    assert motion.largest_mm == pytest.approx(0.6, abs=0.1)


def test_slices_of_any_length_trust_and_check_their_fingers_alike():
    trust, searches = [], []
    for step_us in (1_000, 4_000, 10_000):
        fingers = Fingers()
        fingers.place(REST_PX, RIG)
        for t_us in range(0, 400_000, step_us):
            size_mm = min(1.0 + 3.0 * t_us / 100_000, 4.0)
            fingers.update(pinch(size_mm), SEES_ALL, 0.05, step_us=step_us, forming=True)
        searches.append(int(fingers.arrays.state["n_searches"][0]))
        trust.append(fingers.arrays.fits[NOW]["trust"][:2])
        np.testing.assert_allclose(found(fingers)[1], [4.0, -4.0], atol=0.5)
    np.testing.assert_allclose(trust, [trust[-1]] * 3, atol=0.3)
    assert max(searches) <= searches[-1] + 1  # ten times as many slices, as many searches


def test_a_search_that_stops_early_finds_the_same_fingers():
    rng = np.random.default_rng(3)
    sizes_mm = [0.0, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 1.0, 2.0, 4.0, 4.0, 2.0, 1.0, 0.2, 0.0]
    fields = [
        pinch(size_mm) + rng.normal(0.0, 0.01, PAPER_GEL.points_mm.shape) for size_mm in sizes_mm
    ]
    motions, asked = [], []
    for sure in (FingerConfig().sure, 0.0):  # 0: every site is computed every time
        fingers = Fingers(FingerConfig(sure=sure))
        fingers.place(REST_PX, RIG)
        each = []
        for moved in fields:
            motion = fingers.update(moved, SEES_ALL, 0.05, forming=True)
            motion.parts_mm = motion.parts_mm.tolist()
            each.append((motion, motion.n_fingers and fingers.locate_shown().mm.tolist()))
        motions.append(each)
        asked.append(int(fingers.arrays.state["n_asked"][0]))
    assert motions[0] == motions[1]
    assert asked[0] < 0.8 * asked[1]


def test_every_fourth_site_shows_whether_there_is_a_finger_at_all():
    rng = np.random.default_rng(5)
    fingers = Fingers()
    fingers.place(REST_PX, RIG)
    arrays, n_found = fingers.arrays, 0
    gel = arrays.gel[0]
    weight, known = np.ones(len(PAPER_GEL.points_mm)), np.zeros((0, 2))
    n_sites, n_coarse = len(arrays.sites), int(gel["n_coarse"])
    assert n_coarse < 0.3 * n_sites
    for _ in range(200):
        place_mm = rng.uniform(-18.0, 18.0, (1, 2))
        response = np.empty((2 * len(PAPER_GEL.points_mm), 3))
        fill_responses(PAPER_GEL.points_mm, place_mm, rng.uniform(5.0, 8.0), 31.0, response)
        field = (response @ rng.normal(0.0, (1.0, 1.0, 0.1))).reshape(-1, 2)
        gel["n_coarse"] = n_sites
        best = find_site(arrays, field, weight, known, 5.0, 0.0)
        gel["n_coarse"] = n_coarse
        found = find_site(arrays, field, weight, known, 5.0, best[1])
        n_found += found == best
        more_mm2 = 4.0 * best[1]  # more than the field contains
        none = find_site(arrays, field, weight, known, 5.0, more_mm2)
        assert none == (0, 0.0)
    assert n_found >= 196


def test_names_stay_with_fingers_until_they_are_forgotten():
    fingers = Fingers()
    fingers.place(REST_PX, RIG)
    follow(fingers, [1.0, 2.0, 3.0])
    names = fingers.arrays.fits["ids"][NOW][:2].tolist()
    follow(fingers, [4.0])
    assert fingers.arrays.fits["ids"][NOW][:2].tolist() == names
    assert len(set(names)) == 2
    fingers.reset()
    assert not fingers.update(
        np.zeros(PAPER_GEL.points_mm.shape), SEES_ALL, 0.05, forming=True
    ).n_fingers


def test_a_knock_has_no_finger_and_a_light_touch_is_no_knock():
    fingers = Fingers()
    fingers.place(REST_PX, RIG)
    knock = np.full(PAPER_GEL.points_mm.shape, 0.3)
    motion = fingers.update(knock, SEES_ALL, 0.05, forming=True)
    assert motion.n_fingers == 0
    assert motion.sway_mm == pytest.approx(np.hypot(0.3, 0.3))
    touch = field(PLACES[:1], np.array([[0.15, 0.0]]))
    motion = fingers.update(touch, SEES_ALL, 0.05, forming=True)
    assert motion.n_fingers == 0
    assert motion.sway_mm < 0.02


def test_a_gel_that_stays_elsewhere_sways_no_more():
    fingers = Fingers()
    fingers.place(REST_PX, RIG)
    bumped = np.full(PAPER_GEL.points_mm.shape, 0.25)
    for _ in range(200):
        motion = fingers.update(bumped, SEES_ALL, 0.05, forming=True)
    assert motion.sway_mm < 0.05
    fingers.place(REST_PX + np.float32(0.25), RIG)  # the rest position follows: nothing moves
    motion = fingers.update(np.zeros(PAPER_GEL.points_mm.shape), SEES_ALL, 0.05, forming=True)
    assert motion.sway_mm < 0.05
    push = bumped + field(PLACES[:1], np.array([[0.6, 0.0]]))
    fingers.place(REST_PX, RIG)
    for _ in range(5):
        motion = fingers.update(push, SEES_ALL, 0.05, forming=True)
    assert motion.n_fingers == 1
    assert motion.sway_mm < 0.1


def test_a_rig_that_has_been_bumped_sways_no_more_once_its_new_place_is_known():
    fingers = Fingers()
    fingers.place(REST_PX, RIG)
    for _ in range(25):
        fingers.update(np.full(PAPER_GEL.points_mm.shape, 4.0), SEES_ALL, 0.05, forming=True)
    fingers.place(REST_PX + np.float32(4.0), RIG)
    motion = fingers.update(np.zeros(PAPER_GEL.points_mm.shape), SEES_ALL, 0.05, forming=True)
    assert motion.sway_mm < 0.05


def test_contacts_are_in_gel_and_image_coordinates():
    rig = Rig((170.0, 130.0), 2.4, 0.2)
    fingers = Fingers()
    fingers.place(rig.to_px(PAPER_GEL.points_mm).astype(np.float32), rig)
    moved_px = rig.to_px(PAPER_GEL.points_mm + pinch(4.0)) - rig.to_px(PAPER_GEL.points_mm)
    for _ in range(4):
        motion = fingers.update(moved_px, SEES_ALL, 0.05, forming=False)
    contacts = fingers.locate_shown()
    order = np.argsort(contacts.mm[:, 0])
    np.testing.assert_allclose(contacts.mm[order], [[-5.0, 0.0], [5.0, 0.0]], atol=1.0)
    fit = fingers.arrays.fits[NOW]
    whole_mm = [fit["offset_x_mm"], fit["offset_y_mm"]]
    np.testing.assert_allclose(contacts.px, rig.to_px(contacts.mm + whole_mm), atol=1e-9)
    assert np.abs(whole_mm).max() < 0.01
    assert motion.n_fingers == 2
    assert contacts.intensity_mm == pytest.approx(4.0, abs=0.3)


def test_a_third_finger_is_found_though_two_have_taken_a_part_of_its_field():
    """While these two keep what they do, it explains a fifth of what all three do together."""
    turned = {"pivot_mm": (4.2, -2.6), "press_mm": 1.0}
    hand = (
        Finger((-4.3, -2.9), turn_rad=-0.24, radius_mm=6.0, delay_us=18_618, **turned),
        Finger((8.7, -9.7), turn_rad=-0.35, radius_mm=6.31, delay_us=2_224, **turned),
        Finger((8.1, 4.9), turn_rad=-0.21, radius_mm=6.23, delay_us=3_991, **turned),
    )
    stroke = Stroke(GestureKind.TWIST_CCW, hand, attack_us=100_000)
    places_mm = np.array([finger.contact_mm for finger in hand])
    radii_mm = np.array([finger.radius_mm for finger in hand])
    fingers = Fingers()
    fingers.place(REST_PX, RIG)
    for t_us in range(50_000, 400_000, 10_000):
        now = stroke.move(t_us)
        given = PAPER_GEL.points_mm, places_mm, radii_mm, now[:, :3], now[:, 3]
        moved = solid.deform(*given)[:, :2] - PAPER_GEL.points_mm
        forming = bool(fingers.arrays.fits[NOW]["largest_mm"] < 2.3)
        motion = fingers.update(moved, SEES_ALL, 0.05, forming=forming)
    assert motion.n_fingers == 3


def test_both_fingers_of_a_twist_are_shown_as_far_as_their_dots_go_at_most():
    """On the outer side of a finger its drag and turn add up, and there people see it."""
    responses = np.empty((2 * len(PAPER_GEL.points_mm), 6))
    fill_responses(PAPER_GEL.points_mm, PLACES, 6.5, PAPER_GEL.rim_mm, responses)
    fingers, counts = Fingers(), []
    fingers.place(REST_PX, RIG)
    for turn in (0.3, 0.2, 0.1, 0.03, 0.025, 0.01):
        moved = (responses @ (0.0, -9.0 * turn, turn, 0.0, 9.0 * turn, turn)).reshape(-1, 2)
        fingers.update(moved, SEES_ALL, 0.05, forming=False)
        counts.append(len(fingers.locate_shown(1).mm))
    assert counts == [2, 2, 2, 2, 2, 1]


FLAT = make_gel("flat", place_grid(10, 7, 2.03, 2.03), pitch_mm=2.03, radius_mm=11.5)


@pytest.mark.parametrize("place_mm", [(14.0, -3.0), (2.0, 11.0), (-13.0, 9.0), (-13.0, -9.0)])
def test_a_finger_beside_the_dots_is_found_at_their_rim(place_mm):
    """What it moves of them looks like a finger at the rim, and nothing shows where it ends."""
    response = np.empty((2 * FLAT.n_markers, 3))
    fill_responses(FLAT.points_mm, np.array([place_mm]), 6.5, FLAT.rim_mm, response)
    fingers = Fingers(gel=FLAT)
    fingers.place(FLAT.points_mm.astype(np.float32), RIG)
    for size_mm in (1.0, 2.0, 3.0, 4.0, 4.0, 3.0, 2.0, 1.0):
        moved = (response @ (-size_mm * np.sign(place_mm[0]), 0.0, 0.0)).reshape(-1, 2)
        motion = fingers.update(moved, np.ones(FLAT.n_markers, np.bool_), 0.05, forming=True)
        assert motion.n_fingers
        centres = fingers.arrays.fits[NOW]["centres"][: motion.n_fingers]
        shown = fingers.locate_shown().mm - fingers.arrays.fits[NOW]["whole"][0, :2]
        for places in (centres, shown if motion.n_fingers == 1 else centres):
            assert (np.abs(places) <= (9.135 + 1e-6, 6.09 + 1e-6)).all()


def test_on_the_usual_gel_a_finger_may_be_anywhere_within_its_reach():
    assert Fingers().arrays.gel["inner_mm"][0] > PAPER_GEL.rim_mm - RIM_WIDTH_MM

"""The method ``neurotouch`` on elastic fields of one to three fingers, over time."""

from dataclasses import replace

import numpy as np
import pytest

from neurotouch_hid.geometry import PAPER_GEL
from neurotouch_hid.gesture import GestureConfig, GestureRecognizer, list_methods
from neurotouch_hid.messages import GestureKind, MarkerField
from tests.gesture.elastic import RIG, Scene, field, random_scene

KINDS = list(GestureKind)[1:]
SLICE_US = 10_000


class Player:
    """One recognizer that sees one gel through the same noisy tracker."""

    def __init__(self, seed=0, noise_px=0.2, **config):
        self.rng = np.random.default_rng(seed)
        self.noise_px = noise_px
        self.recognizer = GestureRecognizer(GestureConfig(**config))
        self.rest_px = RIG.to_px(PAPER_GEL.points_mm).astype(np.float32)
        self.t_us = 0

    def see(self, displacement_mm, valid=None):
        self.t_us += SLICE_US
        position = RIG.to_px(PAPER_GEL.points_mm + displacement_mm)
        position = position + self.rng.normal(0, self.noise_px, position.shape)
        valid = np.ones(len(position), bool) if valid is None else valid
        return self.recognizer.update(
            MarkerField(self.t_us, self.rest_px, position.astype(np.float32), valid)
        )

    def rest(self, slices=20):
        return [self.see(np.zeros_like(PAPER_GEL.points_mm)) for _ in range(slices)]

    def play(self, scene, seconds=1.6):
        """Gestures with the truth of each slice: kind, contacts, intensity."""
        out = []
        for i in range(round(seconds * 100)):
            displacement, contacts, intensity = scene.at(i / 100)
            kind = scene.kind if intensity >= 0.3 else GestureKind.NONE
            out.append((self.see(displacement), kind, contacts, intensity))
        return out


def two(motion, late=0.0, strength=(1.0, 1.0)):
    """Fingers 24 mm apart on a horizontal line; the right one may be late and weak."""
    return Scene(
        GestureKind.PINCH,
        np.array([[-12.0, 0.0], [12.0, 0.0]]),
        np.array(motion, float),
        0.0,
        np.array(strength),
        np.array([0.1, 0.1 + late]),
    )


def kinds(steps):
    """Returns the kinds shown, without NONE and repetitions."""
    shown = [gesture.kind for gesture, *_ in steps if gesture.kind is not GestureKind.NONE]
    return [k for i, k in enumerate(shown) if i == 0 or k is not shown[i - 1]]


def test_it_is_the_default():
    assert GestureConfig().method == list_methods()[0] == "neurotouch"


@pytest.mark.parametrize("kind", KINDS)
def test_every_type(kind):
    rng = np.random.default_rng(20 + kind)
    for seed in range(3):
        player = Player(seed)
        player.rest()
        for gesture, truth, contacts, intensity in player.play(random_scene(rng, kind)):
            if intensity < 2.5:
                continue
            assert gesture.kind is truth
            assert len(gesture.contacts_mm) == len(contacts)
            away = np.linalg.norm(gesture.contacts_mm[:, None] - contacts, axis=2)
            assert away.min(axis=1).max() < 4.0
            assert gesture.intensity_mm == pytest.approx(intensity, abs=0.25 * intensity)


@pytest.mark.parametrize("heading", np.arange(8) * np.pi / 4)
def test_a_push_is_measured_below_the_pitch(heading):
    motion = 5 * np.array([np.cos(heading), np.sin(heading)])
    centre = np.array([5.3, -2.1])
    player = Player()
    player.rest()
    for _ in range(10):
        gesture = player.see(field(centre[None], motion[None]))
    np.testing.assert_allclose(gesture.contacts_mm, [centre + motion], atol=0.8)
    np.testing.assert_allclose(RIG.to_px(gesture.contacts_mm), gesture.contacts_px, atol=0.1)
    np.testing.assert_allclose(gesture.translation_mm, motion, atol=0.3)
    assert gesture.intensity_mm == pytest.approx(5, abs=0.3)


def test_one_finger_that_turns_is_a_twist():
    for turn, kind in ((0.5, GestureKind.TWIST_CW), (-0.5, GestureKind.TWIST_CCW)):
        player = Player()
        player.rest()
        for i in range(30):
            now = turn * min(i / 20, 1.0)
            gesture = player.see(field(np.array([[4.0, 3.0]]), np.zeros((1, 2)), np.array([now])))
        assert gesture.kind is kind
        assert len(gesture.contacts_mm) == 1
        assert gesture.rotation_rad == pytest.approx(turn, abs=0.15)


def test_signed_rotation_and_scale():
    player = Player()
    steps = player.play(two([[6, 0], [-6, 0]]))
    assert min(g.scale for g, *_ in steps) == pytest.approx(0.5, abs=0.06)
    steps = Player().play(two([[0, -5], [0, 5]]))
    assert max(g.rotation_rad for g, *_ in steps) == pytest.approx(np.arctan(5 / 12), abs=0.05)


@pytest.mark.parametrize("late", [0.0, 0.05, 0.08])
@pytest.mark.parametrize("weak", [1.0, 0.45])
def test_a_still_finger_shows_in_the_field(late, weak):
    """So a pinch is no push even before its second finger moves."""
    player = Player(3)
    player.rest()
    shown = []
    for i in range(60):
        rise = np.clip((i / 100 - np.array([0.0, late])) / 0.3, 0, 1) ** 2
        drag = np.array([[6.0, 0.0], [-6.0 * weak, 0.0]]) * rise[:, None]
        gesture = player.see(field(np.array([[-12.0, 0.0], [12.0, 0.0]]), drag))
        if drag.max() >= 2.0:
            shown.append((gesture.kind, len(gesture.contacts_mm)))
    assert {kind for kind, _ in shown} == {GestureKind.PINCH}
    assert shown[-1][1] == 2


@pytest.mark.parametrize("late", [0.05, 0.08])
def test_a_finger_that_touches_late_makes_the_push_a_pinch(late):
    player = Player(3)
    player.rest()
    steps = player.play(two([[6, 0], [-6, 0]], late, (1.0, 0.45)))
    assert kinds(steps) in ([GestureKind.PUSH, GestureKind.PINCH], [GestureKind.PINCH])
    both = next(i for i, (_, _, contacts, _) in enumerate(steps) if len(contacts) == 2)
    assert kinds(steps[both + 5 :]) == [GestureKind.PINCH]
    assert all(len(g.contacts_mm) == 2 for g, *_, mm in steps if mm >= 2.5)


def test_the_kind_lasts_from_the_attack_to_rest():
    rng = np.random.default_rng(31)
    for seed, kind in enumerate(KINDS * 2):
        player = Player(seed)
        player.rest()
        steps = player.play(random_scene(rng, kind))
        strong = next(i for i, (*_, mm) in enumerate(steps) if mm >= 2.5 or i == len(steps) - 1)
        if strong < len(steps) - 1:
            assert kinds(steps[strong + 5 :]) == [kind]
        assert steps[-1][0].kind is GestureKind.NONE


def test_a_new_gesture_may_be_another_one():
    player = Player()
    shown = []
    for kind in KINDS:
        player.rest()
        rng = np.random.default_rng(77)
        scene = random_scene(rng, kind, equal=True)
        size = np.linalg.norm(scene.peak, axis=1).max()
        shown += kinds(player.play(replace(scene, peak=scene.peak * (6 / size))))[-1:]
    assert shown == KINDS


def test_rest_tremor_and_knocks_are_no_gesture():
    player = Player(1, noise_px=0.25)
    wave = np.array([9.1, 7.3])
    for i in range(1500):
        tick = i / 100
        knock = 1.0 * np.sin(2 * np.pi * wave * tick) * np.exp(-((tick % 2.0) / 0.3))
        tremor = field(np.array([[6.0, 2.0]]), 0.1 * np.sin([[60 * tick, 50 * tick]]))
        assert player.see(tremor + knock).kind is GestureKind.NONE


def test_mistracked_markers_do_not_count():
    displacement = two([[5, 0], [-5, 0]]).at(0.5)[0]
    player = Player()
    player.rest()
    for _ in range(10):
        clean = player.see(displacement)
    spoiled = displacement.copy()
    spoiled[::19] += (0.0, 9.0)
    player = Player()
    player.rest()
    for _ in range(10):
        gesture = player.see(spoiled)
    assert gesture.kind is clean.kind
    assert len(gesture.contacts_mm) == 2
    assert gesture.intensity_mm == pytest.approx(clean.intensity_mm, abs=0.5)


def test_a_third_of_the_markers_hidden():
    scene = two([[5, 0], [-5, 0]])
    valid = PAPER_GEL.points_mm[:, 1] < 10.0
    player = Player()
    for i in range(60):
        displacement, _, intensity = scene.at(i / 100)
        displacement = np.where(valid[:, None], displacement, np.nan)
        gesture = player.see(displacement, valid)
        if intensity > 2.5:
            assert gesture.kind is GestureKind.PINCH
    assert player.see(displacement, np.zeros(177, bool)).kind is GestureKind.NONE


def test_equal_input_gives_equal_results_bit_for_bit():
    def run():
        player = Player(9)
        answers = []
        for kind in KINDS:
            for g, *_ in player.play(random_scene(player.rng, kind), 0.6):
                answers.append((g.kind, g.contacts_px.tobytes(), g.intensity_mm, g.confidence))
        return answers

    assert run() == run()


def test_confidence_is_the_share_of_right_kinds():
    """Of the slices called with 0.9 and more, more than nine in ten are right; below, fewer."""
    rng = np.random.default_rng(8)
    sure, unsure = [], []
    for seed in range(4):
        player = Player(seed)
        for kind in KINDS:
            for gesture, truth, *_ in player.play(random_scene(rng, kind), 1.4):
                right = gesture.kind is truth
                (sure if gesture.confidence >= 0.9 else unsure).append(right)
    assert len(unsure) > 20
    assert np.mean(sure) > 0.95
    assert np.mean(unsure) < 0.9


def test_a_still_finger_is_a_contact_of_the_pinch():
    player, centres = Player(), np.array([[9.0, 0.0], [-9.0, 0.0]])
    for size_mm in np.linspace(0.0, 4.0, 11).tolist() + [4.0] * 20:
        gesture = player.see(field(centres, np.array([[-size_mm, 0.0], [0.0, 0.0]])))
    assert gesture.kind is GestureKind.PINCH
    assert len(gesture.contacts_mm) == 2
    assert gesture.intensity_mm == pytest.approx(2.0, abs=0.2)


def test_a_still_finger_is_no_contact_of_a_pinch_that_ends():
    player, centres = Player(), np.array([[9.0, 0.0], [-9.0, 0.0]])
    down = np.linspace(4.0, 0.6, 35).tolist()
    for size_mm in [*np.linspace(0.0, 4.0, 11), *[4.0] * 20, *down, *[0.6] * 5]:
        gesture = player.see(field(centres, np.array([[-size_mm, 0.0], [0.0, 0.0]])))
    assert gesture.kind is GestureKind.PINCH
    assert len(gesture.contacts_mm) == 1


def test_the_command_line_offers_every_method():
    from neurotouch_hid.cli.run import command

    option = next(option for option in command.params if option.name == "method")
    assert option.type.get_metavar(option, None) == f"[{'|'.join(list_methods())}]"
    assert option.default == list_methods()[0]


def test_small_gestures_count_in_a_rig_that_was_bumped():
    player = Player()
    player.rest()
    for _ in range(120):  # no frame has shown the gel at rest since
        player.see(np.full(PAPER_GEL.points_mm.shape, 1.4))
    place = np.array([[3.0, -2.0]])
    shown = [
        player.see(1.4 + field(place, np.array([[size_mm, 0.0]]))).kind
        for size_mm in np.linspace(0.0, 2.0, 20)
    ]
    assert shown[-1] is GestureKind.PUSH
    assert shown.count(GestureKind.PUSH) >= 10


def test_contacts_are_shown_where_the_rig_has_moved_them():
    player = Player(noise_px=0.1)
    player.rest()
    place, bump_mm = np.array([[3.0, -2.0]]), np.array([2.0, 1.0])
    for size_mm in np.linspace(0.0, 4.0, 40):
        bump = bump_mm if size_mm > 2.0 else 0.0
        gesture = player.see(bump + field(place, np.array([[size_mm, 0.0]])))
    np.testing.assert_allclose(gesture.contacts_mm, place + np.array([4.0, 0.0]), atol=1.0)
    shown_px = RIG.to_px(gesture.contacts_mm + bump_mm)
    np.testing.assert_allclose(gesture.contacts_px, shown_px, atol=0.5)


def test_still_dots_make_no_limit_that_a_touch_on_a_swaying_gel_exceeds():
    """No fit explains a touch to the noise of dots that have kept still."""
    player, rng = Player(noise_px=0.01), np.random.default_rng(6)
    player.rest(200)
    unexplained = rng.normal(0.0, 0.09, PAPER_GEL.points_mm.shape)
    for size in np.linspace(0.1, 1.0, 10):
        sway = size * np.array([0.15, 0.0])
        touch = field(np.array([[3.0, -2.0]]), np.array([[0.7 * size, 0.0]]))
        gesture = player.see(touch + sway + size * unexplained)
    assert gesture.kind is GestureKind.PUSH

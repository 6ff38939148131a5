"""The shipped profiles: they parse, all of them can be reached, and they do what they say."""

import math
from functools import partial

import numpy as np
import pytest

from neurotouch_hid.messages import Axis, Button, GamepadState, Gesture, GestureKind
from neurotouch_hid.profile import Mapping, load_profile
from neurotouch_hid.profile.library import find_shipped_folder
from neurotouch_hid.profile.schema import Binding

NAMES = sorted(path.stem for path in find_shipped_folder().glob("*.yaml"))

MOST_MM = {
    GestureKind.PUSH: 17.5,
    GestureKind.PINCH: 12.0,
    GestureKind.ZOOM: 8.0,
    GestureKind.TWIST_CW: 12.0,
    GestureKind.TWIST_CCW: 12.0,
}
"""How far people go: the paper's figure for zoom and push, a cautious reading for the others."""


def gesture(kind: GestureKind, mm: float, way: tuple[float, float] = (1.0, 0.0)) -> Gesture:
    points = np.zeros((2, 2))
    return Gesture(0, kind, points, points, mm, (mm * way[0], mm * way[1]))


def shipped(name: str) -> Mapping:
    return Mapping(load_profile(find_shipped_folder() / f"{name}.yaml"))


def say(name: str, kind: GestureKind, mm: float, way: tuple[float, float] = (1.0, 0.0)) -> dict:
    """What is pressed and moved by one gesture from rest."""
    pad = shipped(name).update(gesture(kind, mm, way))
    return dict(pad.axes) | dict.fromkeys(pad.buttons, True)


@pytest.mark.parametrize("name", NAMES)
def test_it_parses_under_its_own_name_with_a_line_for_editors(name: str) -> None:
    path = find_shipped_folder() / f"{name}.yaml"
    assert load_profile(path).name == name
    assert load_profile(path).description
    first, *_ = path.read_text(encoding="utf-8").splitlines()
    assert first == "# yaml-language-server: $schema=schema/profile-1.json"
    assert (path.parent / "schema" / "profile-1.json").is_file()


@pytest.mark.parametrize("name", NAMES)
def test_every_binding_can_be_reached_to_its_end(name: str) -> None:
    for binding in load_profile(find_shipped_folder() / f"{name}.yaml").all_layers[0].bindings:
        most_mm = MOST_MM[binding.condition.kinds[0]]
        needed_mm = (
            binding.thresholds_mm[0]
            if is_button(binding)
            else binding.range_for(binding.condition.kinds[0])[1]
        )
        assert needed_mm <= most_mm - 0.96, binding  # the mean error of the intensity


def is_button(binding: Binding) -> bool:
    return not binding.is_followed


@pytest.mark.parametrize("name", NAMES)
def test_noise_at_rest_moves_nothing(name: str) -> None:
    for kind in GestureKind:
        assert shipped(name).update(gesture(kind, 1.0)).is_neutral
    assert shipped(name).update(gesture(GestureKind.NONE, 5.0)) == GamepadState(0)


@pytest.mark.parametrize("name", NAMES)
def test_buttons_keep_clear_of_the_analogue_range(name: str) -> None:
    """Whoever moves an axis to its end, give or take twice the mean error, presses nothing."""
    bindings = load_profile(find_shipped_folder() / f"{name}.yaml").all_layers[0].bindings
    for button in filter(is_button, bindings):
        on_mm, off_mm = button.thresholds_mm
        assert on_mm - off_mm >= 2 * 0.96
        for other in bindings:
            if not is_button(other) and other.condition.kinds == button.condition.kinds:
                assert on_mm >= other.range_for(other.condition.kinds[0])[1] + 2 * 0.96


def test_the_spacecraft_flies_as_in_the_paper() -> None:
    say_ = partial(say, "spacecraft")
    push, right, up = GestureKind.PUSH, (1.0, 0.0), (0.0, -1.0)
    assert say_(push, 8.0, right) == {Axis.LEFT_X: 1.0}
    assert say_(push, 8.0, up) == {Axis.LEFT_Y: -1.0}
    half = say_(push, 4.7, (math.sqrt(0.5), -math.sqrt(0.5)))
    assert half[Axis.LEFT_X] == -half[Axis.LEFT_Y]
    assert 0.1 < half[Axis.LEFT_X] < 0.5
    assert say_(GestureKind.TWIST_CW, 7.0) == {Axis.RIGHT_X: 1.0}
    assert say_(GestureKind.TWIST_CCW, 7.0) == {Axis.RIGHT_X: -1.0}
    assert say_(GestureKind.ZOOM, 4.5) == {Axis.RIGHT_TRIGGER: 1.0}
    assert say_(GestureKind.PINCH, 7.0) == {Axis.LEFT_TRIGGER: 1.0}
    assert all(say_(kind, 18.0).keys() <= set(Axis) for kind in GestureKind)


def test_the_default_is_a_controller_with_buttons_beyond_the_end() -> None:
    say_ = partial(say, "default")
    assert say_(GestureKind.PUSH, 17.5, (0.0, 1.0)) == {Axis.LEFT_Y: 1.0}
    assert say_(GestureKind.ZOOM, 5.5) == {Axis.RIGHT_TRIGGER: 1.0}
    assert say_(GestureKind.ZOOM, 7.0) == {Axis.RIGHT_TRIGGER: 1.0, Button.B: True}
    assert say_(GestureKind.PINCH, 8.5) == {Axis.LEFT_TRIGGER: 1.0}
    assert say_(GestureKind.PINCH, 10.0) == {Axis.LEFT_TRIGGER: 1.0, Button.A: True}
    assert say_(GestureKind.TWIST_CW, 10.0) == {Axis.RIGHT_X: 1.0, Button.RB: True}
    assert say_(GestureKind.TWIST_CCW, 10.0) == {Axis.RIGHT_X: -1.0, Button.LB: True}

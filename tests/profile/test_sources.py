"""What bindings can be about: zones, sectors, parts of a push, positions, speed, onset."""

import math

import numpy as np
import pytest

from neurotouch_hid.messages import Axis, GamepadState, Gesture, GestureKind
from neurotouch_hid.profile import Mapping
from neurotouch_hid.profile.engine.regions import EIGHT_WAYS, find_zone
from tests.profile.stage import RAW, make_profile, run, tell


def words(lines: list[str]) -> list[str]:
    return [line.split(" ", 1)[1] for line in lines]


def peak(states: list[GamepadState], axis: Axis) -> float:
    return max((state.axes.get(axis, 0.0) for state in states), key=abs)


@pytest.mark.parametrize(
    ("point", "zone"),
    [
        ((0, 0), "centre"),
        ((9, 0), "centre"),
        ((10, 0), None),
        ((13, 0), "right"),
        ((-20, 3), "left"),
        ((0, -20), "up"),
        ((2, 20), "down"),
        ((15, 15), None),
        ((15, 12.5), None),
        ((15, 12), "right"),
    ],
)
def test_zones_lie_4_mm_apart(point: tuple[float, float], zone: str | None) -> None:
    assert find_zone(*point) == zone


def test_a_zone_is_where_the_fingers_were_laid_however_far_they_push() -> None:
    profile = make_profile(
        "when: {gesture: push, zone: left}, do: {button: a}",
        "when: {gesture: push, zone: centre}, do: {button: b}",
    )
    assert words(tell(profile, "push right 16mm at -20 0")) == ["button a down", "button a up"]
    assert words(tell(profile, "push left 16mm")) == ["button b down", "button b up"]
    assert tell(profile, "push left 16mm at 11 0") == []


@pytest.mark.parametrize("way", EIGHT_WAYS)
def test_eight_sectors(way: str) -> None:
    profile = make_profile(
        *(
            f"when: {{gesture: push, direction: {name}, sectors: 8}}, do: {{dpad: {name}}}"
            for name in EIGHT_WAYS
        )
    )
    x, y = EIGHT_WAYS[way]
    states = run(Mapping(profile, RAW), f"push {way} 5mm")
    assert peak(states, Axis.DPAD_X) == round(x)
    assert peak(states, Axis.DPAD_Y) == round(y)


def test_parts_of_a_push_and_signed_twists() -> None:
    profile = make_profile(
        "when: push, do: {axis: left_x, follow: push_x, range_mm: [0, 10], deadzone: 0}",
        "when: push, do: {axis: left_y, follow: push_y, range_mm: [0, 10], deadzone: 0}",
        "when: twist, do: {axis: right_x, range_mm: [0, 10], deadzone: 0}",
        'when: scale, do: {axis: right_y, sign: "-", range_mm: [0, 10], deadzone: 0}',
    )
    states = run(Mapping(profile, RAW), "push 30deg 8mm")
    assert peak(states, Axis.LEFT_X) == pytest.approx(0.8 * math.cos(math.radians(30)))
    assert peak(states, Axis.LEFT_Y) == pytest.approx(0.4)
    for script, axis, value in [
        ("twist_cw 5mm", Axis.RIGHT_X, 0.5),
        ("twist_ccw 5mm", Axis.RIGHT_X, -0.5),
        ("zoom 5mm", Axis.RIGHT_Y, -0.5),
        ("pinch 5mm", Axis.RIGHT_Y, 0.5),
    ]:
        assert peak(run(Mapping(profile, RAW), script), axis) == pytest.approx(value), script


def test_a_position_moves_a_stick() -> None:
    profile = make_profile(
        "when: any, do: {stick: right, follow: position, range_mm: [2, 18], deadzone: 0}"
    )
    states = run(Mapping(profile, RAW), "pinch 5mm at -10 0")
    assert peak(states, Axis.RIGHT_X) == pytest.approx(-0.5)


def test_speed_moves_an_axis_and_slows_down_again() -> None:
    profile = make_profile("when: pinch, do: {trigger: left, follow: speed}")
    fast = peak(run(Mapping(profile, RAW), "pinch 8mm 60ms"), Axis.LEFT_TRIGGER)
    slow = peak(run(Mapping(profile, RAW), "pinch 8mm 1s"), Axis.LEFT_TRIGGER)
    assert fast > 0.5 > slow
    held = run(Mapping(profile, RAW), "pinch 8mm 60ms hold 1s")[90]
    assert held.axes.get(Axis.LEFT_TRIGGER, 0.0) == 0.0


def test_a_centre_an_axial_dead_zone_and_a_slew_limit() -> None:
    shape = "range_mm: [0, 10], deadzone: 0.5, deadzone_shape: axial, centre_mm: [0, 1]"
    profile = make_profile(f"when: push, do: {{stick: left, {shape}}}")
    states = run(Mapping(profile, RAW), "push 45deg 9mm")
    part = 9 * math.sqrt(0.5)
    assert peak(states, Axis.LEFT_X) == pytest.approx((part - 5) / 5)
    assert peak(states, Axis.LEFT_Y) == pytest.approx((part - 1 - 5) / 5)
    limited = make_profile("when: pinch, do: {trigger: left, slew_per_s: 2}")
    states = run(Mapping(limited, RAW), "pinch 9mm 10ms hold 1s release 0ms")
    values = [state.axes.get(Axis.LEFT_TRIGGER, 0.0) for state in states]
    steps = np.diff(values)
    assert steps.max() == pytest.approx(0.02)
    assert max(values) == 1.0
    assert steps.min() == -1.0, "letting go is never delayed"


def stream(*parts: tuple[GestureKind, float, int]) -> list[Gesture]:
    points = np.zeros((2, 2))
    gestures = []
    for kind, mm, slices in parts:
        for _ in range(slices):
            t_us = len(gestures) * 10_000
            gestures.append(Gesture(t_us, kind, points, points, mm, (mm, 0.0)))
    return gestures


PUSH, ZOOM, NONE = GestureKind.PUSH, GestureKind.ZOOM, GestureKind.NONE
BOTH = ("when: push, do: {button: a}", "when: zoom, do: {button: b}")


def pressed(profile_lines: tuple[str, ...], gestures: list[Gesture], more: str = "") -> str:
    mapping = Mapping(make_profile(*profile_lines, more=more), RAW)
    states = [mapping.update(gesture).buttons for gesture in gestures]
    return "".join("".join(sorted(state)) or "." for state in states)


def test_a_recognised_gesture_stays_what_it_is() -> None:
    flicker = stream((PUSH, 5, 3), (ZOOM, 5, 2), (PUSH, 5, 2), (ZOOM, 1, 2), (ZOOM, 5, 2))
    assert pressed(BOTH, flicker) == "aaaaaaa..bb"
    assert pressed(BOTH, flicker, "latch: false") == "aaabbaa..bb"


def test_a_push_keeps_its_way_while_it_looks_like_something_else() -> None:
    profile = make_profile("when: push, do: {stick: left}", "when: zoom, do: {button: b}")
    mapping = Mapping(profile, RAW)
    points = np.zeros((2, 2))
    ways = [(5.0, 0.0), (0.1, -0.3), (5.0, 0.0)]
    kinds = [PUSH, ZOOM, PUSH]
    states = [
        mapping.update(Gesture(10_000 * i, kind, points, points, 5.0, way))
        for i, (kind, way) in enumerate(zip(kinds, ways, strict=True))
    ]
    assert states[0].axes == states[1].axes == states[2].axes


def test_what_nobody_waits_for_is_not_kept() -> None:
    late = stream((PUSH, 5, 3), (ZOOM, 5, 3))
    assert pressed(("when: zoom, do: {button: b}",), late) == "...bbb"


def test_an_onset_is_watched_where_a_push_could_become_something_else() -> None:
    lines = ("when: {gesture: push, on_mm: 1, off_mm: 0.5}, do: {button: a}", BOTH[1])
    onset = stream((PUSH, 2, 10), (NONE, 0, 1))
    assert pressed(lines, onset) == ".......aaa."
    assert pressed(lines[:1], onset) == "aaaaaaaaaa."
    assert pressed(lines, stream((PUSH, 2, 2), (ZOOM, 3, 3))) == "..bbb"

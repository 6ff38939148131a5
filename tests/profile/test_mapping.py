"""Golden timelines: what the pad says, gesture by gesture."""

import math
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from neurotouch_hid.messages import Axis, Button, GamepadState, Gesture, GestureKind
from neurotouch_hid.profile import Mapping, Profile, UserSettings, list_profiles, load_profile
from neurotouch_hid.profile.mapping import SILENCE_US
from tests.profile import stage

SLICE_US = 10_000
make_profile = partial(stage.make_profile, more="latch: false")


def gesture(
    kind: GestureKind = GestureKind.NONE,
    mm: float = 0.0,
    degrees: float = 0.0,
    contacts: int = 1,
    t_us: int = SLICE_US,
) -> Gesture:
    """A gesture; ``degrees`` is the way of a push, 0 right, 90 down (gel coordinates)."""
    way = math.radians(degrees)
    points = np.zeros((contacts, 2))
    return Gesture(t_us, kind, points, points, mm, (mm * math.cos(way), mm * math.sin(way)))


def push(mm: float, degrees: float, contacts: int = 1) -> Gesture:
    return gesture(GestureKind.PUSH, mm, degrees, contacts)


def play(profile: Profile, *gestures: Gesture) -> list[str]:
    """What the pad says after each: pressed buttons and axes that are not at rest."""
    mapping = Mapping(profile, stage.RAW)
    return [
        describe(mapping.update(replace(gesture, t_us=i * SLICE_US)))
        for i, gesture in enumerate(gestures)
    ]


def describe(pad: GamepadState) -> str:
    axes = [f"{axis.value}={value:+.2f}" for axis, value in sorted(pad.axes.items())]
    return " ".join([*sorted(button.value for button in pad.buttons), *axes])


NONE = gesture()


def test_a_push_moves_the_stick_the_way_it_goes() -> None:
    profile = make_profile("when: push, do: {stick: left, range_mm: [1, 9], deadzone: 0}")
    assert play(
        profile,
        push(9, 0),
        push(9, 90),
        push(9, 180),
        push(9, 270),
        push(5, 0),
        push(1, 0),
        push(18, 45),
        NONE,
    ) == [
        "left_x=+1.00",
        "left_x=+0.00 left_y=+1.00",
        "left_x=-1.00 left_y=+0.00",
        "left_x=-0.00 left_y=-1.00",
        "left_x=+0.50",
        "",
        "left_x=+0.71 left_y=+0.71",
        "",
    ]


def test_the_magnitude_is_the_intensity_and_the_way_is_the_translation() -> None:
    profile = make_profile("when: push, do: {stick: right, range_mm: [0, 10], deadzone: 0}")
    points = np.zeros((1, 2))
    sideways = Gesture(0, GestureKind.PUSH, points, points, 5.0, (0.3, 0.4))
    assert play(profile, sideways) == ["right_x=+0.30 right_y=+0.40"]


def test_inverting_swaps_one_way_only() -> None:
    profile = make_profile(
        "when: push, do: {stick: left, range_mm: [0, 10], deadzone: 0, invert_y: true}",
        "when: push, do: {stick: right, range_mm: [0, 10], deadzone: 0, invert_x: true}",
    )
    assert play(profile, push(5, 45)) == [
        "left_x=+0.35 left_y=-0.35 right_x=-0.35 right_y=+0.35",
    ]


def test_twists_move_one_axis_to_both_sides() -> None:
    profile = make_profile(
        "when: twist_cw, do: {axis: right_x, range_mm: [1, 5], deadzone: 0}",
        'when: twist_ccw, do: {axis: right_x, sign: "-", range_mm: [1, 5], deadzone: 0}',
    )
    cw, ccw = GestureKind.TWIST_CW, GestureKind.TWIST_CCW
    assert play(profile, gesture(cw, 3), gesture(ccw, 4), gesture(ccw, 9), NONE) == [
        "right_x=+0.50",
        "right_x=-0.75",
        "right_x=-1.00",
        "",
    ]


def test_a_button_presses_and_lets_go_at_two_thresholds() -> None:
    profile = make_profile("when: pinch, do: {button: a}")
    levels = (1.0, 2.4, 2.5, 1.6, 1.5, 1.4, 2.4, 2.5)
    timeline = play(profile, *(gesture(GestureKind.PINCH, mm) for mm in levels))
    assert timeline == ["", "", "a", "a", "a", "", "", "a"]


def test_only_the_bound_gesture_holds_the_button() -> None:
    profile = make_profile("when: {gesture: pinch, on_mm: 4, off_mm: 2}, do: {button: a}")
    pinch, zoom = GestureKind.PINCH, GestureKind.ZOOM
    timeline = play(
        profile, gesture(zoom, 9), gesture(pinch, 5), gesture(zoom, 5), gesture(pinch, 3)
    )
    assert timeline == ["", "a", "", ""]


def test_an_axis_with_thresholds_waits_for_them() -> None:
    profile = make_profile(
        "when: {gesture: zoom, on_mm: 3, off_mm: 2}, "
        "do: {trigger: right, range_mm: [0, 4], deadzone: 0}"
    )
    timeline = play(profile, *(gesture(GestureKind.ZOOM, mm) for mm in (2.9, 3.0, 2.0, 1.9, 2.5)))
    assert timeline == ["", "right_trigger=+0.75", "right_trigger=+0.50", "", ""]


FOUR_WAYS = [
    f"when: {{gesture: push, direction: {way}}}, do: {{dpad: {way}}}"
    for way in ("left", "right", "up", "down")
]


def test_pushes_press_the_dpad_by_sectors() -> None:
    profile = make_profile(*FOUR_WAYS)
    ways = {
        0: "dpad_x=+1.00",
        44: "dpad_x=+1.00",
        46: "dpad_y=+1.00",
        134: "dpad_y=+1.00",
        136: "dpad_x=-1.00",
        224: "dpad_x=-1.00",
        226: "dpad_y=-1.00",
        314: "dpad_y=-1.00",
        316: "dpad_x=+1.00",
    }
    for degrees, expected in ways.items():
        assert play(profile, push(3, degrees)) == [expected], degrees


def test_a_diagonal_push_does_not_flicker_between_sectors() -> None:
    profile = make_profile(*FOUR_WAYS)
    degrees = (40, 50, 44, 59, 61, 40, 31, 29)
    right, down = "dpad_x=+1.00", "dpad_y=+1.00"
    timeline = play(profile, *(push(3, way) for way in degrees))
    assert timeline == [right, right, right, right, down, down, down, right]
    assert play(profile, push(3, 40), NONE, push(3, 50)) == [right, "", down]


def test_contacts_narrow_a_binding() -> None:
    profile = make_profile("when: {gesture: push, contacts: 2}, do: {button: x}")
    assert play(profile, *(push(9, 0, n) for n in (1, 2, 3, 2))) == ["", "x", "", "x"]


def test_on_one_axis_the_larger_magnitude_wins_then_the_earlier() -> None:
    low = 'axis: left_x, sign: "-", range_mm: [0, 10], deadzone: 0'
    high = "axis: left_x, range_mm: [0, 5], deadzone: 0"
    for order in (
        (f"when: pinch, do: {{{low}}}", f"when: pinch, do: {{{high}}}"),
        (f"when: pinch, do: {{{high}}}", f"when: pinch, do: {{{low}}}"),
    ):
        timeline = play(make_profile(*order), gesture(GestureKind.PINCH, 4))
        assert timeline == ["left_x=+0.80"]
    tie = make_profile(f"when: pinch, do: {{{low}}}", f"when: pinch, do: {{{high}}}")
    assert play(tie, gesture(GestureKind.PINCH, 12)) == ["left_x=-1.00"]


@pytest.mark.parametrize(
    ("kind", "full_mm"),
    [
        (GestureKind.PUSH, 8.0),
        (GestureKind.PINCH, 7.0),
        (GestureKind.ZOOM, 4.5),
        (GestureKind.TWIST_CW, 7.0),
        (GestureKind.TWIST_CCW, 7.0),
    ],
)
def test_where_a_profile_says_nothing_each_gesture_has_its_range(
    kind: GestureKind, full_mm: float
) -> None:
    profile = make_profile(f"when: {kind.label}, do: {{trigger: left}}")
    edge_mm = 1.0 + 0.05 * (full_mm - 1.0)
    levels = (edge_mm, edge_mm + 0.1, full_mm - 0.1, full_mm)
    rest, begun, nearly, full = play(profile, *(gesture(kind, mm) for mm in levels))
    assert (rest, full) == ("", "left_trigger=+1.00")
    assert "left_trigger=+0.01" <= begun <= "left_trigger=+0.04"
    assert "left_trigger=+0.96" <= nearly <= "left_trigger=+0.99"


def test_two_bindings_can_hold_one_button() -> None:
    profile = make_profile("when: pinch, do: {button: a}", "when: zoom, do: {button: a}")
    pinch, zoom = GestureKind.PINCH, GestureKind.ZOOM
    assert play(profile, gesture(pinch, 3), gesture(zoom, 3), NONE) == ["a", "a", ""]


EVERYTHING = make_profile(
    "when: push, do: {stick: left}",
    "when: {gesture: push, direction: up}, do: {dpad: up}",
    "when: {gesture: push, direction: down, contacts: 2}, do: {button: y}",
    "when: pinch, do: {trigger: left, curve: {power: 2}}",
    "when: pinch, do: {button: a}",
    "when: zoom, do: {trigger: right, curve: {expo: 1}}",
    "when: twist_cw, do: {axis: right_x}",
    'when: twist_ccw, do: {axis: right_y, sign: "-"}',
)
WILD = st.floats(allow_nan=True, allow_infinity=True)


@st.composite
def gestures(draw: st.DrawFn) -> Gesture:
    points = np.zeros((draw(st.integers(0, 3)), 2))
    kind = draw(st.sampled_from(GestureKind))
    size = draw(st.one_of(st.floats(0, 20), WILD))
    way = draw(st.tuples(WILD, WILD))
    return Gesture(draw(st.integers()), kind, points, points, size, way)


@settings(derandomize=True, deadline=None)
@given(st.lists(gestures(), max_size=20))
def test_whatever_comes_in_the_pad_is_sound(stream: list[Gesture]) -> None:
    mapping, again = Mapping(EVERYTHING), Mapping(EVERYTHING)
    for gesture_ in stream:
        pad = mapping.update(gesture_)
        assert pad == again.update(gesture_)
        assert pad.t_us == gesture_.t_us
        for axis, value in pad.axes.items():
            low = 0.0 if axis in (Axis.LEFT_TRIGGER, Axis.RIGHT_TRIGGER) else -1.0
            assert low <= value <= 1.0
        if gesture_.kind == GestureKind.NONE or not math.isfinite(gesture_.intensity_mm):
            assert pad == GamepadState(gesture_.t_us)
            assert pad.is_neutral


@pytest.mark.parametrize("wrong", [math.nan, math.inf, -math.inf])
def test_a_measurement_that_is_no_number_lets_go(wrong: float) -> None:
    profile = make_profile("when: pinch, do: {button: a}")
    pinch = GestureKind.PINCH
    timeline = play(profile, gesture(pinch, 5), gesture(pinch, wrong), gesture(pinch, 2))
    assert timeline == ["a", "", ""]


def test_a_push_without_a_way_moves_nothing() -> None:
    points = np.zeros((1, 2))
    for way in ((0.0, 0.0), (math.nan, 1.0), (math.inf, 0.0)):
        lost = Gesture(0, GestureKind.PUSH, points, points, 9.0, way)
        assert (
            Mapping(make_profile(*FOUR_WAYS, "when: push, do: {stick: left}"), stage.RAW)
            .update(lost)
            .is_neutral
        )


def test_two_steps_at_one_time_release_nothing() -> None:
    mapping = Mapping(
        make_profile("when: push, do: {stick: left, range_mm: [1, 9], deadzone: 0}"), stage.RAW
    )
    for t_us in (0, SLICE_US, SLICE_US):
        pad = mapping.update(replace(push(9, 0), t_us=t_us))
        assert describe(pad) == "left_x=+1.00"


def test_after_a_silence_a_gesture_is_read_as_if_it_had_just_begun() -> None:
    profile = make_profile("when: push, do: {stick: left, range_mm: [1, 9], deadzone: 0}")
    mapping, new = Mapping(profile), Mapping(profile)
    for k in range(20):
        mapping.update(replace(push(0.5 * k, 90), t_us=k * SLICE_US))
    late = replace(push(5, 0), t_us=30 * SLICE_US + SILENCE_US)
    for each in (mapping, new):
        each.update(late)
    one, other = (
        replace(each.reading, speed_mm_s=0.0, top_speed_mm_s=0.0) for each in (mapping, new)
    )
    assert one == other
    assert one.t_us == late.t_us


def test_the_pad_speaks_the_records_words() -> None:
    profile = make_profile(*(f"when: pinch, do: {{button: {button}}}" for button in Button))
    pad = Mapping(profile, stage.RAW).update(gesture(GestureKind.PINCH, 5))
    assert pad.buttons == frozenset(Button)
    assert all(isinstance(button, Button) for button in pad.buttons)


SHIPPED = {name: load_profile(path) for name, path in list_profiles().items()}
PEOPLE = (
    UserSettings(),
    UserSettings(timing="slow", mirror=True, rotate_deg=33.0, neutral="resting"),
    UserSettings.model_validate({"range": {"push_left": {"full": 2.0}, "zoom": {"full": 1.6}}}),
)


@settings(derandomize=True, deadline=None, max_examples=40)
@given(st.lists(st.tuples(gestures(), st.integers(-5, 3)), max_size=30), st.sampled_from(PEOPLE))
def test_no_stream_harms_a_shipped_profile(
    stream: list[tuple[Gesture, int]], user: UserSettings
) -> None:
    for profile in SHIPPED.values():
        mapping, again, t_us = Mapping(profile, user), Mapping(profile, user), 0
        for wild, step in stream:
            t_us += 10 ** (step + 3) if step >= 0 else step
            gesture_ = replace(wild, t_us=t_us)
            pad = mapping.update(gesture_)
            assert pad == again.update(gesture_)
            assert all(-1.0 <= value <= 1.0 for value in pad.axes.values())
            assert all(math.isfinite(value) for value in (*pad.pointer, pad.wheel))

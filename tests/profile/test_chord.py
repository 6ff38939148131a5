"""A gesture together with a button of the device that plays along."""

import pytest

from neurotouch_hid.messages import Button
from neurotouch_hid.profile import Mapping
from neurotouch_hid.profile.diagnostics.description import describe_binding
from neurotouch_hid.profile.editing.binding_words import parse_when
from neurotouch_hid.profile.rehearsal.script import rehearse
from tests.profile.stage import RAW, make_profile, shift

CHORD = make_profile("when: {gesture: pinch, with_button: x}, do: {button: a}")
PINCH = list(rehearse("pinch 6mm hold 600ms"))
"""It lies clearly above its threshold from its tenth to its last quarter."""


@pytest.mark.parametrize(
    ("held", "acts"),
    [
        (range(0), False),
        (range(1000), True),
        (range(25, 1000), True),  # the gesture first
        (range(40), True),  # the button first
        (range(3), False),
    ],
)
def test_a_chord_acts_while_both_are_there_in_any_order(held, acts):
    mapping = Mapping(CHORD, RAW)
    down = []
    for number, gesture in enumerate(PINCH):
        mapping.set_helper_buttons(frozenset({Button.X} if number in held else ()))
        if mapping.update(gesture).buttons:
            down.append(number)
    assert bool(down) is acts
    assert all(number in held for number in down)


def test_another_button_does_not_count():
    mapping = Mapping(CHORD, RAW)
    mapping.set_helper_buttons(frozenset({Button.Y}))
    assert not any(mapping.update(gesture).buttons for gesture in PINCH)


def test_its_words():
    assert describe_binding(CHORD.bindings[0]) == "pinch while x is held -> button a"
    assert parse_when("pinch while x is held") == {"gesture": "pinch", "with_button": "x"}


BESIDE = make_profile(
    "when: {gesture: pinch, with_button: x}, do: {button: a}",
    "when: pinch, do: {button: b}",
    "when: pinch, do: {trigger: left}",
    "when: zoom, do: {button: y}",
    "when: {gesture: pinch, press: hold, hold_ms: 900}, do: {command: pause}",
)
A, B = frozenset({Button.A}), frozenset({Button.B})


def play(mapping, held, script="pinch 6mm hold 600ms", start_us=0):
    """The states while X is held at the slices that ``held`` names."""
    states = []
    for number, gesture in enumerate(rehearse(script)):
        mapping.set_helper_buttons(frozenset({Button.X} if number in held else ()))
        states.append(mapping.update(shift(gesture, start_us)))
    return states


def test_a_chord_wins_over_what_is_bound_to_the_gesture_itself():
    states = play(Mapping(BESIDE, RAW), range(1000))
    assert {state.buttons for state in states} == {frozenset(), A}
    assert not any(state.axes for state in states)


def test_without_its_button_all_is_as_ever():
    states = play(Mapping(BESIDE, RAW), range(0))
    assert {state.buttons for state in states} == {frozenset(), B}
    assert any(state.axes for state in states)


def test_a_button_that_comes_later_takes_the_gesture_over():
    states = play(Mapping(BESIDE, RAW), range(30, 1000))
    assert [state.buttons for state in states[29:31]] == [B, A]
    assert [bool(state.axes) for state in states[29:31]] == [True, False]


def test_once_its_button_is_let_go_a_press_waits_and_a_trigger_goes_on():
    mapping = Mapping(BESIDE, RAW)
    states = play(mapping, range(30))
    assert [state.buttons for state in states[29:31]] == [A, frozenset()]
    assert not any(state.buttons for state in states[30:])
    assert not states[29].axes
    assert states[30].axes
    again = play(mapping, range(0), start_us=states[-1].t_us + 10_000)
    assert any(state.buttons == B for state in again), "the next gesture is anybody's"


def test_another_gesture_is_not_the_chords():
    states = play(Mapping(BESIDE, RAW), range(1000), "zoom 6mm")
    assert any(state.buttons == {Button.Y} for state in states)


def test_only_a_push_in_the_chords_direction_is_its_own():
    profile = make_profile(
        "when: {gesture: push, direction: left, with_button: x}, do: {button: a}",
        "when: push, do: {stick: left}",
    )
    left, right = (play(Mapping(profile, RAW), range(1000), f"push {way} 8mm") for way in WAYS)
    assert any(state.buttons == A for state in left)
    assert not any(state.axes for state in left)
    assert not any(state.buttons for state in right)
    assert any(state.axes for state in right)


WAYS = ("left", "right")


@pytest.mark.parametrize("press", ["press: tap", "trigger: release"])
def test_a_gesture_that_is_taken_over_is_no_tap_and_no_release(press):
    profile = make_profile(
        "when: {gesture: pinch, with_button: x}, do: {button: a}",
        f"when: {{gesture: pinch, {press}}}, do: {{button: b}}",
    )
    states = play(Mapping(profile, RAW), range(14, 1000), "pinch 6mm hold 150ms")
    assert any(state.buttons == A for state in states)
    assert not any(Button.B in state.buttons for state in states)


def test_what_is_toggled_stays_while_a_chord_acts():
    profile = make_profile(
        "when: {gesture: pinch, with_button: x}, do: {button: a}",
        "when: pinch, do: {button: b, mode: toggle}",
    )
    mapping = Mapping(profile, RAW)
    on = play(mapping, range(0))[-1]
    assert on.buttons == B
    states = play(mapping, range(1000), start_us=on.t_us + 10_000)
    assert {state.buttons for state in states} == {B, A | B}


def test_what_pauses_is_heard_beside_a_chord():
    mapping = Mapping(BESIDE, RAW)
    play(mapping, range(1000), "pinch 6mm hold 1500ms")
    assert mapping.state == "paused"


def test_a_sequence_does_not_count_a_chords_gesture():
    profile = make_profile(
        "when: {gesture: pinch, with_button: x}, do: {button: a}",
        "when: {sequence: [zoom, pinch]}, do: {button: b}",
    )
    mapping = Mapping(profile, RAW)
    zoom = play(mapping, range(0), "zoom 6mm; rest 100ms")[-1]
    states = play(mapping, range(1000), start_us=zoom.t_us + 10_000)
    assert {state.buttons for state in states} == {frozenset(), A}


def test_it_is_told_why_the_other_did_not_act():
    mapping = Mapping(BESIDE, RAW)
    play(mapping, range(1000))
    ignored = [str(each) for each in mapping.decisions() if each.verdict == "ignored"]
    assert ignored[0] == "ignored: pinch -> button b, because it is a chord's"
    assert len(ignored) <= 2

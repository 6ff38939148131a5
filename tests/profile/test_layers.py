"""Layers, pause and panic: what a change lets go of, and when it acts again."""

from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from neurotouch_hid.messages import Button, GamepadState
from neurotouch_hid.profile import Mapping, Profile, UserSettings, load_profile, rehearse
from neurotouch_hid.profile.reading.library import list_profiles
from neurotouch_hid.profile.reading.load import parse_profile
from tests.profile.stage import RAW, make_profile, run, tell

LAYERS = """
version: 1
name: x
layers:
  - name: walk
    bindings:
      - {when: pinch, do: {button: a, mode: toggle}}
      - {when: push, do: {stick: left}}
      - {when: zoom, do: {layer: menu, mode: %s}}
      - {when: {gesture: twist_ccw, press: tap}, do: {button: x}}
  - name: menu
    below: %s
    bindings:
      - {when: {gesture: push, direction: left}, do: {button: b}}
      - {when: twist_cw, do: {button: y}}
      - {when: {gesture: twist_ccw, press: hold}, do: {layer: walk}}
"""


def layers(mode: str = "toggle", below: str = "inherit") -> Profile:
    return parse_profile((LAYERS % (mode, below)).encode(), "x.yaml")


def last(mapping: Mapping, script: str, start_us: int = 0) -> GamepadState:
    return run(mapping, script, start_us)[-1]


def test_a_change_lets_go_of_everything_and_waits_for_the_next_gesture() -> None:
    mapping = Mapping(layers(), RAW)
    states = run(mapping, "pinch 5mm tap; rest 100ms; zoom 5mm hold 1s")
    assert states[15].buttons == {Button.A}
    assert states[-1].is_neutral
    assert mapping.layer == "menu"
    t_us = states[-1].t_us + 10_000
    assert any(Button.Y in state.buttons for state in run(mapping, "twist_cw 5mm", t_us))


def test_an_upper_layer_covers_only_what_it_binds() -> None:
    steps = "zoom 5mm tap; rest 100ms; {}"
    for below, script, button in [
        ("inherit", "push left 5mm", Button.B),
        ("inherit", "pinch 5mm", Button.A),
        ("empty", "push left 5mm", Button.B),
        ("empty", "pinch 5mm", None),
    ]:
        states = run(Mapping(layers(below=below), RAW), steps.format(script))
        pressed = frozenset().union(*(state.buttons for state in states))
        assert pressed == ({button} if button else frozenset()), (below, script)
    states = run(Mapping(layers(), RAW), steps.format("push right 8mm"))
    assert any(state.axes for state in states), "a push to the left covers no push to the right"


@pytest.mark.parametrize(
    ("below", "script", "layer"),
    [
        ("inherit", "zoom 5mm tap", "walk"),  # what led there leads back
        ("empty", "zoom 5mm tap", "menu"),
        ("empty", "twist_ccw 5mm tap", "menu"),
        ("empty", "twist_ccw 5mm hold 600ms", "walk"),
    ],
)
def test_the_way_back(below: str, script: str, layer: str) -> None:
    mapping = Mapping(layers(below=below), RAW)
    states = run(mapping, "zoom 5mm tap; rest 100ms")
    assert mapping.layer == "menu"
    run(mapping, script, states[-1].t_us + 10_000)
    assert mapping.layer == layer


def test_a_layer_for_one_action() -> None:
    mapping = Mapping(layers("oneshot"), RAW)
    twist = "twist_cw 5mm tap; rest 100ms"
    states = run(mapping, f"zoom 5mm tap; rest 100ms; {twist}; {twist}")
    pressed = [Button.Y in state.buttons for state in states]
    assert sum(now and not before for before, now in pairwise(pressed)) == 1
    assert mapping.layer == "walk"


@pytest.mark.parametrize("timing", ["game", "steady"])
def test_a_held_layer_ends_with_its_gesture(timing: str) -> None:
    mapping = Mapping(layers("hold"), UserSettings(filter="none", timing=timing))
    names = []
    for gesture in rehearse("zoom 5mm hold 600ms; rest 100ms; zoom 5mm hold 600ms; rest 100ms"):
        assert mapping.update(gesture).is_neutral
        names.append(mapping.layer)
    changes = [name for before, name in pairwise(["", *names]) if name != before]
    assert changes == ["walk", "menu", "walk", "menu", "walk"]
    assert names.count("menu") > 100


SAFETY = """safety:
  pause: {gesture: pinch, hold_ms: 1000}
  panic: {gesture: zoom, hold_ms: 1000}"""
BUSY = ("when: twist_cw, do: {button: a, mode: toggle}", "when: push, do: {stick: left}")


def commands(states: list[GamepadState]) -> list[str]:
    return [command for state in states for command in state.commands]


def test_pause_lets_go_and_the_same_gesture_goes_on() -> None:
    mapping = Mapping(make_profile(*BUSY, more=SAFETY), RAW)
    states = run(mapping, "twist_cw 5mm tap; rest 50ms; pinch 5mm hold 1200ms; push left 8mm")
    assert commands(states) == ["pause"]
    paused_at = next(i for i, state in enumerate(states) if state.commands)
    assert states[paused_at - 1].buttons == {Button.A}
    assert all(state.is_neutral for state in states[paused_at:])
    assert mapping.state == "paused"
    states = run(mapping, "pinch 5mm hold 1200ms; push left 8mm", states[-1].t_us + 10_000)
    assert commands(states) == ["resume"]
    assert any(state.axes for state in states)
    assert not any(state.buttons for state in states), "what was toggled does not come back"


def test_nothing_on_the_gel_goes_on_after_a_panic() -> None:
    mapping = Mapping(make_profile(*BUSY, more=SAFETY), RAW)
    states = run(
        mapping, "zoom 5mm hold 1200ms; push left 8mm; pinch 5mm hold 2s; zoom 5mm hold 2s"
    )
    assert commands(states) == ["panic"]
    assert mapping.state == "panic"
    panicked_at = next(i for i, state in enumerate(states) if state.commands)
    assert all(state.is_neutral for state in states[panicked_at:])
    mapping.resume()
    states = run(mapping, "push left 8mm", states[-1].t_us + 10_000)
    assert commands(states) == ["resume"]
    assert any(state.axes for state in states)


def test_a_pause_from_outside_waits_for_the_next_gesture() -> None:
    mapping = Mapping(make_profile(*BUSY), RAW)
    seen = []
    for i, gesture in enumerate(rehearse("push left 8mm hold 500ms; push left 8mm")):
        if i == 20:
            mapping.pause()
        if i == 25:
            mapping.resume()
        seen.append(mapping.update(gesture))
    assert seen[19].axes
    assert seen[20].commands == ("pause",)
    assert seen[25].commands == ("resume",)
    assert all(state.is_neutral for state in seen[20:81])
    assert any(state.axes for state in seen[81:])


def test_commands_from_bindings() -> None:
    profile = make_profile(
        "when: pinch, do: {command: pause}",
        "when: zoom, do: {command: next_profile}",
        "when: twist_cw, do: {command: rezero}",
        "when: twist_ccw, do: {command: panic}",
    )
    mapping = Mapping(profile, RAW)
    script = (
        "zoom 5mm; twist_cw 5mm; pinch 5mm; zoom 5mm; pinch 5mm; zoom 5mm; twist_ccw 5mm; pinch 5mm"
    )
    assert commands(run(mapping, script)) == [
        *("next_profile", "rezero", "pause", "resume", "next_profile", "panic"),
    ]


def test_switching_the_profile_lets_go_first() -> None:
    mapping = Mapping(make_profile("when: pinch, do: {button: a}"), RAW)
    other = make_profile("when: pinch, do: {button: b}")
    pressed = []
    for i, gesture in enumerate(rehearse("pinch 5mm hold 500ms; pinch 5mm")):
        if i == 30:
            mapping.switch(other)
        pressed.append(mapping.update(gesture).buttons)
    assert pressed[29] == {Button.A}
    assert not any(pressed[30:80])
    assert frozenset({Button.B}) in pressed[80:]


def test_a_gap_in_the_stream_lets_go() -> None:
    mapping = Mapping(make_profile("when: pinch, do: {button: a, mode: toggle}"), RAW)
    states = run(mapping, "pinch 5mm tap")
    assert states[-1].buttons == {Button.A}
    assert run(mapping, "rest 10ms", states[-1].t_us + 150_000)[0].buttons == {Button.A}
    assert run(mapping, "rest 10ms", states[-1].t_us + 900_000)[0].is_neutral


STEP = st.tuples(
    st.sampled_from(
        [
            *(f"push {way}" for way in ("left", "right", "up", "down", "up_left")),
            *("pinch", "zoom", "twist_cw", "twist_ccw"),
        ]
    ),
    st.integers(1, 14),
    st.sampled_from(["tap", "40ms hold 20ms", "100ms hold 500ms", "300ms hold 2s"]),
    st.sampled_from(["", "; rest 30ms", "; rest 300ms"]),
)


def never_stuck(profile: Profile) -> bool:
    kept = ("toggle", "sticky", "oneshot")
    return not any(
        binding.mode in kept and not hasattr(binding.do, "layer")
        for layer in profile.all_layers
        for binding in layer.bindings
    )


@settings(max_examples=8, derandomize=True, deadline=None)
@given(timing=st.sampled_from(["game", "slow"]), steps=st.lists(STEP, min_size=1, max_size=5))
def test_after_rest_nothing_is_pressed_and_panic_lets_go_of_all(timing: str, steps: list) -> None:
    script = "; ".join(f"{name} {mm}mm {how}{rest}" for name, mm, how, rest in steps)
    for name in list_profiles():
        profile = load_profile(name)
        mapping = Mapping(profile, UserSettings(timing=timing))
        states = run(mapping, script + "; rest 2s")
        if never_stuck(profile):
            assert states[-1].is_neutral, name
        mapping.panic()
        assert run(mapping, script, states[-1].t_us + 10_000)[-1].is_neutral
        again = Mapping(profile, UserSettings(timing=timing))
        assert run(again, script + "; rest 2s") == states, "the same in, the same out"


def test_the_journal_tells_what_happened() -> None:
    mapping = Mapping(make_profile("when: pinch, do: {button: a, mode: toggle}"), RAW)
    run(mapping, "pinch 5mm tap")
    assert [str(decision) for decision in mapping.decisions()] == [
        "pressed: pinch -> toggle button a"
    ]
    assert tell(make_profile("when: pinch, do: {button: a}"), "pinch 1mm") == []

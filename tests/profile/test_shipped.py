"""The shipped profiles: they parse, all of them can be reached, and they do what they say."""

import math
from functools import partial

import numpy as np
import pytest

from neurotouch_hid.messages import Axis, Button, GamepadState, Gesture, GestureKind
from neurotouch_hid.profile import Mapping, UserSettings, check_profile, load_profile
from neurotouch_hid.profile.diagnostics.description import describe_target
from neurotouch_hid.profile.engine.output import STICK_AXES, TRIGGER_AXES
from neurotouch_hid.profile.engine.regions import FOUR_WAYS
from neurotouch_hid.profile.reading.library import find_shipped_folder
from neurotouch_hid.profile.schema.conditions import Sequence
from neurotouch_hid.profile.schema.keyboard_keys import MOUSE_BUTTONS
from neurotouch_hid.profile.schema.layering import merge_bindings
from neurotouch_hid.profile.schema.profile import Binding
from neurotouch_hid.profile.schema.targets import (
    AxisTarget,
    ButtonTarget,
    CommandTarget,
    DpadTarget,
    KeyTarget,
    LayerTarget,
    MouseButtonTarget,
    MouseMotionTarget,
    MouseWheelTarget,
    StickTarget,
    TriggerTarget,
)
from neurotouch_hid.profile.schema.timing import Times, resolve_times
from tests.profile.stage import run

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


SHIPPED = {
    *("default", "spacecraft", "platformer", "racing", "flight", "mouse", "keyboard-arrows"),
    *("media-keys", "menu-switch", "one-hand-left", "one-hand-right", "push-only"),
    "slow-and-steady",
}


def test_all_are_there() -> None:
    assert set(NAMES) == SHIPPED


@pytest.mark.parametrize("name", NAMES)
def test_nothing_in_it_is_risky(name: str) -> None:
    checked = check_profile(find_shipped_folder() / f"{name}.yaml")
    assert not checked.faults, checked.format()


def write_script(binding: Binding, times: Times) -> str:
    """Gestures that do what the binding waits for, as a person would."""
    pause = f"; rest {max(300, times.ignore_repeat_ms + 100)}ms; "
    tap_ms = (times.accept_ms + times.tap_ms) // 2
    if isinstance(binding.when, Sequence):
        steps = (step.replace("push_", "push ") for step in binding.when.sequence)
        return pause.join(f"{step} 4mm 40ms hold {tap_ms}ms" for step in steps)
    condition = binding.condition
    gesture = {"twist": "twist_cw", "scale": "zoom", "any": "pinch"}.get(
        condition.gesture, condition.gesture
    )
    kind = condition.kinds[0]
    most_mm = MOST_MM[kind] - 0.96  # the mean error of the intensity
    needed_mm = (
        binding.range_for(kind)[1]
        if binding.is_followed
        else min(condition.thresholds_mm[0] + 1, most_mm)
    )
    assert needed_mm <= most_mm, binding
    hold_ms = times.accept_ms + 300
    match condition.press:
        case "tap" | "double":
            hold_ms = tap_ms - 40
        case "hold":
            hold_ms = (condition.hold_ms or times.hold_ms) + 100
        case "long":
            hold_ms = (condition.hold_ms or times.long_ms) + 200
    if binding.is_followed:
        hold_ms = 1000
    once = f"{gesture} {condition.direction or ''} {needed_mm}mm 60ms hold {hold_ms}ms"
    if condition.press == "double":
        return f"{once}; rest {(times.gap_ms + times.double_ms) // 2}ms; {once}"
    return once


def has_acted(binding: Binding, states: list[GamepadState]) -> bool:
    """True if the outputs show what the binding does, to its end where it moves something."""
    moved = {axis: max(abs(state.axes.get(axis, 0.0)) for state in states) for axis in Axis}
    match binding.do:
        case ButtonTarget(button=button):
            acted = any(button in state.buttons for state in states)
        case DpadTarget(dpad=way):
            x, y = FOUR_WAYS[way]
            axis, value = (Axis.DPAD_X, x) if x else (Axis.DPAD_Y, y)
            acted = any(state.axes.get(axis) == value for state in states)
        case KeyTarget() as target:
            acted = any(set(target.kernel_names) <= state.keys for state in states)
        case MouseButtonTarget(mouse=button):
            acted = any(MOUSE_BUTTONS[button] in state.mouse_buttons for state in states)
        case MouseMotionTarget(speed_px_s=speed):
            acted = max(math.hypot(*state.pointer) for state in states) > 0.95 * speed
        case MouseWheelTarget(clicks_per_s=speed):
            acted = max(abs(state.wheel) for state in states) > 0.95 * speed
        case StickTarget(stick=side, saturate=end):
            acted = math.hypot(*(moved[axis] for axis in STICK_AXES[side])) > 0.95 * end
        case AxisTarget(axis=axis, saturate=end, value=value):
            acted = moved[Axis(axis)] > 0.95 * (value or end)
        case TriggerTarget(trigger=side, saturate=end, value=value):
            acted = moved[TRIGGER_AXES[side]] >= 0.95 * (value or end)
        case CommandTarget(command=command):
            acted = any(command in state.commands for state in states)
        case _:
            raise AssertionError(binding)
    return acted


@pytest.mark.parametrize("name", NAMES)
def test_every_action_of_every_layer_can_be_reached(name: str) -> None:
    profile = load_profile(find_shipped_folder() / f"{name}.yaml")
    times = resolve_times(profile.timing, None)
    layers = profile.all_layers
    merged = {layer.name: merge_bindings(layer, layers[0]) for layer in layers}
    ways, todo = {layers[0].name: ""}, [layers[0].name]
    while todo:
        here = todo.pop(0)
        for binding in merged[here]:
            script = ways[here] + write_script(binding, times)
            mapping = Mapping(profile, UserSettings(filter="none"))
            states = run(mapping, script + "; rest 1s")
            if isinstance(binding.do, LayerTarget):
                after = layers[0].name if binding.do.layer == here else binding.do.layer
                assert mapping.layer == after, (here, script)
                if after not in ways:
                    ways[after] = script + "; rest 1s; "
                    todo.append(after)
            else:
                assert has_acted(binding, states), (here, script, binding.do)
    assert ways.keys() == merged.keys()


@pytest.mark.parametrize("name", NAMES)
def test_the_gel_can_pause_it_and_go_on(name: str) -> None:
    profile = load_profile(find_shipped_folder() / f"{name}.yaml")
    safety = profile.safety.pause
    assert safety is not None
    gesture = "pinch" if safety.gesture == "any" else safety.gesture
    held = f"{gesture} {safety.direction or ''} {safety.on_mm + 1}mm hold {safety.hold_ms + 500}ms"
    mapping = Mapping(profile)
    states = run(mapping, f"{held}; rest 500ms")
    assert mapping.state == "paused"
    assert states[-1].is_neutral
    run(mapping, f"{held}; rest 500ms", states[-1].t_us + 10_000)
    assert mapping.state == "running"


EVERYTHING = {
    *(f"button {button.value}" for button in Button),
    *(f"dpad {way}" for way in FOUR_WAYS),
    *("stick left", "stick right", "trigger left", "trigger right"),
}


def targets(name: str) -> set[str]:
    profile = load_profile(find_shipped_folder() / f"{name}.yaml")
    words = (
        describe_target(binding.do) for layer in profile.all_layers for binding in layer.bindings
    )
    return {word.removeprefix("toggle ") for word in words}


def test_push_only_is_a_whole_controller_of_pushes() -> None:
    profile = load_profile(find_shipped_folder() / "push-only.yaml")
    conditions = [binding.condition for layer in profile.all_layers for binding in layer.bindings]
    conditions += [profile.safety.pause.condition]
    assert {condition.kinds for condition in conditions} == {(GestureKind.PUSH,)}
    assert all(condition.contacts is None for condition in conditions), "one finger is enough"
    assert targets("push-only") >= EVERYTHING


@pytest.mark.parametrize("side", ["left", "right"])
def test_one_hand_is_a_controller_for_one_hand(side: str) -> None:
    missing = {f"button {name}" for name in ("guide", "lb", "rb", "ls", "rs")}
    assert targets(f"one-hand-{side}") >= EVERYTHING - missing


def test_the_one_handed_ones_mirror_each_other() -> None:
    left, right = (
        load_profile(find_shipped_folder() / f"one-hand-{side}.yaml").model_dump_json()
        for side in ("left", "right")
    )
    swapped = (
        left.replace("twist_cw", "#").replace("twist_ccw", "twist_cw").replace("#", "twist_ccw")
    )
    swapped = swapped.replace("one-hand-left", "one-hand-right").replace("left hand", "right hand")
    assert swapped == right


def is_button(binding: Binding) -> bool:
    return not binding.is_followed


@pytest.mark.parametrize("name", NAMES)
def test_noise_at_rest_moves_nothing(name: str) -> None:
    for kind in GestureKind:
        assert shipped(name).update(gesture(kind, 1.0)).is_neutral
    assert shipped(name).update(gesture(GestureKind.NONE, 5.0)) == GamepadState(0)


@pytest.mark.parametrize("name", ["default", "spacecraft", "flight", "push-only"])
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

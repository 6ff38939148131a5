"""The mouse: how fast it moves, that it is still while it clicks, and clicks by resting."""

import math

import pytest

from neurotouch_hid.messages import GamepadState
from neurotouch_hid.profile import Mapping
from neurotouch_hid.profile.decision_log import DecisionLog
from neurotouch_hid.profile.engine.output import Outputs
from neurotouch_hid.profile.engine.pointer import PointerCare
from neurotouch_hid.profile.schema.targets import MouseMotionTarget
from tests.profile.stage import RAW, make_profile, run

MOTION = "when: push, do: {mouse: motion, range_mm: [0, 10], deadzone: 0, speed_px_s: 500%s}"


def play(more: str, script: str) -> list[GamepadState]:
    return run(Mapping(make_profile(MOTION % more), RAW), script)


def test_a_push_moves_it_the_further_the_faster() -> None:
    states = play("", "push 45deg 4mm hold 500ms")
    assert states[30].pointer == pytest.approx((200 * math.sqrt(0.5),) * 2)
    assert not states[30].is_neutral
    assert states[-1].pointer == (0.0, 0.0)
    inverted = play(", invert_y: true", "push up 4mm hold 500ms")
    assert inverted[30].pointer == pytest.approx((0.0, 200.0), abs=1e-9)


def clicks(states: list[GamepadState]) -> list[int]:
    """When the left button goes down, in ms."""
    down = ["BTN_LEFT" in state.mouse_buttons for state in states]
    return [states[i].t_us // 1000 for i, now in enumerate(down) if now and not (i and down[i - 1])]


def test_dwelling_clicks_once_and_only_after_a_movement() -> None:
    moved = "push left 8mm 100ms hold 300ms; rest 2s"
    assert len(clicks(play(", dwell_ms: 500", f"{moved}; rest 2s"))) == 1
    assert len(clicks(play(", dwell_ms: 500", f"{moved}; {moved}"))) == 2
    assert clicks(play(", dwell_ms: 500", "rest 3s")) == []
    assert clicks(play("", moved)) == []
    (when,) = clicks(play(", dwell_ms: 500", moved))
    assert when == pytest.approx(500 + 500, abs=30)


def test_a_dwell_can_be_heard_in_two_steps_and_left_between_them() -> None:
    mapping = Mapping(make_profile(MOTION % ", dwell_ms: 800"), RAW)
    run(mapping, "push left 8mm 100ms hold 300ms; rest 400ms; push left 8mm 100ms hold 300ms")
    said = {str(decision) for decision in mapping.decisions()}
    assert said == {"step: dwell -> mouse left (1 of 2)"}
    mapping = Mapping(make_profile(MOTION % ", dwell_ms: 800"), RAW)
    run(mapping, "push left 8mm 100ms hold 300ms; rest 2s")
    heard = [(decision.verdict, decision.t_us) for decision in mapping.decisions()]
    assert [verdict for verdict, _ in heard] == ["step", "pressed"]
    assert heard[1][1] - heard[0][1] == 550_000


def test_it_is_still_while_it_clicks_until_it_is_dragged() -> None:
    care = PointerCare(MouseMotionTarget(mouse="motion"), DecisionLog())
    still = []
    for i in range(30):
        outputs = Outputs(mouse_buttons={"BTN_LEFT"}, pointer=(100.0, 0.0))
        care.tend(outputs, i * 10_000)
        still.append(outputs.pointer == (0.0, 0.0))
    assert still == [True] * 12 + [False] * 18, "12 px at 100 px/s"
    free = PointerCare(MouseMotionTarget(mouse="motion", freeze_on_click=False), DecisionLog())
    outputs = Outputs(mouse_buttons={"BTN_LEFT"}, pointer=(100.0, 0.0))
    free.tend(outputs, 0)
    assert outputs.pointer == (100.0, 0.0)


def test_the_wheel_turns_both_ways() -> None:
    wheel = "do: {mouse: wheel, range_mm: [0, 10], deadzone: 0, clicks_per_s: 8}"
    profile = make_profile(f"when: scale, {wheel}")
    assert run(Mapping(profile, RAW), "zoom 5mm hold 500ms")[40].wheel == pytest.approx(4.0)
    assert run(Mapping(profile, RAW), "pinch 5mm hold 500ms")[40].wheel == pytest.approx(-4.0)

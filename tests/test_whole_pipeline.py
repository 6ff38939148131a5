"""The whole pipeline: a simulated gel goes in, pad states come out."""

import dataclasses
from itertools import count, islice

import numpy as np
import pytest

from neurotouch_hid.device import MemoryDevice
from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.messages import Axis, Button, GamepadState, GestureKind, Step
from neurotouch_hid.profile import UserSettings, load_profile
from neurotouch_hid.runtime import Pipeline, run_pipeline
from neurotouch_hid.source.simulator import Simulator
from neurotouch_hid.source.simulator.gel.motion import KNOT_US
from neurotouch_hid.source.simulator.hand_model import GuidedHand, HandCommand
from neurotouch_hid.source.simulator.script import Finger, Stroke, sequence

RIGHT, LEFT = Finger((9.0, 0.0)), Finger((-9.0, 0.0))


def pipeline(profile: str = "spacecraft") -> Pipeline:
    return Pipeline.build(load_profile(profile), GestureConfig())


def play(stroke: Stroke, profile: str = "spacecraft") -> tuple[list[Step], MemoryDevice]:
    steps: list[Step] = []
    device = MemoryDevice()
    run_pipeline(Simulator(sequence("test", stroke)), pipeline(profile), device, [steps.append])
    return steps, device


@pytest.mark.parametrize(
    ("kind", "fingers", "axis", "sign"),
    [
        (GestureKind.PUSH, [Finger((0.0, 0.0), (8.0, 0.0))], Axis.LEFT_X, 1),
        (GestureKind.PUSH, [Finger((0.0, 0.0), (-8.0, 0.0))], Axis.LEFT_X, -1),
        (GestureKind.PUSH, [Finger((0.0, 0.0), (0.0, 8.0))], Axis.LEFT_Y, 1),
        (GestureKind.TWIST_CW, [(RIGHT, 0.7), (LEFT, 0.7)], Axis.RIGHT_X, 1),
        (GestureKind.TWIST_CCW, [(RIGHT, -0.7), (LEFT, -0.7)], Axis.RIGHT_X, -1),
        (GestureKind.ZOOM, [(RIGHT, (6.0, 0.0)), (LEFT, (-6.0, 0.0))], Axis.RIGHT_TRIGGER, 1),
        (GestureKind.PINCH, [(RIGHT, (-6.0, 0.0)), (LEFT, (6.0, 0.0))], Axis.LEFT_TRIGGER, 1),
    ],
)
def test_gesture_moves_the_spacecraft(kind, fingers, axis, sign):
    def moved(finger, motion):
        if isinstance(motion, float):
            return dataclasses.replace(finger, turn_rad=motion)
        return dataclasses.replace(finger, drag_mm=motion)

    hand = tuple(f if isinstance(f, Finger) else moved(*f) for f in fingers)
    steps, device = play(Stroke(kind, hand))

    held = [step for step in steps if 1_200_000 <= step.gesture.t_us < 1_500_000]
    assert [step.gesture.kind for step in held] == [kind] * len(held)
    values = np.array([step.pad.axes.get(axis, 0.0) for step in held])
    assert (sign * values > 0.1).all()
    if kind is not GestureKind.PUSH:
        others = {other for step in held for other, value in step.pad.axes.items() if value}
        assert others == {axis}
    assert steps[-1].pad.is_neutral
    last = device.states[-1]  # a value of less than a step is none for a pad
    assert all(abs(value) < 0.5 / 255 for value in last.axes.values())
    assert steps[-1].gesture.kind is GestureKind.NONE


def test_same_packets_give_the_same_steps_bit_for_bit(push):
    first, second = pipeline(), pipeline()
    for packet in push.packets:
        a, b = first.advance(packet), second.advance(packet)
        assert a.pad == b.pad
        assert a.gesture.intensity_mm == b.gesture.intensity_mm
        np.testing.assert_array_equal(a.markers.position_px, b.markers.position_px)


def test_markers_follow_the_truth(push):
    line = pipeline()
    for packet, truth in zip(push.packets, push.truths, strict=True):
        markers = line.advance(packet).markers
        if packet.t_end_us > 200_000:
            error = np.hypot(*(markers.position_px - truth.markers_px).T)
            assert np.median(error) < 0.5
            assert (error[markers.valid] < 3.0).all()
            assert markers.valid.sum() >= 175


def test_pad_is_neutral_until_the_gel_is_found(push):
    line = pipeline()
    for packet in push.packets:
        if packet.t_end_us > 600_000:
            break
        step = line.advance(dataclasses.replace(packet, frames=()))  # nothing to see: noise alone
        assert step.pad.is_neutral
        assert not step.markers.valid.any()


def test_default_profile_holds_no_button_during_a_soft_push(push):
    line = pipeline("default")
    pads: list[GamepadState] = [line.advance(packet).pad for packet in push.packets]
    assert any(pad.axes.get(Axis.LEFT_X, 0.0) > 0.3 for pad in pads)
    assert not any(set(pad.buttons) & {Button.START, Button.GUIDE} for pad in pads)
    assert pads[-1].is_neutral


@pytest.mark.parametrize("neutral", ["lifted", "resting"])
def test_fingers_that_rest_are_no_gesture_for_who_says_so_and_another_one_pushes(neutral):
    """Two fingers lie down at 0.5 s and drag the gel by 1.2 mm; a third pushes from 4 to 5 s."""
    knot = count()

    def ask() -> HandCommand:
        t_us = next(knot) * KNOT_US
        pushes = 4_000_000 <= t_us < 5_000_000
        return HandCommand(resting=t_us > 500_000, down=pushes, y_mm=-8.0, push_x_mm=7.0 * pushes)

    user = UserSettings(neutral=neutral)
    line = Pipeline.build(load_profile("default"), GestureConfig(), user=user)
    packets = Simulator(GuidedHand(ask, lambda *_: None))
    steps = {packet.t_end_us: line.advance(packet) for packet in islice(packets, 600)}
    before = [step for t_us, step in steps.items() if 3_000_000 < t_us < 3_900_000]
    pushing = [step for t_us, step in steps.items() if 4_400_000 < t_us < 4_900_000]
    after = [step for t_us, step in steps.items() if t_us > 5_500_000]
    for rest in (before, after):
        quiet = {step.gesture.kind is GestureKind.NONE for step in rest}
        assert quiet == {neutral == "resting"}
    if neutral == "resting":
        assert {step.gesture.kind for step in pushing} == {GestureKind.PUSH}
        assert all(step.pad.axes[Axis.LEFT_X] > 0.7 for step in pushing)
        assert all(step.pad.is_neutral for step in before + after)

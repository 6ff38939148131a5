"""Without frames: a gel that has come back is at rest, and a hand on it is not."""

from dataclasses import replace

import numpy as np

from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.messages import GelProblem, GestureKind
from neurotouch_hid.profile import load_profile
from neurotouch_hid.runtime import Pipeline
from neurotouch_hid.source.simulator import Simulator
from neurotouch_hid.source.simulator.script import Finger, Stroke, sequence

FRAMES_US = 700_000  # frames end then, before the first stroke
REST_US = 800_000


def push(x_mm: float, y_mm: float, **timing: int) -> Stroke:
    finger = Finger((2.0, 3.0), (x_mm, y_mm), press_mm=1.0)
    return Stroke(GestureKind.PUSH, (finger,), **timing)


def play(*strokes: Stroke, neutral="lifted", back_us=1 << 40, gap_us=700_000):
    """Returns steps, and how far each marker is from rest and the track from it, px, a slice."""
    script = sequence("test", *strokes, rest_us=REST_US, gap_us=gap_us)
    simulator = Simulator(script, seed=3)
    pipeline = Pipeline.build(load_profile("default"), GestureConfig(neutral=neutral))
    steps, moved, errors = [], [], []
    rest_px = simulator.truth(0).markers_px
    for packet in simulator:
        if FRAMES_US <= packet.t_end_us < back_us:
            packet = replace(packet, frames=())  # noqa: PLW2901
        steps.append(pipeline.advance(packet))
        truth_px = simulator.truth(packet.t_end_us).markers_px
        moved.append(np.hypot(*(truth_px - rest_px).T))
        errors.append(np.hypot(*(steps[-1].markers.position_px - truth_px).T))
    return steps, np.array(moved), np.array(errors)


def returns(steps):
    """Returns the indices of the slices in which the gel was found back at rest."""
    return [k for k, step in enumerate(steps) if step.rest and step.packet.t_end_us > REST_US]


def test_each_return_takes_the_drift_out():
    steps, moved, errors = play(push(6.0, -5.0), push(-5.0, 4.0), push(7.0, 1.0))
    at_rest = moved.max(axis=1) < 0.25
    settled = [k for k in range(100, len(steps)) if at_rest[k - 20 : k + 1].all()]
    assert len(settled) > 60
    assert all(steps[k].gesture.kind is GestureKind.NONE for k in settled)
    assert errors[settled].mean() < 0.15
    assert errors[settled].max() < 1.0
    assert len(returns(steps)) >= 3


def test_noise_carries_no_marker_away_from_a_gel_at_rest():
    """A position is uncertain after a stroke, and then come seconds with nothing but noise."""
    steps, moved, errors = play(push(6.0, -5.0), push(-5.0, 4.0), gap_us=5_000_000)
    late = slice(len(steps) - 100, None)
    assert moved[late].max() < 0.1
    assert np.median(errors[late]) < 0.14
    assert not any(step.gesture.kind for step in steps[late])


def test_a_hand_that_holds_still_is_no_return():
    steps, moved, _ = play(push(2.0, 0.0, hold_us=3_000_000))
    assert all(moved[k].max() < 1.0 for k in returns(steps))
    held = moved.max(axis=1) > 4.0
    assert held.sum() > 300
    assert all(
        step.gesture.kind is GestureKind.PUSH for step, on in zip(steps, held, strict=True) if on
    )


def test_a_slow_push_is_no_return_and_is_followed():
    steps, moved, errors = play(push(2.0, 0.0, attack_us=4_000_000, hold_us=200_000))
    begun = next(k for k in range(len(steps)) if moved[k].max() > 0.75)
    top = moved.max(axis=1).argmax()
    assert not [k for k in returns(steps) if begun <= k <= top]
    assert steps[top].gesture.kind is GestureKind.PUSH
    assert moved[top].max() > 5.0
    assert np.median(errors[top][moved[top] > 2.5]) < 0.4
    assert errors[top].max() < 1.5


def test_a_hand_that_may_rest_on_the_gel_is_never_taken_for_rest():
    steps, _, _ = play(push(5.0, 3.0), neutral="resting")
    assert not returns(steps)


def test_the_gel_says_that_frames_are_missing_until_they_come_back():
    steps, _, _ = play(push(3.0, 0.0), back_us=2_200_000)
    problems = [step.gel.problem for step in steps if step.packet.t_end_us > REST_US + 1_000_000]
    assert GelProblem.EVENTS_ONLY in problems
    assert steps[-1].gel.problem is GelProblem.NONE
    assert all(step.gel.is_found for step in steps if step.packet.t_end_us > FRAMES_US)

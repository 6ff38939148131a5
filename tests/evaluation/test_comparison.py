"""Steps against labels: which moments are compared, and the rest detection by frame."""

from dataclasses import replace

import numpy as np
import pytest

from neurotouch_hid.evaluation.accuracy import Comparison, LabelTrack, summarise
from neurotouch_hid.geometry import PAPER_GEL, Rig
from neurotouch_hid.messages import (
    EVENT_DTYPE,
    EventPacket,
    Frame,
    GamepadState,
    GelState,
    Gesture,
    GestureKind,
    MarkerField,
    RestField,
    Step,
    Truth,
)

REST_PX = Rig((170.0, 130.0), 2.5).to_px(PAPER_GEL.points_mm).astype(np.float32)
POINT = np.array([[170.0, 130.0]])
NO_POINT = np.zeros((0, 2))


def make_step(t_us, kind, *, frame_us=None, rest=False, point=POINT, intensity=2.0, n_events=3):
    """A slice of 10 ms that ends at ``t_us``."""
    picture = np.zeros((260, 346), np.uint8)
    frames = () if frame_us is None else (Frame(picture, frame_us - 500, frame_us + 500),)
    none = kind is GestureKind.NONE
    point = NO_POINT if none else point
    return Step(
        EventPacket(t_us - 10_000, t_us, np.zeros(n_events, EVENT_DTYPE), frames),
        RestField(frame_us, REST_PX) if rest else None,
        MarkerField(t_us, REST_PX, REST_PX, np.ones(177, bool)),
        Gesture(t_us, kind, point, point, 0.0 if none else intensity),
        GamepadState(t_us),
        GelState(),
    )


def make_labels(*rows):
    return LabelTrack(
        [
            Truth(t_us, kind, NO_POINT if kind is GestureKind.NONE else POINT, intensity)
            for t_us, kind, intensity in rows
        ]
    )


LABELS = make_labels(
    (20_000, GestureKind.NONE, 0.0),
    (60_000, GestureKind.PUSH, 2.0),
    (100_000, GestureKind.PUSH, 4.0),
)


def test_every_slice_between_the_labels_is_an_observation():
    comparison = Comparison(LABELS)
    for t_us in range(10_000, 150_000, 10_000):
        comparison(make_step(t_us, GestureKind.PUSH))
    report = summarise(comparison.tally)
    assert report["observations"] == 9
    assert report["gesture_accuracy"] == pytest.approx(5 / 9)
    assert report["intensity_mae_mm"] == pytest.approx((0 + 0.5 + 1 + 1.5 + 2) / 5)
    assert report["distance_mm"] == 0.0
    assert report["events"] == 14 * 3


def test_distance_is_in_millimetres_of_the_recording():
    comparison = Comparison(LABELS)
    comparison(make_step(60_000, GestureKind.PUSH, point=POINT + np.array([0.0, 5.0])))
    assert summarise(comparison.tally)["distance_mm"] == pytest.approx(2.0, rel=1e-4)


def test_only_the_last_frame_of_a_slice_is_judged():
    """A camera that is faster than the slices: a step tells of one frame whether it is rest."""
    comparison = Comparison(LABELS)
    step = make_step(20_000, GestureKind.NONE, frame_us=19_000, rest=True)
    early = Frame(step.packet.frames[0].pixels, 10_500, 11_500)
    packet = replace(step.packet, frames=(early, *step.packet.frames))
    comparison(replace(step, packet=packet))
    assert summarise(comparison.tally)["rest_recall"] == 1.0
    assert comparison.tally.frames == 2


def test_rest_is_compared_with_the_label_of_its_own_frame():
    comparison = Comparison(LABELS)
    comparison(make_step(30_000, GestureKind.NONE, frame_us=21_000, rest=True))
    comparison(make_step(70_000, GestureKind.PUSH, frame_us=59_000, rest=True))  # label: 60 ms
    comparison(make_step(110_000, GestureKind.PUSH, frame_us=101_000))
    comparison(make_step(210_000, GestureKind.PUSH, frame_us=201_000, rest=True))  # no label
    tally = comparison.tally
    assert dict(tally.rest) == {(True, True): 1, (False, True): 1, (False, False): 1}
    assert tally.frames == 4


def test_an_answer_to_another_frame_is_none_to_this_one():
    step = make_step(30_000, GestureKind.NONE, frame_us=21_000)
    late = replace(step, rest=RestField(1, REST_PX))
    comparison = Comparison(LABELS)
    comparison(late)
    assert dict(comparison.tally.rest) == {(True, False): 1}


def test_before_the_gel_is_found_there_is_no_distance():
    step = make_step(60_000, GestureKind.PUSH)
    unknown = np.full((177, 2), np.nan, np.float32)
    lost = MarkerField(60_000, unknown, unknown, np.zeros(177, bool))
    comparison = Comparison(LABELS)
    comparison(replace(step, markers=lost))
    report = summarise(comparison.tally)
    assert (report["observations"], report["distance_mm"]) == (1, None)

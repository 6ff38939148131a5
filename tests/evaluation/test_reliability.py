"""Confidence against what was right."""

import pytest

from neurotouch_hid.evaluation.accuracy import Tally, summarise
from neurotouch_hid.messages import GestureKind
from tests.evaluation.timelines import RIG, answer, label


def tally_of(*called):
    """Each: (confidence, right)."""
    tally = Tally()
    truth = label(0, GestureKind.PUSH, 3.0)
    for confidence, is_right in called:
        kind = GestureKind.PUSH if is_right else GestureKind.ZOOM
        tally.add_gesture(answer(truth, kind=kind, confidence=confidence), truth, RIG)
    return tally


def test_bins_and_error():
    bins = summarise(tally_of((0.92, True), (0.98, False), (1.0, True), (0.3, False)))[
        "reliability"
    ]
    assert bins["edges"][:2] == [0.0, 0.1]
    assert bins["edges"][-1] == 1.0
    assert bins["observations"] == [0, 0, 0, 1, 0, 0, 0, 0, 0, 3]
    assert bins["accuracy"][9] == pytest.approx(2 / 3)
    assert bins["confidence"][9] == pytest.approx(2.9 / 3)
    assert (bins["accuracy"][3], bins["accuracy"][0]) == (0.0, None)
    assert bins["error"] == pytest.approx((0.9 + 0.3) / 4)


def test_recordings_add_up():
    first, second = ((0.9, True), (0.9, True)), ((0.95, False), (0.2, True))
    parts = summarise(tally_of(*first) + tally_of(*second))["reliability"]
    whole = summarise(tally_of(*first, *second))["reliability"]
    assert parts["error"] == pytest.approx(whole["error"])
    assert parts["confidence"] == pytest.approx(whole["confidence"])
    assert parts["observations"] == whole["observations"]


def test_slices_without_a_recognised_gesture_are_left_out():
    tally = Tally()
    truth = label(0, GestureKind.PUSH, 3.0)
    tally.add_gesture(answer(truth, kind=GestureKind.NONE, contacts=[]), truth, RIG)
    assert summarise(tally)["reliability"]["error"] is None

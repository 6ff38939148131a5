"""The paper's metrics on cases that can be checked by hand."""

import json

import numpy as np
import pytest

from neurotouch_hid.evaluation.accuracy import Tally, format_table, summarise
from neurotouch_hid.evaluation.accuracy.metrics import balance
from neurotouch_hid.evaluation.accuracy.tally import measure_distances
from neurotouch_hid.geometry import Rig
from neurotouch_hid.messages import Gesture, GestureKind, Truth

RIG = Rig((170.0, 130.0), 2.0)
NONE, PUSH, PINCH, ZOOM = (
    GestureKind.NONE,
    GestureKind.PUSH,
    GestureKind.PINCH,
    GestureKind.ZOOM,
)


def points(values):
    return np.array(values, float).reshape(-1, 2)


def tally_of(*pairs, rig=RIG):
    """Each pair: (kind, points, intensity) predicted, and the same labelled."""
    tally = Tally()
    for (kind, seen, intensity), (true_kind, true_points, true_intensity) in pairs:
        gesture = Gesture(0, kind, points(seen), points(seen), intensity)
        tally.add_gesture(gesture, Truth(0, true_kind, points(true_points), true_intensity), rig)
    return tally


FOUR = (
    ((NONE, [], 0.0), (NONE, [], 0.0)),
    ((PUSH, [[0, 0]], 1.0), (PUSH, [[6, 8]], 1.5)),
    ((PUSH, [[0, 0], [9, 0], [100, 0]], 2.0), (PINCH, [[0, 2], [10, 0]], 4.0)),
    ((NONE, [], 0.0), (PINCH, [[0, 0], [10, 0]], 0.5)),
)


def test_figures_of_four_observations():
    report = summarise(tally_of(*FOUR))
    assert report["gesture_accuracy"] == 0.5
    assert report["count_accuracy"] == 0.5
    assert report["distance_mm"] == pytest.approx((10 + 2 + 1) / 3 / 2.0)
    assert report["intensity_mae_mm"] == pytest.approx((0.5 + 2.0 + 0.5) / 3)
    assert report["per_gesture"]["push"] == {
        "precision": 0.5,
        "recall": 1.0,
        "f1": pytest.approx(2 / 3),
    }
    assert report["per_gesture"]["pinch"] == {"precision": None, "recall": 0.0, "f1": 0.0}
    assert report["per_gesture"]["zoom"] == {"precision": None, "recall": None, "f1": None}
    assert report["observations"] == 4


def test_intensity_bins_leave_no_gesture_out():
    bins = summarise(tally_of(*FOUR))["by_intensity"]
    assert bins["edges_mm"][:4] == [0.0, 0.6, 1.2, 1.8]
    assert bins["edges_mm"][-1] == pytest.approx(4.2)
    assert bins["observations"] == [1, 0, 1, 0, 0, 0, 1]
    assert bins["gesture_accuracy"] == [0.0, None, 1.0, None, None, None, 0.0]
    assert bins["count_accuracy"] == [0.0, None, 1.0, None, None, None, 0.0]


def test_balanced_confusion_is_the_mean_of_both_normalisations():
    confusion = np.zeros((6, 6), int)
    confusion[PUSH, PUSH], confusion[PUSH, PINCH], confusion[PINCH, PINCH] = 6, 2, 2
    matrix = balance(confusion)
    assert matrix[PUSH][PUSH] == (6 / 8 + 6 / 6) / 2
    assert matrix[PUSH][PINCH] == (2 / 8 + 2 / 4) / 2
    assert matrix[PINCH][PINCH] == (2 / 2 + 2 / 4) / 2
    assert matrix[ZOOM][ZOOM] is None
    assert matrix[ZOOM][PUSH] == 0.0


@pytest.mark.parametrize(
    ("predicted", "labelled", "expected"),
    [
        ([], [[0, 0]], []),
        ([[0, 0]], [], []),
        ([[0, 3], [0, 1], [0, 9]], [[0, 0]], [1]),
        ([[0, 3], [0, 1]], [[0, 0], [50, 0]], [1, 3]),  # two may share their nearest
        ([[0, 3]], [[0, 0], [0, 4]], [1]),
    ],
)
def test_distances(predicted, labelled, expected):
    assert measure_distances(points(predicted), points(labelled)).tolist() == expected


def test_rest_is_scored_by_frame():
    tally = Tally()
    for labelled, detected, n in ((1, 1, 6), (1, 0, 2), (0, 1, 3), (0, 0, 9)):
        for _ in range(n):
            tally.add_rest(labelled=bool(labelled), detected=bool(detected))
    report = summarise(tally)
    assert report["rest_precision"] == pytest.approx(6 / 9)
    assert report["rest_recall"] == pytest.approx(6 / 8)
    assert report["rest_f1"] == pytest.approx(12 / 17)


def test_tallies_add_up():
    whole = tally_of(*FOUR)
    parts = tally_of(*FOUR[:2]) + tally_of(*FOUR[2:])
    assert summarise(parts) == summarise(whole)


def test_without_a_rig_there_is_no_distance():
    assert summarise(tally_of(*FOUR, rig=None))["distance_mm"] is None


def test_an_empty_tally_is_json_without_nan():
    report = summarise(Tally())
    text = json.dumps(report, allow_nan=False)
    assert json.loads(text)["gesture_accuracy"] is None
    assert report["confusion"]["labels"] == [
        "none",
        "push",
        "pinch",
        "zoom",
        "twist_cw",
        "twist_ccw",
    ]


def test_table_shows_the_paper_beside():
    lines = format_table(summarise(tally_of(*FOUR))).splitlines()
    row = next(line for line in lines if "type accuracy" in line)
    assert row.split()[3:] == ["50.0", "%", "91.1", "%"]
    assert all(len(line) <= 100 for line in lines)
    assert "None" not in "\n".join(lines)
    assert format_table(summarise(Tally()))

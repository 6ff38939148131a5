"""What the figures show: the methods' own numbers, and the paper's where it published them."""

import pytest
from matplotlib.collections import PolyCollection
from matplotlib.quiver import Quiver

from neurotouch_hid.evaluation.accuracy import Tally, summarise
from neurotouch_hid.evaluation.accuracy.label_statistics import LabelStatistics
from neurotouch_hid.evaluation.accuracy.moments import WorstMoment
from neurotouch_hid.evaluation.accuracy.published_figures import (
    COUNT_BY_INTENSITY,
    TYPE_BY_INTENSITY,
)
from neurotouch_hid.evaluation.accuracy.report.bars import (
    draw_errors,
    draw_summary,
    draw_type_metrics,
)
from neurotouch_hid.evaluation.accuracy.report.curves import (
    draw_confusion,
    draw_intensity,
    draw_times,
)
from neurotouch_hid.evaluation.accuracy.report.gallery import Failure, draw_failure
from neurotouch_hid.evaluation.accuracy.report.label_figures import draw_classes, draw_contacts
from neurotouch_hid.evaluation.accuracy.report.style import apply_style
from neurotouch_hid.evaluation.accuracy.type_timing import TypeTiming
from neurotouch_hid.geometry import PAPER_GEL
from neurotouch_hid.messages import GestureKind
from tests.evaluation.timelines import REST_PX, RIG, answer, label, markers


@pytest.fixture(autouse=True)
def style():
    with apply_style():
        yield


@pytest.fixture(scope="module")
def reports():
    """One method is always right, the other calls a zoom a push and all intensities 1 mm low."""
    right, wrong = Tally(), Tally()
    for kind in list(GestureKind)[1:]:
        for intensity in (1.0, 4.0, 4.0, 9.0):
            truth = label(0, kind, intensity)
            right.add_gesture(answer(truth), truth, RIG)
            seen = GestureKind.PUSH if kind is GestureKind.ZOOM else kind
            wrong.add_gesture(answer(truth, kind=seen, intensity=intensity - 1), truth, RIG)
    return {"right": summarise(right), "wrong": summarise(wrong)}


def heights(axes):
    return [bar.get_height() for bar in axes.patches]


def levels(axes):
    """Where horizontal lines cross a panel."""
    return [line.get_ydata()[0] for line in axes.lines if len(set(line.get_ydata())) == 1]


def test_summary_has_both_methods_and_the_paper(reports):
    accuracy, count, distance, intensity, rest = draw_summary(reports).axes
    assert heights(accuracy) == [1.0, pytest.approx(0.8)]
    assert heights(intensity) == [0.0, pytest.approx(1.0)]
    assert [levels(a) for a in (accuracy, count, distance, intensity, rest)] == [
        [0.9112],
        [0.8322],
        [3.41],
        [0.96],
        [0.9403],
    ]
    assert all(max(levels(axes)) < axes.get_ylim()[1] for axes in (accuracy, distance, intensity))


def test_metrics_of_each_type(reports):
    precision, recall, _, count = draw_type_metrics(reports).axes
    assert [text.get_text() for text in recall.get_xticklabels()][:4] == [
        "none",
        "push",
        "pinch",
        "zoom",
    ]
    assert heights(recall)[6:] == [0.0, 1.0, 1.0, 0.0, 1.0, 1.0]
    assert heights(precision)[7] == 0.5
    assert "–" in [text.get_text() for text in precision.texts]  # none is undefined
    assert levels(count) == [0.8322]


def test_errors_of_each_gesture(reports):
    distance, intensity = draw_errors(reports).axes
    assert heights(intensity)[5:] == pytest.approx([1.0] * 5)
    assert levels(distance) == [3.41, 4.0]
    assert levels(intensity) == [0.96]


def test_accuracy_over_intensity_marks_the_papers_points(reports):
    for axes, points in zip(
        draw_intensity(reports).axes, (TYPE_BY_INTENSITY, COUNT_BY_INTENSITY), strict=False
    ):
        diamonds = [line for line in axes.lines if line.get_marker() == "D"]
        assert [tuple(map(tuple, line.get_xydata())) for line in diamonds] == [points]
    line = draw_intensity(reports).axes[0].lines[0]
    assert line.get_xdata() == pytest.approx([0.9, 3.9, 9.3])  # the bins' centres
    assert list(line.get_ydata()) == [1.0, 1.0, 1.0]


def test_confusion_marks_the_papers_largest(reports):
    axes = draw_confusion(reports).axes[1]
    cells = {tuple(map(round, text.get_position())): text.get_text() for text in axes.texts[:36]}
    assert cells[GestureKind.PUSH, GestureKind.ZOOM] == f"{(4 / 4 + 4 / 8) / 2:.2f}"
    published = axes.texts[36]
    assert published.get_text() == "paper 0.13"
    assert tuple(map(round, published.get_position())) == (GestureKind.PUSH, GestureKind.ZOOM)


def test_times_end_where_types_are_never_recognised(reports):
    timings = {"right": TypeTiming(4, [0.0, 50.0]), "wrong": TypeTiming(0, [])}
    line, empty = draw_times(timings, reports).axes[0].lines[:2]
    assert line.get_xydata().tolist() == [[0, 0], [0, 0.25], [50, 0.5], [1000, 0.5]]
    assert max(empty.get_ydata()) == 0


def test_labels_by_type_and_place():
    labels = [label(k, GestureKind.PUSH, 3.0) for k in range(3)] + [label(9, GestureKind.NONE)]
    statistics = LabelStatistics.of(labels, RIG)
    assert heights(draw_classes(statistics).axes[0])[:2] == [0.25, 0.75]
    axes = draw_contacts(statistics).axes[0]
    hexagons = next(c for c in axes.collections if isinstance(c, PolyCollection))
    assert hexagons.get_array().tolist() == [3.0]
    assert axes.patches[0].get_radius() == 30.0


def test_a_failure_shows_markers_arrows_and_both_contacts():
    truth = label(0, GestureKind.PINCH, 4.0, [(150, 130), (190, 130)])
    gesture = answer(truth, kind=GestureKind.PUSH, contacts=[(170, 120)], intensity=2.0)
    failure = Failure("file", WorstMoment(4.0, 1.0, markers(0, (3, -2)), gesture, truth, RIG))
    assert failure.expected() == "pinch, 2 contacts, 4.0 mm"
    assert failure.recognised() == "push, 1 contact, 2.0 mm"
    figure = draw_failure(failure)
    axes = figure.axes[0]
    arrows = next(c for c in axes.collections if isinstance(c, Quiver))
    assert PAPER_GEL.n_markers == arrows.N
    assert set(zip(arrows.U.tolist(), arrows.V.tolist(), strict=True)) == {(3.0, -2.0)}
    measured, guessed, labelled, seen = (line.get_xydata() for line in axes.lines)
    assert len(measured) == PAPER_GEL.n_markers - 1
    assert guessed.tolist() == [(REST_PX[0] + (3, -2)).tolist()]
    assert labelled.tolist() == [[150, 130], [190, 130]]
    assert seen.tolist() == [[170, 120]]
    assert axes.get_ylim()[0] > axes.get_ylim()[1]  # as the camera sees it, y down

"""Draws all figures of a report, each with a description in words."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

from matplotlib.figure import Figure

from neurotouch_hid.evaluation.accuracy.files import Evaluation
from neurotouch_hid.evaluation.accuracy.label_statistics import LabelStatistics
from neurotouch_hid.evaluation.accuracy.report.bars import (
    Reports,
    draw_errors,
    draw_summary,
    draw_type_metrics,
)
from neurotouch_hid.evaluation.accuracy.report.curves import (
    draw_confusion,
    draw_intensity,
    draw_reliability,
    draw_times,
)
from neurotouch_hid.evaluation.accuracy.report.gallery import Failure, draw_failure, find_failures
from neurotouch_hid.evaluation.accuracy.report.label_figures import (
    draw_boxes,
    draw_classes,
    draw_contacts,
    draw_intensities,
    draw_speeds,
)
from neurotouch_hid.evaluation.accuracy.report.style import apply_style, render_svg


@dataclass(frozen=True, slots=True)
class ReportPicture:
    """A drawn figure.

    Attributes:
        name: of its file, without suffix; starts with the section of the page that shows it.
        alt: its content in words, for people who do not see it.
        caption: the text below it.
        svg: the drawing.
    """

    name: str
    alt: str
    caption: str
    svg: str


def draw_pictures(
    evaluations: Mapping[str, Evaluation], reports: Reports, progress: Callable[[str], None]
) -> Iterator[ReportPicture]:
    """Draws one figure after another, in the order of the page.

    Args:
        evaluations: by method; at least one.
        reports: the report of each of them.
        progress: called with a sentence at each step.
    """
    with apply_style():
        progress("Drawing the figures of the results")
        yield from _draw_results(evaluations, reports)
        progress("Drawing the figures of the labels")
        played = next(iter(evaluations.values())).files.values()
        yield from _draw_labels(LabelStatistics.joined([each.labels for each in played]))
        for method, evaluation in evaluations.items():
            progress(f"Drawing the worst moments of method {method}")
            for k, failure in enumerate(find_failures(evaluation), 1):
                yield _picture_failure(f"failures-{method}-{k:02d}", failure)


def _draw_results(
    evaluations: Mapping[str, Evaluation], reports: Reports
) -> Iterator[ReportPicture]:
    timings = {method: evaluation.total().timing for method, evaluation in evaluations.items()}
    yield _picture(
        "table-summary",
        draw_summary(reports),
        "Bars of the paper's five figures for each method, with a dashed line at the paper's "
        "figure. The table above has all numbers.",
        "The paper's figures are from its own data, which has not been published.",
    )
    yield _picture(
        "types-metrics",
        draw_type_metrics(reports),
        "Bars of precision, recall, F1-score and contact count accuracy for none and each of the "
        "five gestures. The tables below have all numbers.",
        "Precision: of the slices recognised as this type, how many are. Recall: of the slices "
        "labelled so, how many are recognised. –: undefined.",
    )
    yield _picture(
        "intensity-accuracy",
        draw_intensity(reports),
        "Type accuracy and contact count accuracy over the labelled intensity, and the number of "
        "slices in each bin. The table below has all numbers.",
        "Bins of 0.6 mm; hollow marks have fewer than 20 slices. Slices labelled none are left "
        "out. The paper names 90 % of types from 2.5 mm, 95 % at 4.2 mm and 100 % from 12.1 mm; "
        "80 % of counts at 6.1 mm, 90 % at 7.0 mm and nearly all at 14.5 mm.",
    )
    yield _picture(
        "errors-gestures",
        draw_errors(reports),
        "Bars of the mean contact point distance and the mean absolute error of the intensity for "
        "each gesture. The table below has all numbers.",
        "Distance: from each recognised contact to the nearest labelled one, without the surplus.",
    )
    yield _picture(
        "confusion-matrix",
        draw_confusion(reports),
        "Confusion matrix of labelled against recognised types for each method. The tables below "
        "have all numbers.",
        "Mean of the row-normalised and the column-normalised matrix. The paper's largest "
        "confusion is zoom taken for push.",
    )
    yield _picture(
        "timing-types",
        draw_times(timings, reports),
        "Share of the gestures whose type is recognised, over the time since the labelled "
        "intensity reached 2.5 mm; bars of the gestures that change type, and of the false "
        "gestures in 10 minutes at rest. The table above has the numbers.",
        "A gesture whose type is never recognised keeps its line below 100 %.",
    )
    yield _picture(
        "confidence-reliability",
        draw_reliability(reports),
        "Share of right types over the confidence they were called with, and how often each "
        "confidence is given. The table below has all numbers.",
        "Slices in which a gesture is recognised. On the dotted line the confidence equals "
        "the accuracy: of the slices with a confidence of 0.9, nine in ten are right.",
    )


def _draw_labels(labels: LabelStatistics) -> Iterator[ReportPicture]:
    yield _picture(
        "labels-types",
        draw_classes(labels),
        "Bars of the share and number of labels of each type, beside the paper's shares.",
        "The paper labels about 15 000 of 37 912 frames none, and 4 000 to 5 000 each gesture.",
    )
    yield _picture(
        "labels-contacts",
        draw_contacts(labels),
        "Map of the labelled contact points within the circle of the gel.",
        "On the gel as the user sees it; the circle is its contour of 60 mm. The paper draws the "
        "same in the image.",
    )
    yield _picture(
        "labels-intensities",
        draw_intensities(labels),
        "Histogram of the labelled intensities in bins of 0.6 mm, none excluded.",
        "Most of the paper's labels lie between 0 and 6 mm, the largest at 18.1 mm.",
    )
    yield _picture(
        "labels-speeds",
        draw_speeds(labels),
        "Histogram of the speeds, the changes of intensity between neighbouring labels.",
        "The paper's span from -220 to 190 mm/s.",
    )
    yield _picture(
        "labels-boxes",
        draw_boxes(labels),
        "Box plot of the labelled intensities of each gesture.",
        "The paper's means lie between 3 and 7 mm, the lowest for zoom, the highest for push.",
    )


def _picture_failure(name: str, failure: Failure) -> ReportPicture:
    moment = failure.moment
    expected, recognised = failure.expected(), failure.recognised()
    place = f"{failure.file}, {moment.since_s:.2f} s"
    return _picture(
        name,
        draw_failure(failure),
        f"The gel's markers with arrows from where they rest. Expected: {expected}. "
        f"Recognised: {recognised}.",
        f"{place} (stamp {moment.gesture.t_us} µs). Expected: {expected}. "
        f"Recognised: {recognised}. Severity {moment.severity_mm:.1f} mm.",
    )


def _picture(name: str, figure: Figure, alt: str, caption: str) -> ReportPicture:
    return ReportPicture(name, alt, caption, render_svg(figure))

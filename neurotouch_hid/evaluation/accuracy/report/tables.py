"""Builds the tables of the page. Each number is also there unrounded, as in the JSON file."""

from collections.abc import Iterable, Mapping
from html import escape
from typing import Any

from neurotouch_hid.evaluation.accuracy.published_figures import FIGURES
from neurotouch_hid.evaluation.accuracy.report.bars import Reports
from neurotouch_hid.evaluation.accuracy.table import BEYOND, find_figure, format_figure


def build_summary(reports: Reports) -> str:
    """Returns the paper's table: each figure as published and by each method."""
    rows = [
        [
            item.name,
            "–" if item.paper is None else _number(item.paper, item.unit),
            *(_number(find_figure(report, item.key), item.unit) for report in reports.values()),
        ]
        for item in FIGURES
    ]
    head = ["figure", "published in the paper", *(f"method {name}" for name in reports)]
    return build_table("Over all recordings", head, rows)


def build_beyond(reports: Reports) -> str:
    """Returns the figures that the paper lacks: time, changes of type, rest, confidence."""
    rows = [
        [
            item.name,
            *(_number(find_figure(report, item.key), item.unit) for report in reports.values()),
        ]
        for item in BEYOND
    ]
    for name, key in (
        ("gestures that reach 2.5 mm", "time_to_type_ms.gestures"),
        ("of these never recognised", "time_to_type_ms.never"),
        ("seconds at rest", "at_rest_s"),
    ):
        rows.append([name, *(_count(find_figure(report, key)) for report in reports.values())])
    head = ["figure", *(f"method {name}" for name in reports)]
    return build_table("Over all recordings", head, rows)


def build_types(report: Mapping[str, Any]) -> str:
    """Returns precision, recall, F1 and count accuracy of each type, for one method."""
    rows = [
        [
            label.replace("_", " "),
            *(_number(score[key], "%") for key in ("precision", "recall", "f1")),
            _number(report["by_gesture"][label]["count_accuracy"], "%"),
            _count(report["by_gesture"][label]["observations"]),
        ]
        for label, score in report["per_gesture"].items()
    ]
    head = ["type", "precision", "recall", "F1-score", "contact count", "slices"]
    return build_table("Types and contact counts", head, rows)


def build_errors(report: Mapping[str, Any]) -> str:
    """Returns distance and intensity error of each gesture, for one method."""
    rows = [
        [
            label.replace("_", " "),
            _number(values["distance_mm"], "mm"),
            _number(values["intensity_mae_mm"], "mm"),
        ]
        for label, values in report["by_gesture"].items()
        if label != "none"
    ]
    return build_table("Errors", ["type", "contact distance", "intensity MAE"], rows)


def build_intensity(report: Mapping[str, Any]) -> str:
    """Returns accuracy in each bin of intensity, for one method."""
    bins = report["by_intensity"]
    edges = bins["edges_mm"]
    rows = [
        [f"{low:.1f} to {high:.1f}", _number(kind, "%"), _number(count, "%"), _count(n)]
        for low, high, kind, count, n in zip(
            edges, edges[1:], bins["gesture_accuracy"], bins["count_accuracy"],
            bins["observations"], strict=False,
        )
    ]  # fmt: skip
    head = ["intensity, mm", "type accuracy", "count accuracy", "slices"]
    return build_table("Accuracy over intensity", head, rows)


def build_confusion(report: Mapping[str, Any]) -> str:
    """Returns the balanced confusion matrix of one method."""
    labels = [label.replace("_", " ") for label in report["confusion"]["labels"]]
    rows = [
        [label, *(_number(cell, "") for cell in cells)]
        for label, cells in zip(labels, report["confusion"]["balanced"], strict=True)
    ]
    return build_table("Row: labelled, column: recognised", ["labelled", *labels], rows)


def build_reliability(report: Mapping[str, Any]) -> str:
    """Returns confidence and accuracy in each bin, for one method."""
    bins = report["reliability"]
    rows = [
        [f"{low:.1f} to {high:.1f}", _number(said, ""), _number(right, "%"), _count(n)]
        for low, high, said, right, n in zip(
            bins["edges"], bins["edges"][1:], bins["confidence"], bins["accuracy"],
            bins["observations"], strict=False,
        )
    ]  # fmt: skip
    return build_table("Confidence", ["bin", "mean confidence", "type right", "slices"], rows)


def build_files(reports: Reports) -> str:
    """Returns type accuracy, distance and MAE of each recording by each method."""
    keys = FIGURES[:4]
    rows = []
    for name in next(iter(reports.values()))["files"]:
        for method, report in reports.items():
            values = report["files"][name]
            numbers = [_number(values[item.key], item.unit) for item in keys]
            rows.append([escape(name), escape(method), *numbers, _count(values["observations"])])
    head = ["recording", "method", *(item.name for item in keys), "slices"]
    return build_table("Each recording", head, rows)


def build_table(caption: str, head: Iterable[str], rows: Iterable[list[str]]) -> str:
    """Returns a table whose first column heads the rows; the cells of ``rows`` are HTML."""
    heads = "".join(f'<th scope="col">{escape(name)}</th>' for name in head)
    body = "".join(
        f'<tr><th scope="row">{row[0]}</th>' + "".join(f"<td>{cell}</td>" for cell in row[1:])
        + "</tr>\n"
        for row in rows
    )  # fmt: skip
    return (
        f'<div class="wide" role="group" aria-label="{escape(caption)}" tabindex="0"><table>'
        f"<caption>{escape(caption)}</caption>\n<thead><tr>{heads}</tr></thead>\n"
        f"<tbody>{body}</tbody></table></div>\n"
    )


def _number(value: float | None, unit: str) -> str:
    """Returns a rounded number as text, with the exact one in its tag."""
    if value is None:
        return "–"
    return f'<data value="{value!r}">{format_figure(value, unit)}</data>'


def _count(value: float | None) -> str:
    return (
        "–"
        if value is None
        else f'<data value="{value!r}">{value:,.0f}</data>'.replace(",", "\u202f")
    )

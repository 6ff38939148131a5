"""Formats the figures as plain text, beside the paper's."""

from collections.abc import Mapping
from typing import Any

from neurotouch_hid.evaluation.accuracy.published_figures import FIGURES, Figure

BEYOND = (
    Figure("type accuracy from 2.5 mm", "gesture_accuracy_from_2.5_mm", "%"),
    Figure("time to type, median", "time_to_type_ms.median", "ms"),
    Figure("time to type, p95", "time_to_type_ms.p95", "ms"),
    Figure("gestures that change type", "type_changes", "%"),
    Figure("false gestures in 10 min", "false_gestures_per_10_min", ""),
    Figure("confidence off by", "reliability.error", "%"),
)
"""The figures that the paper does not report."""


def format_table(report: Mapping[str, Any]) -> str:
    """Returns all files together, ready to print.

    Args:
        report: the result of ``summarise``.
    """
    lines = [f"{'figure':<28}{'here':>10}{'paper':>10}"]
    lines += [
        f"{figure.name:<28}{format_figure(find_figure(report, figure.key), figure.unit):>10}"
        f"{format_figure(figure.paper, figure.unit):>10}"
        for figure in (*FIGURES, *BEYOND)
    ]
    lines += ["", f"{'gesture':<12}{'precision':>12}{'recall':>12}{'F1':>12}"]
    lines += [
        f"{label:<12}" + "".join(f"{format_figure(score[k], '%'):>12}" for k in score)
        for label, score in report["per_gesture"].items()
    ]
    lines += ["", *_format_confusion(report["confusion"])]
    lines += ["", *_format_bins(report["by_intensity"])]
    lines += ["", _format_amount(report)]
    return "\n".join(lines)


def _format_confusion(confusion: Mapping[str, Any]) -> list[str]:
    labels = confusion["labels"]
    return [
        "balanced confusion (row: labelled, column: recognised)",
        " " * 12 + "".join(f"{label:>11}" for label in labels),
        *(
            f"{label:<12}" + "".join(f"{format_figure(cell, ''):>11}" for cell in row)
            for label, row in zip(labels, confusion["balanced"], strict=True)
        ),
    ]


def _format_bins(bins: Mapping[str, Any]) -> list[str]:
    rows = zip(
        bins["edges_mm"],
        bins["edges_mm"][1:],
        bins["gesture_accuracy"],
        bins["count_accuracy"],
        bins["observations"],
        strict=False,
    )
    return [
        f"{'intensity mm':<16}{'type':>10}{'count':>10}{'slices':>10}",
        *(
            f"{low:>4.1f} to {high:<8.1f}{format_figure(kind, '%'):>10}"
            f"{format_figure(count, '%'):>10}{n:>10}"
            for low, high, kind, count, n in rows
        ),
    ]


def _format_amount(report: Mapping[str, Any]) -> str:
    speed = report["realtime_factor"]
    return (
        f"{report['observations']} slices compared, {report['frames']} frames, "
        f"{report['events']} events"
        + (f"; {speed:.1f} times as fast as recorded, on one core." if speed is not None else ".")
    )


def find_figure(report: Mapping[str, Any], key: str) -> float | None:
    """Returns one figure of a report.

    A dot separates nested keys, as in ``time_to_type_ms.p95``.
    """
    if key in report:
        value: float | None = report[key]
        return value
    part, _, rest = key.partition(".")
    return find_figure(report[part], rest)


def format_figure(value: float | None, unit: str) -> str:
    """Returns a figure for people: ``91.1 %``, ``3.41 mm``, ``-`` where it is undefined."""
    if value is None:
        return "-"
    if unit == "%":
        return f"{100 * value:.1f} %"
    if unit == "ms":
        return f"{value:.0f} ms"
    return f"{value:.2f} {unit}".rstrip()

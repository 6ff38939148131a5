"""The figures as plain text, beside the paper's."""

from collections.abc import Mapping
from typing import Any

_PAPER = (
    ("gesture type accuracy", "gesture_accuracy", "%", 0.9112),
    ("contact count accuracy", "count_accuracy", "%", 0.8322),
    ("contact point distance", "distance_mm", "mm", 3.41),
    ("intensity error (MAE)", "intensity_mae_mm", "mm", 0.96),
    ("resting position F1", "rest_f1", "%", 0.9403),
    ("resting position precision", "rest_precision", "%", None),
    ("resting position recall", "rest_recall", "%", None),
)
"""Name, key, unit and the paper's figure [NT, "Results"] on its own, unpublished data."""


def format_table(report: Mapping[str, Any]) -> str:
    """All files together, ready to print.

    Args:
        report: what ``summarise`` gives.
    """
    lines = [f"{'figure':<28}{'here':>10}{'paper':>10}"]
    lines += [
        f"{name:<28}{_number(report[key], unit):>10}{_number(paper, unit):>10}"
        for name, key, unit, paper in _PAPER
    ]
    lines += ["", f"{'gesture':<12}{'precision':>12}{'recall':>12}{'F1':>12}"]
    lines += [
        f"{label:<12}" + "".join(f"{_number(score[k], '%'):>12}" for k in score)
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
            f"{label:<12}" + "".join(f"{_number(cell, ''):>11}" for cell in row)
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
            f"{low:>4.1f} to {high:<8.1f}{_number(kind, '%'):>10}{_number(count, '%'):>10}{n:>10}"
            for low, high, kind, count, n in rows
        ),
    ]


def _format_amount(report: Mapping[str, Any]) -> str:
    speed = report["realtime_factor"]
    return (
        f"{report['observations']} slices compared, {report['frames']} frames, "
        f"{report['events']} events"
        + (f", {speed:.1f} times real time on one core." if speed is not None else ".")
    )


def _number(value: float | None, unit: str) -> str:
    if value is None:
        return "-"
    if unit == "%":
        return f"{100 * value:.1f} %"
    return f"{value:.2f} {unit}".rstrip()

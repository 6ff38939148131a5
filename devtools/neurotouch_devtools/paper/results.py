"""The figures of an evaluation as rows of a small table, which is committed."""

import csv
import io
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, Final, NamedTuple

from neurotouch_hid.evaluation.accuracy.published_figures import FIGURES
from neurotouch_hid.evaluation.accuracy.table import BEYOND, find_figure

FEWEST: Final = 20
"""A bin with fewer slices is left out, as the figure of the report draws it hollow."""

TYPES: Final = ("none", "push", "pinch", "zoom", "twist_cw", "twist_ccw")


class Result(NamedTuple):
    """One figure.

    Attributes:
        data: the set of recordings.
        method: of recognition.
        figure: its key in ``evaluate --json``; of a bin or a type, with its name.
        unit: ``%`` for a fraction of 1; empty for a number of things.
        of: number of slices, gestures or seconds that it was counted in.
        value: None where it is undefined.
    """

    data: str
    method: str
    figure: str
    unit: str
    of: int
    value: float | None


def list_results(
    data: str, method: str, report: Mapping[str, Any], *, whole: bool
) -> Iterator[Result]:
    """Returns the figures of a report.

    Args:
        data: the set of recordings.
        method: of recognition.
        report: the result of ``summarise``.
        whole: with the figures by type, by intensity and the confusions.
    """
    slices = report["observations"]
    yield Result(data, method, "observations", "", slices, slices)
    for item in (*FIGURES, *BEYOND):
        of = _count(report, item.key)
        unit = "/10 min" if item.key == "false_gestures_per_10_min" else item.unit
        yield Result(data, method, item.key, unit, of, find_figure(report, item.key))
    if whole:
        yield from (Result(data, method, *row) for row in _list_parts(report))


def _list_parts(report: Mapping[str, Any]) -> Iterator[tuple[str, str, int, float | None]]:
    labelled = {label: report["by_gesture"][label]["observations"] for label in TYPES}
    for label in TYPES:
        for key in ("precision", "recall", "f1"):
            value = report["per_gesture"][label][key]
            yield f"per_gesture.{label}.{key}", "%", labelled[label], value
        for key, unit in (
            ("count_accuracy", "%"),
            ("distance_mm", "mm"),
            ("intensity_mae_mm", "mm"),
        ):
            value = report["by_gesture"][label][key]
            yield f"by_gesture.{label}.{key}", unit, labelled[label], value
    confusion = report["confusion"]
    for label, cells in zip(confusion["labels"], confusion["balanced"], strict=True):
        for other, cell in zip(confusion["labels"], cells, strict=True):
            yield f"confusion.{label}.{other}", "%", labelled[label], cell
    bins = report["by_intensity"]
    for k, n in enumerate(bins["observations"]):
        if n >= FEWEST:
            for key in ("gesture_accuracy", "count_accuracy"):
                yield f"by_intensity.{bins['edges_mm'][k]:.1f}.{key}", "%", n, bins[key][k]


def _count(report: Mapping[str, Any], key: str) -> int:
    """Returns in how many slices, frames, gestures or seconds a figure was counted."""
    if key.startswith("rest_"):
        return int(report["frames"])
    if key.startswith("time_to_type_ms") or key == "type_changes":
        return int(report["time_to_type_ms"]["gestures"])
    if key == "false_gestures_per_10_min":
        return round(float(report["at_rest_s"]))
    return int(report["observations"])


def format_results(results: Iterable[Result]) -> str:
    """Returns the rows as CSV; values have six digits, undefined ones are empty."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(Result._fields)
    for row in results:
        writer.writerow([*row[:-1], "" if row.value is None else f"{row.value:.6g}"])
    return stream.getvalue()


def read_results(text: str) -> list[Result]:
    """Returns the rows of such a table."""
    return [
        Result(
            row["data"], row["method"], row["figure"], row["unit"], int(row["of"]),
            float(row["value"]) if row["value"] else None,
        )
        for row in csv.DictReader(io.StringIO(text))
    ]  # fmt: skip

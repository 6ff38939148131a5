"""Draws bar charts: the paper's table, the metrics and the errors of each gesture."""

from collections.abc import Mapping, Sequence
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from neurotouch_hid.evaluation.accuracy.published_figures import FIGURES, LABEL_UNCERTAINTY_MM
from neurotouch_hid.evaluation.accuracy.report.style import (
    BACKGROUND,
    INK,
    METHOD_COLOURS,
    METHOD_HATCHES,
    MUTED,
    add_grid,
    add_legend,
    method_bars,
    outline,
    paper_line,
)
from neurotouch_hid.evaluation.accuracy.table import find_figure, format_figure

Reports = Mapping[str, Mapping[str, Any]]
"""The results of ``summarise``, by method."""

_PUBLISHED = {figure.key: figure.paper for figure in FIGURES}
_GESTURES = ("push", "pinch", "zoom", "twist_cw", "twist_ccw")
_ROOM = 0.8  # of the distance between two groups of bars that the bars take


def draw_summary(reports: Reports) -> Figure:
    """Returns the paper's five figures, each method beside the published figure."""
    figure = Figure(figsize=(9.6, 3.6))
    panels = figure.subplots(1, 5)
    for axes, item in zip(panels, FIGURES[:5], strict=True):
        values = [[find_figure(report, item.key)] for report in reports.values()]
        draw_bars(axes, values, [""], item.unit, size=10)
        _mark(axes, item.paper)
        axes.set_title(item.name.replace(" ", "\n", 1), fontsize=10.5)
        axes.text(
            0.5, -0.03, f"paper: {format_figure(item.paper, item.unit)}", transform=axes.transAxes,
            ha="center", va="top", fontsize=10, color=INK,
        )  # fmt: skip
    add_legend(figure, [*method_bars(reports), paper_line()])
    return figure


def draw_type_metrics(reports: Reports) -> Figure:
    """Draws precision, recall, F1 and count accuracy [NT, figure of the metrics]."""
    figure = Figure(figsize=(9.6, 8.4))
    panels = figure.subplots(4, 1)
    labels = ("none", *_GESTURES)
    for axes, name in zip(panels, ("precision", "recall", "f1"), strict=False):
        values = [[r["per_gesture"][label][name] for label in labels] for r in reports.values()]
        draw_bars(axes, values, labels, "%")
        axes.set_title({"f1": "F1-score"}.get(name, name.capitalize()))
    values = [
        [r["by_gesture"][label]["count_accuracy"] for label in labels] for r in reports.values()
    ]
    draw_bars(panels[3], values, labels, "%")
    _mark(panels[3], _PUBLISHED["count_accuracy"])
    panels[3].set_title("Contact count accuracy (the paper's is over all gestures)")
    add_legend(figure, [*method_bars(reports), paper_line()])
    return figure


def draw_errors(reports: Reports) -> Figure:
    """Draws contact distance and intensity MAE by gesture [NT, figure of the errors]."""
    figure = Figure(figsize=(9.6, 5.4))
    panels = figure.subplots(2, 1)
    titles = ("Contact point distance", "Intensity error (MAE)")
    for axes, key, title in zip(panels, ("distance_mm", "intensity_mae_mm"), titles, strict=True):
        values = [[r["by_gesture"][label][key] for label in _GESTURES] for r in reports.values()]
        draw_bars(axes, values, _GESTURES, "mm")
        _mark(axes, _PUBLISHED[key])
        axes.set_title(f"{title} (the paper's is over all gestures)")
        axes.set_ylabel("mm")
    uncertain = panels[0].axhline(LABEL_UNCERTAINTY_MM, color=MUTED, lw=2, ls=":")
    uncertain.set_label("uncertainty of the paper's labels")
    add_legend(figure, [*method_bars(reports), paper_line(), uncertain])
    return figure


def draw_bars(
    axes: Axes,
    values: Sequence[Sequence[float | None]],
    labels: Sequence[str],
    unit: str,
    size: float = 9,
) -> None:
    """Draws groups of bars with their values: a group for each label, a bar for each method."""
    width = _ROOM / len(values)
    known = [value for row in values for value in row if value is not None]
    for k, row in enumerate(values):
        places = [i - _ROOM / 2 + (k + 0.5) * width for i in range(len(labels))]
        axes.bar(
            places, [value or 0.0 for value in row], 0.9 * width,
            color=METHOD_COLOURS[k], hatch=METHOD_HATCHES[k], edgecolor=BACKGROUND, linewidth=0,
        )  # fmt: skip
        for place, value in zip(places, row, strict=True):
            text = format_figure(value, unit).removesuffix(" %").removesuffix(" mm")
            axes.annotate(
                text if value is not None else "–", (place, value or 0.0), xytext=(0, 2),
                textcoords="offset points", ha="center", fontsize=size,
                zorder=4, path_effects=outline(),
            )  # fmt: skip
    axes.set_xticks(range(len(labels)), [label.replace("_", " ") for label in labels])
    axes.set_xlim(-0.5, len(labels) - 0.5)
    if unit == "%":
        axes.set_ylim(0, 1.12)
        axes.set_yticks([0, 0.25, 0.5, 0.75, 1], ["0", "25", "50", "75", "100 %"])
    else:
        axes.set_ylim(0, 1.2 * max([*known, 0.1 if unit else 1.0]))
    add_grid(axes)


def _mark(axes: Axes, paper: float | None) -> None:
    """Draws a dashed line at the paper's figure, always within the panel."""
    if paper is not None:
        axes.axhline(paper, color=INK, lw=1.5, ls=(0, (4, 2)))
        axes.set_ylim(0, max(axes.get_ylim()[1], 1.2 * paper) if paper > 1 else None)

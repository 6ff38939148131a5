"""Draws figures over intensity, time and confidence, and the confusion matrix."""

from collections.abc import Mapping, Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from neurotouch_hid.evaluation.accuracy.published_figures import (
    COUNT_BY_INTENSITY,
    TYPE_BY_INTENSITY,
    ZOOM_AS_PUSH,
)
from neurotouch_hid.evaluation.accuracy.report.bars import Reports, draw_bars
from neurotouch_hid.evaluation.accuracy.report.style import (
    BACKGROUND,
    BLUE,
    GRID,
    INK,
    METHOD_COLOURS,
    METHOD_DASHES,
    METHOD_MARKERS,
    MUTED,
    add_grid,
    add_legend,
    method_lines,
)
from neurotouch_hid.evaluation.accuracy.type_timing import TypeTiming

_PERCENT = ([0, 0.25, 0.5, 0.75, 1], ["0", "25", "50", "75", "100 %"])
_FEW = 20  # slices in a bin below which its accuracy says little
_SLOWEST_MS = 500.0  # end of the axis of times


def draw_intensity(reports: Reports) -> Figure:
    """Draws type and count accuracy in bins of 0.6 mm [NT, accuracy over intensity]."""
    figure = Figure(figsize=(9.6, 7.2))
    panels = figure.subplots(3, 1, sharex=True, height_ratios=(3, 3, 1))
    parts = (
        ("gesture_accuracy", "Gesture type accuracy", TYPE_BY_INTENSITY),
        ("count_accuracy", "Contact count accuracy", COUNT_BY_INTENSITY),
    )
    for axes, (key, title, published) in zip(panels, parts, strict=False):
        for k, report in enumerate(reports.values()):
            _draw_bins(axes, report["by_intensity"], key, k)
        axes.plot(*zip(*published, strict=True), "D", color=INK, ms=8, mfc="none", mew=2, zorder=5)
        axes.set_title(title)
        axes.set_yticks(*_PERCENT)
        axes.set_ylim(-0.03, 1.06)
        add_grid(axes)
    bins = next(iter(reports.values()))["by_intensity"]
    edges = bins["edges_mm"]
    panels[2].stairs(bins["observations"], edges, fill=True, color=GRID)
    panels[2].set_title("Slices in each bin")
    panels[2].set_xlabel("labelled intensity, mm")
    panels[2].set_xlim(0, max(15.0, edges[-1]))
    add_grid(panels[2])
    diamond = Line2D(
        [], [], color=INK, marker="D", ls="", ms=8, mfc="none", mew=2,
        label="published in the paper",
    )  # fmt: skip
    add_legend(figure, [*method_lines(reports), diamond])
    return figure


def _draw_bins(axes: Axes, bins: Mapping[str, list[float]], key: str, k: int) -> None:
    """Draws a line through the bins of one method; bins with few slices are hollow."""
    edges = bins["edges_mm"]
    rows = [
        ((low + high) / 2, value, n)
        for low, high, value, n in zip(
            edges, edges[1:], bins[key], bins["observations"], strict=False
        )
        if value is not None
    ]
    colour = METHOD_COLOURS[k]
    axes.plot(*_columns(rows), color=colour, ls=METHOD_DASHES[k])
    for face, chosen in (
        (colour, [row for row in rows if row[2] >= _FEW]),
        (BACKGROUND, [row for row in rows if row[2] < _FEW]),
    ):
        axes.plot(*_columns(chosen), METHOD_MARKERS[k], color=colour, mfc=face, ms=6)


def _columns(rows: Sequence[tuple[float, float, float]]) -> tuple[list[float], list[float]]:
    return [row[0] for row in rows], [row[1] for row in rows]


def draw_confusion(reports: Reports) -> Figure:
    """Draws the mean of both normalisations for each method [NT, confusion matrix]."""
    figure = Figure(figsize=(4.9 * max(len(reports), 1.25), 5.1))
    panels = figure.subplots(1, len(reports), squeeze=False)[0]
    for axes, (name, report) in zip(panels, reports.items(), strict=True):
        _draw_matrix(axes, report["confusion"]["labels"], report["confusion"]["balanced"])
        axes.set_title(f"method {name}")
    return figure


def _draw_matrix(axes: Axes, labels: list[str], cells: list[list[float | None]]) -> None:
    for i, row in enumerate(cells):
        for j, cell in enumerate(row):
            value = cell or 0.0
            axes.add_patch(_cell(j, i, value))
            axes.text(
                j, i, "–" if cell is None else f"{cell:.2f}",
                ha="center", va="center", fontsize=10.5,
                color="white" if value > 0.45 else INK if value >= 0.005 else MUTED,
            )  # fmt: skip
    published = (labels.index("push"), labels.index("zoom"))
    axes.text(
        published[0], published[1] + 0.36, f"paper {ZOOM_AS_PUSH:.2f}", ha="center", fontsize=7.5
    )
    names = [label.replace("_", "\n") for label in labels]
    axes.set_xticks(range(len(labels)), names)
    axes.set_yticks(range(len(labels)), [label.replace("_", " ") for label in labels])
    axes.set_xlim(-0.5, len(labels) - 0.5)
    axes.set_ylim(len(labels) - 0.5, -0.5)
    axes.set_xlabel("recognised")
    axes.set_ylabel("labelled")
    axes.set_aspect("equal")
    axes.tick_params(length=0)
    for spine in axes.spines.values():
        spine.set_visible(False)


def _cell(column: int, row: int, value: float) -> Rectangle:
    """Draws a square as opaque as its value, so that the background means 0."""
    return Rectangle(
        (column - 0.48, row - 0.48), 0.96, 0.96, facecolor=(BLUE, value), edgecolor=GRID, lw=0.8
    )


def draw_times(timings: Mapping[str, TypeTiming], reports: Reports) -> Figure:
    """Draws the time until types are recognised, and the shares of changed and false gestures."""
    figure = Figure(figsize=(9.6, 4.2))
    axes, changes, invented = figure.subplots(1, 3, width_ratios=(3.6, 1, 1))
    for k, timing in enumerate(timings.values()):
        _draw_shares(axes, timing, k)
    for share, name in ((0.5, "median"), (0.95, "p95")):
        axes.axhline(share, color=MUTED, lw=1, ls=":")
        axes.annotate(
            name, (1, share), xycoords=("axes fraction", "data"), xytext=(-2, -3),
            textcoords="offset points", ha="right", va="top", color=MUTED, fontsize=10,
        )  # fmt: skip
    axes.set_xlim(-0.01 * _SLOWEST_MS, _SLOWEST_MS)
    axes.set_ylim(0, 1.04)
    axes.set_yticks(*_PERCENT)
    axes.set_title("Gestures whose type\nis recognised")
    axes.set_xlabel("time since the labelled intensity reached 2.5 mm, ms")
    add_grid(axes)
    values = [[report["type_changes"]] for report in reports.values()]
    draw_bars(changes, values, [""], "%", size=10)
    changes.set_title("Gestures that\nchange type")
    values = [[report["false_gestures_per_10_min"]] for report in reports.values()]
    draw_bars(invented, values, [""], "", size=10)
    invented.set_title("False gestures\nin 10 min rest")
    add_legend(figure, method_lines(reports))
    return figure


def _draw_shares(axes: Axes, timing: TypeTiming, k: int) -> None:
    """Draws a step up for each gesture of one method; late ones lie beyond the axis."""
    times = sorted(min(time, 2 * _SLOWEST_MS) for time in timing.times_ms)
    shares = [(i + 1) / timing.gestures for i in range(len(times))]
    axes.step(
        [0.0, *times, 2 * _SLOWEST_MS], [0.0, *shares, shares[-1] if shares else 0.0],
        where="post", color=METHOD_COLOURS[k], ls=METHOD_DASHES[k],
    )  # fmt: skip


def draw_reliability(reports: Reports) -> Figure:
    """Draws the share of right types over the confidence."""
    figure = Figure(figsize=(6.4, 5.6))
    axes, amounts = figure.subplots(2, 1, sharex=True, height_ratios=(4, 1))
    (honest,) = axes.plot([0, 1], [0, 1], color=MUTED, ls=":", label="as good as said")
    for k, report in enumerate(reports.values()):
        bins = report["reliability"]
        known = [i for i, n in enumerate(bins["observations"]) if n]
        axes.plot(
            [bins["confidence"][i] for i in known], [bins["accuracy"][i] for i in known],
            color=METHOD_COLOURS[k], marker=METHOD_MARKERS[k], ls=METHOD_DASHES[k], ms=7,
        )  # fmt: skip
        total = sum(bins["observations"]) or 1
        shares = [n / total for n in bins["observations"]]
        amounts.stairs(shares, bins["edges"], color=METHOD_COLOURS[k], ls=METHOD_DASHES[k], lw=2)
    axes.set_xlim(0, 1.02)
    axes.set_ylim(0, 1.04)
    axes.set_yticks(*_PERCENT)
    axes.set_title("Slices whose type is right")
    amounts.set_title("Share of the slices")
    amounts.set_ylim(0, 1)
    amounts.set_yticks([0, 0.5, 1], ["0", "50", "100 %"])
    amounts.set_xlabel("confidence")
    add_grid(axes)
    add_grid(amounts)
    add_legend(figure, [*method_lines(reports), honest])
    return figure

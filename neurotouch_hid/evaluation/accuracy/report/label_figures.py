"""Draws figures of the labels, as the paper does for its own data set."""

import numpy as np
from matplotlib.colors import LinearSegmentedColormap, to_rgba
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle

from neurotouch_hid.evaluation.accuracy.label_statistics import LabelStatistics
from neurotouch_hid.evaluation.accuracy.published_figures import (
    INTENSITY_MAX_MM,
    INTENSITY_RANGES_MM,
    LABELS,
    LABELS_GESTURE,
    LABELS_NONE,
    SPEED_RANGE_MM_S,
)
from neurotouch_hid.evaluation.accuracy.report.style import BLUE, INK, MUTED, add_grid, add_legend
from neurotouch_hid.evaluation.accuracy.tally import BIN_MM
from neurotouch_hid.messages import GestureKind

_NAMES = [kind.label.replace("_", " ") for kind in GestureKind]


def draw_classes(labels: LabelStatistics) -> Figure:
    """Draws the share of each labelled type [NT, figure of the types]."""
    figure = Figure(figsize=(7.2, 4.2))
    axes = figure.subplots()
    counts = np.bincount(labels.kinds, minlength=len(GestureKind))
    shares = counts / counts.sum()
    axes.bar(range(len(shares)), shares, 0.7, color=BLUE)
    for k, (share, count) in enumerate(zip(shares, counts, strict=True)):
        axes.annotate(
            f"{count:,}".replace(",", "\u202f"), (k, share), xytext=(0, 3),
            textcoords="offset points", ha="center",
        )  # fmt: skip
        low, high = (LABELS_NONE, LABELS_NONE) if k == 0 else LABELS_GESTURE
        middle, reach = (low + high) / 2 / LABELS, (high - low) / 2 / LABELS
        axes.errorbar(k + 0.42, middle, reach, color=INK, marker="D", mfc="none", ms=6, capsize=4)
    axes.set_xticks(range(len(shares)), _NAMES)
    axes.yaxis.set_major_formatter(lambda value, _: f"{100 * value:.0f} %")
    axes.set_title("Labels of each type: share and number")
    add_grid(axes)
    published = Line2D(
        [], [], color=INK, marker="D", mfc="none", ms=6, lw=1.5, label="share in the paper's data"
    )
    add_legend(figure, [published])
    return figure


def draw_contacts(labels: LabelStatistics) -> Figure:
    """Draws the contact points on the gel [NT, figure of the contact points]."""
    figure = Figure(figsize=(5.6, 5.2))
    axes = figure.subplots()
    reach = labels.radius_mm + 2
    image = axes.hexbin(
        *labels.contacts_mm.T, gridsize=32, extent=(-reach, reach, -reach, reach), mincnt=1,
        cmap=LinearSegmentedColormap.from_list("", [to_rgba(BLUE, 0.2), to_rgba(BLUE)]), lw=0,
    )  # fmt: skip
    axes.add_patch(Circle((0, 0), labels.radius_mm, fill=False, color=INK, lw=1.5))
    axes.set_xlim(-reach, reach)
    axes.set_ylim(reach, -reach)
    axes.set_aspect("equal")
    axes.set_xlabel("right, mm")
    axes.set_ylabel("towards the user, mm")
    axes.set_title("Labelled contact points on the gel")
    axes.tick_params(length=0)
    bar = figure.colorbar(image, ax=axes, shrink=0.7)
    bar.outline.set_visible(False)
    bar.set_label("labels", color=INK)
    return figure


def draw_intensities(labels: LabelStatistics) -> Figure:
    """Draws all labels in bins of 0.6 mm [NT, figure of the intensity labels]."""
    figure = Figure(figsize=(9.6, 3.4))
    axes = figure.subplots()
    values = labels.intensity_mm[labels.kinds != GestureKind.NONE]
    n = max(int(np.ceil(max([INTENSITY_MAX_MM, *values]) / BIN_MM)), 1)
    axes.hist(values, bins=[k * BIN_MM for k in range(n + 2)], color=BLUE, rwidth=0.88)
    axes.axvline(INTENSITY_MAX_MM, color=INK, lw=1.5, ls=(0, (4, 2)))
    axes.annotate(
        "largest in the paper's data", (INTENSITY_MAX_MM, 0.95), xycoords=("data", "axes fraction"),
        xytext=(-5, 0), textcoords="offset points", ha="right", va="top",
    )  # fmt: skip
    axes.set_xlabel("labelled intensity, mm")
    axes.set_title("Labels in each bin of 0.6 mm, without none")
    add_grid(axes)
    return figure


def draw_speeds(labels: LabelStatistics) -> Figure:
    """Draws the change of intensity between labels [NT, figure of the speeds]."""
    figure = Figure(figsize=(9.6, 3.4))
    axes = figure.subplots()
    low, high = SPEED_RANGE_MM_S
    reach = float(np.ceil(max(np.abs([low, high, *labels.speed_mm_s])) / 10) * 10)
    edges = list(np.arange(-reach, reach + 10, 10.0))
    axes.hist(labels.speed_mm_s, bins=edges, color=BLUE, rwidth=0.88)
    axes.set_yscale("log")
    for edge, side in ((low, "left"), (high, "right")):
        axes.axvline(edge, color=INK, lw=1.5, ls=(0, (4, 2)))
        axes.annotate(
            "end of the paper's", (edge, 0.95), xycoords=("data", "axes fraction"),
            xytext=(5 if side == "left" else -5, 0), textcoords="offset points", ha=side, va="top",
        )  # fmt: skip
    axes.set_xlabel("speed, mm/s (release below 0, attack above)")
    axes.set_title("Labels in each bin of 10 mm/s, logarithmic")
    add_grid(axes)
    return figure


def draw_boxes(labels: LabelStatistics) -> Figure:
    """Draws intensities by type, whiskers from least to largest [NT, box plot]."""
    figure = Figure(figsize=(7.2, 4.4))
    axes = figure.subplots()
    kinds = list(GestureKind)[1:]
    line = {"color": INK, "linewidth": 1.5}
    for k, kind in enumerate(kinds):
        values = labels.intensity_mm[labels.kinds == kind]
        if len(values):
            axes.boxplot(
                values, positions=[k], widths=0.5, patch_artist=True,
                showmeans=True, boxprops={"facecolor": (BLUE, 0.35), **line}, medianprops=line,
                whiskerprops=line, capprops=line,
                meanprops={"marker": "o", "markerfacecolor": INK, "markeredgecolor": INK},
            )  # fmt: skip
        if kind.label in INTENSITY_RANGES_MM:
            low, high = INTENSITY_RANGES_MM[kind.label]
            axes.plot([k + 0.38] * 2, [low, high], color=MUTED, marker="_", ms=9, mew=2)
    axes.set_xticks(range(len(kinds)), _NAMES[1:])
    axes.set_xlim(-0.6, len(kinds) - 0.4)
    axes.set_ylim(0)
    axes.set_ylabel("labelled intensity, mm")
    axes.set_title("Intensity by type: quartiles, ends, mean (dot)")
    add_grid(axes)
    published = Line2D(
        [], [], color=MUTED, marker="_", mew=2, ms=9, label="range in the paper's data"
    )
    add_legend(figure, [published])
    return figure

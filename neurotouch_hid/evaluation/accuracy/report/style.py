"""Style of all figures: colours that colour-blind people can tell apart, light and dark."""

import io
import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import matplotlib as mpl
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.patheffects import AbstractPathEffect, withStroke

INK, MUTED, GRID, BACKGROUND = "#1f2328", "#59636e", "#d5dae0", "#fffffe"
"""Text, secondary text, grid, background; each has a twin in ``_DARK`` and no other use."""
_DARK = {INK: "#e6edf3", MUTED: "#9aa4ae", GRID: "#30363d", BACKGROUND: "#0d1117"}

BLUE, VERMILION, GREEN, PURPLE = "#0072b2", "#d55e00", "#009e73", "#cc79a7"
"""From Okabe and Ito's palette."""
METHOD_COLOURS = (BLUE, VERMILION, GREEN, PURPLE)
METHOD_MARKERS = ("o", "s", "^", "v")
METHOD_HATCHES = ("", "////", "....", "xxxx")
METHOD_DASHES = ("-", "--", "-.", ":")

_RC: dict[Any, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 11,
    "axes.titlesize": 12,
    "axes.titlelocation": "left",
    "axes.titlepad": 10,
    "axes.labelsize": 11,
    "axes.edgecolor": MUTED,
    "axes.labelcolor": INK,
    "axes.titlecolor": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.facecolor": BACKGROUND,
    "axes.axisbelow": True,
    "boxplot.whiskers": (
        0.0,
        100.0,
    ),  # percentiles: the whiskers reach the least and the largest value
    "figure.facecolor": BACKGROUND,
    "figure.constrained_layout.use": True,
    "figure.constrained_layout.h_pad": 0.08,
    "figure.constrained_layout.w_pad": 0.08,
    "grid.color": GRID,
    "grid.linewidth": 0.8,
    "hatch.linewidth": 0.8,
    "legend.frameon": False,
    "legend.labelcolor": INK,
    "lines.linewidth": 2.0,
    "text.color": INK,
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "xtick.labelsize": 10,
    "ytick.labelsize": 10,
    "svg.hashsalt": "neurotouch",  # the same figure, the same file
}


@contextmanager
def apply_style() -> Iterator[None]:
    """Applies this style to figures made inside the block; other figures do not change."""
    with mpl.rc_context(_RC):
        yield


def render_svg(figure: Figure) -> str:
    """Returns the figure as SVG that follows the viewer's ``prefers-color-scheme``.

    Colours stay in the elements, so that programs without style sheets show the light figure. The
    style sheet only overrides colours that have a dark twin.
    """
    stream = io.StringIO()
    blank = dict.fromkeys(("Creator", "Date", "Format", "Type"))
    figure.savefig(stream, format="svg", metadata=blank)
    svg = stream.getvalue()
    rules = "".join(
        f'[style*="{name}: {light}"]{{{name}:{dark}!important}}'
        for light, dark in _DARK.items()
        for name in ("fill", "stroke")
    )
    sheet = f"<style>@media (prefers-color-scheme:dark){{{rules}}}</style>"
    svg = svg[svg.index("<svg") :]  # without the reference to a DTD
    return re.sub(r"(<svg[^>]*>)", lambda tag: tag[1] + sheet, svg, count=1)


def add_grid(axes: Axes, axis: str = "y") -> None:
    """Adds thin lines behind the data, along one axis."""
    axes.grid(visible=True, axis=axis)  # type: ignore[arg-type]
    axes.tick_params(length=0)


def add_legend(figure: Figure, handles: Sequence[Artist]) -> None:
    """Adds one legend above all panels."""
    figure.legend(handles=handles, loc="outside upper left", ncols=len(handles))


def method_bars(methods: Iterable[str]) -> list[Artist]:
    """Returns the legend's entries for the bars of each method."""
    return [
        Patch(facecolor=colour, hatch=hatch, edgecolor=BACKGROUND, lw=0, label=f"method {name}")
        for name, colour, hatch in zip(methods, METHOD_COLOURS, METHOD_HATCHES, strict=False)
    ]


def method_lines(methods: Iterable[str]) -> list[Artist]:
    """Returns the legend's entries for the lines of each method."""
    looks = zip(methods, METHOD_COLOURS, METHOD_MARKERS, METHOD_DASHES, strict=False)
    return [
        Line2D([], [], color=colour, marker=marker, ms=7, ls=dash, label=f"method {name}")
        for name, colour, marker, dash in looks
    ]


def paper_line() -> Line2D:
    """Returns the legend's entry for a dashed line at the paper's own figure."""
    return Line2D([], [], color=INK, ls=(0, (4, 2)), lw=1.5, label="published in the paper")


def outline() -> list[AbstractPathEffect]:
    """Returns path effects that keep a text readable on a line."""
    return [withStroke(linewidth=3, foreground=BACKGROUND)]

"""Draws the worst moments: markers and their motion, the labels and the prediction."""

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from numpy.typing import NDArray

from neurotouch_hid.evaluation.accuracy.files import Evaluation
from neurotouch_hid.evaluation.accuracy.moments import N_WORST, WorstMoment
from neurotouch_hid.evaluation.accuracy.report.style import BLUE, GRID, INK, MUTED, VERMILION
from neurotouch_hid.messages import Gesture, Truth

_REACH = 1.15  # half of the picture's side, in radii of the gel


@dataclass(frozen=True, slots=True, eq=False)
class Failure:
    """A moment and its recording."""

    file: str
    moment: WorstMoment

    def expected(self) -> str:
        """Returns the labelled gesture, in words."""
        return _describe(self.moment.truth)

    def recognised(self) -> str:
        """Returns the recognised gesture, in words."""
        return _describe(self.moment.gesture)


def find_failures(evaluation: Evaluation) -> list[Failure]:
    """Returns the worst moments of all recordings, the worst first; at most ``N_WORST``."""
    failures = [
        Failure(file, moment)
        for file, played in evaluation.files.items()
        for moment in played.worst
    ]
    return sorted(failures, key=lambda failure: -failure.moment.severity_mm)[:N_WORST]


def draw_failure(failure: Failure) -> Figure:
    """Returns a figure of one moment, as the camera sees it.

    Measured markers are filled, guessed ones hollow.
    """
    moment = failure.moment
    figure = Figure(figsize=(4.6, 4.9))
    axes = figure.subplots()
    _draw_markers(axes, moment)
    _draw_contacts(axes, moment.truth.contacts_px, "o", BLUE, 19)
    _draw_contacts(axes, moment.gesture.contacts_px, "x", VERMILION, 11)
    (x, y), radius_mm = moment.rig.centre_px, moment.markers.gel.radius_mm
    reach = _REACH * radius_mm * moment.rig.px_per_mm
    axes.set_xlim(x - reach, x + reach)
    axes.set_ylim(y + reach, y - reach)
    axes.set_aspect("equal")
    axes.set_axis_off()
    figure.text(0.03, 0.985, "○", color=BLUE, va="top", weight="bold")
    figure.text(0.08, 0.985, f"expected: {failure.expected()}", va="top")
    figure.text(0.03, 0.935, "×", color=VERMILION, va="top", weight="bold")
    figure.text(0.08, 0.935, f"recognised: {failure.recognised()}", va="top")
    figure.get_layout_engine().set(rect=(0, 0, 1, 0.9))  # type: ignore[union-attr, call-arg]
    return figure


def _draw_markers(axes: Axes, moment: WorstMoment) -> None:
    markers, rig = moment.markers, moment.rig
    radius_px = markers.gel.radius_mm * rig.px_per_mm
    contour = Circle(rig.centre_px, radius_px, fill=False, color=GRID, lw=1.5)
    axes.add_patch(contour)
    moved = markers.position_px - markers.rest_px
    axes.quiver(
        *markers.rest_px.T, *moved.T, angles="xy", scale_units="xy", scale=1, color=MUTED,
        width=0.0045, headwidth=4, headlength=4.5, headaxislength=4, minlength=0.4,
    )  # fmt: skip
    for chosen, face in ((markers.valid, INK), (~markers.valid, "none")):
        axes.plot(*markers.position_px[chosen].T, "o", ms=2.4, mfc=face, mec=INK, mew=0.7)


def _draw_contacts(
    axes: Axes, points: NDArray[np.float64], marker: str, colour: str, size: float
) -> None:
    axes.plot(*points.T, marker, ms=size, mfc="none", mec=colour, mew=3, ls="")


def _describe(answer: Gesture | Truth) -> str:
    """Returns for example ``pinch, 2 contacts, 4.1 mm``."""
    name, n = answer.kind.label.replace("_", " "), len(answer.contacts_px)
    if not n:
        return name
    return f"{name}, {n} contact{'s' if n > 1 else ''}, {answer.intensity_mm:.1f} mm"

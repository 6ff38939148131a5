"""The figures that the paper prints about its own, unpublished data [NT, "Results"]."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Figure:
    """One figure of a report, and the paper's.

    Attributes:
        name: in words.
        key: its key in the result of ``summarise``; a dot separates nested keys.
        unit: ``%`` for a fraction of 1, otherwise as printed.
        paper: the paper's figure, None where it has none.
    """

    name: str
    key: str
    unit: str
    paper: float | None = None


FIGURES = (
    Figure("gesture type accuracy", "gesture_accuracy", "%", 0.9112),
    Figure("contact count accuracy", "count_accuracy", "%", 0.8322),
    Figure("contact point distance", "distance_mm", "mm", 3.41),
    Figure("intensity error (MAE)", "intensity_mae_mm", "mm", 0.96),
    Figure("resting position F1", "rest_f1", "%", 0.9403),
    Figure("resting position precision", "rest_precision", "%"),
    Figure("resting position recall", "rest_recall", "%"),
)
TYPE_BY_INTENSITY = ((2.5, 0.90), (4.2, 0.95), (12.1, 1.0))
"""(mm, type accuracy) from the text; the figure's description has 3 mm for the first."""
COUNT_BY_INTENSITY = ((6.1, 0.80), (7.0, 0.90), (14.5, 1.0))
"""(mm, count accuracy) from the figure's description; the last is "near-perfect"."""
ZOOM_AS_PUSH = 0.13
"""The largest confusion, in the balanced matrix."""
LABEL_UNCERTAINTY_MM = 4.0
"""Uncertainty of a labelled contact point: the marker spacing."""
LABELS = 37_912
LABELS_NONE = 15_000
LABELS_GESTURE = (4_000, 5_000)
"""Approximate number of frames labelled none, and the range of those of each gesture."""
INTENSITY_MAX_MM = 18.1
SPEED_RANGE_MM_S = (-220.0, 190.0)
INTENSITY_RANGES_MM = {"push": (0.1, 17.5), "zoom": (0.0, 8.0)}
"""The ends of the box plot, for the gestures whose ends its description gives."""

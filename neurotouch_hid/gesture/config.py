"""Settings of the gesture stage."""

from dataclasses import dataclass
from typing import Literal

NeutralPose = Literal["lifted", "resting"]


@dataclass(frozen=True, slots=True)
class GestureConfig:
    """Settings of the gesture stage.

    Attributes:
        method: the recogniser: ``neurotouch``, ``paper`` [NT, "Methodology"], or the name of
            another package's method (``neurotouch.methods``).
        neutral: the pose that counts as no gesture: ``lifted``, the gel untouched, or ``resting``,
            a hand that rests on it, see ``Neutral``.
        min_tracked: with a smaller share of measured markers than this there is no gesture. A lost
            gel presses no buttons.
        radius_px: of ``paper``: r, 30 px or about 12 mm, the radius of a fingertip [NT, "Results"].
        threshold_ratio: of ``paper``: a, reprojection threshold over mean displacement.
        min_neighbours: of ``paper``: N_min, outliers around a local maximum.
        threshold_floor_px: of ``paper``: least reprojection threshold, three standard deviations of
            a tracking error of 0.2 px on one axis.
        rest_gate_px: of ``paper``: mean displacement within r that ends rest, 0.2 mm. The mean of
            the ten markers within r at the gel's rim has an error of 0.1 px on one axis, if a
            marker has 0.3 px; the largest of all such means stays below 0.4 px.
    """

    method: str = "neurotouch"
    neutral: NeutralPose = "lifted"
    min_tracked: float = 0.505
    radius_px: float = 30.0
    threshold_ratio: float = 0.6
    min_neighbours: int = 4
    threshold_floor_px: float = 0.6
    rest_gate_px: float = 0.5

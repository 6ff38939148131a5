"""How gestures are recognised."""

from dataclasses import dataclass
from typing import Literal

NeutralPose = Literal["lifted", "resting"]


@dataclass(frozen=True, slots=True)
class GestureConfig:
    """Hyper-parameters of the gesture stage.

    Attributes:
        method: how a gesture is found: ``neurotouch``, ``paper`` [NT, "Methodology"], or the name
            that another package gives its own (``neurotouch.methods``).
        neutral: what counts as no gesture: ``lifted``, the gel untouched, or ``resting``, the pose
            of a hand that stays on it, known once it has been still, see ``Neutral``.
        min_tracked: measured markers, about half, without which nothing is recognised: a lost gel
            presses no buttons.
        radius_px: of ``paper``: r, 30 px or about 12 mm, the radius of a fingertip [NT, "Results"].
        threshold_ratio: of ``paper``: a, reprojection threshold over mean displacement.
        min_neighbours: of ``paper``: N_min, outliers a local maximum must have around it.
        threshold_floor_px: of ``paper``: least reprojection threshold: 3 sigma of a tracking error
            of 0.2 px an axis.
        rest_gate_px: of ``paper``: mean displacement within r that ends rest, 0.2 mm. The ten
            markers that r holds at the gel's rim leave 0.1 px an axis of an error of 0.3 px; the
            largest of all such means stays below 0.4 px.
    """

    method: str = "neurotouch"
    neutral: NeutralPose = "lifted"
    min_tracked: int = 90
    radius_px: float = 30.0
    threshold_ratio: float = 0.6
    min_neighbours: int = 4
    threshold_floor_px: float = 0.6
    rest_gate_px: float = 0.5

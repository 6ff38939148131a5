"""Classifies the gesture by the dominant part of a similarity fitted near the contacts."""

import math
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.messages import GestureKind

_MIN_POINTS = 2  # a similarity has four degrees of freedom


class Similarity(NamedTuple):
    """A similarity: scale, rotation (clockwise positive, y points down), translation in px."""

    scale: float = 1.0
    rotation_rad: float = 0.0
    translation_px: tuple[float, float] = (0.0, 0.0)


def fit_similarity(
    rest_px: NDArray[np.float64],
    position_px: NDArray[np.float64],
    origin_px: NDArray[np.float64],
    threshold_px: float,
) -> Similarity | None:
    """Returns the four-degree-of-freedom motion of the markers about an origin, by RANSAC.

    [NT, "Gesture Classification and Intensity Prediction"].
    Open in the paper: RANSAC's threshold. The callers pass r. A marker that is a fingertip away
    from its fitted place is mistracked; everything nearer belongs to the gesture. With a threshold
    of a few pixels RANSAC keeps only the strongest finger, whose motion is a pure translation, and
    most pinches become a push.

    Args:
        rest_px: (n, 2) float64 px, columns x, y.
        position_px: (n, 2) float64 px, the same markers now.
        origin_px: (2,) px: rotation and scale are about this point.
        threshold_px: distance beyond which a marker is an outlier.

    Returns:
        The motion, or None if the markers do not determine one.
    """
    if len(rest_px) < _MIN_POINTS:
        return None
    matrix, _ = cv2.estimateAffinePartial2D(
        rest_px - origin_px,
        position_px - origin_px,
        method=cv2.RANSAC,
        ransacReprojThreshold=threshold_px,
    )
    if matrix is None:
        return None
    a, b = float(matrix[0, 0]), float(matrix[1, 0])
    return Similarity(
        math.hypot(a, b), math.atan2(b, a), (float(matrix[0, 2]), float(matrix[1, 2]))
    )


def measure_reach(position_px: NDArray[np.float64], origin_px: NDArray[np.float64]) -> float:
    """Returns the radius of the even disc with the same rms distance from the origin, px.

    Args:
        position_px: (n, 2) float64 px, n >= 1.
        origin_px: (2,) px.
    """
    return math.sqrt(2 * float(((position_px - origin_px) ** 2).sum(axis=1).mean()))


def classify(motion: Similarity, reach_px: float) -> tuple[GestureKind, float]:
    """Returns the gesture kind and its lead over the next kind.

    Open in the paper: the unit of t, which is compared with pure numbers. Here it is the radius of
    the region that the motion was fitted to. All three numbers are then motions of the
    region's edge, and a gesture means the same for near and for wide fingers. With a fixed unit,
    the kind depends on the number of fingers: with the gel's radius every fourth slice of a push
    becomes a twist or a pinch; with r a third of the pinches becomes a push.
    Differs: the paper calls a clockwise turn negative; here it is positive, as image y points down.

    Args:
        motion: the similarity about the mean contact.
        reach_px: radius of the region, px, > 0.

    Returns:
        The kind, and 1 - second/first in 0..1.
    """
    turn = GestureKind.TWIST_CW if motion.rotation_rad > 0 else GestureKind.TWIST_CCW
    zoom = GestureKind.ZOOM if motion.scale > 1 else GestureKind.PINCH
    parts = [
        (math.hypot(*motion.translation_px) / reach_px, GestureKind.PUSH),
        (abs(motion.scale - 1), zoom),
        (abs(motion.rotation_rad), turn),
    ]
    (most, kind), (second, _), _ = sorted(parts, key=lambda part: -part[0])
    if most == 0:
        return GestureKind.NONE, 1.0
    return kind, 1 - second / most

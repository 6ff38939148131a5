"""What the fingers do together: their common motion, spreading and turning, compared in mm."""

import cmath
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.messages import GestureKind

Floats = NDArray[np.float64]

COMMON_GAIN = 1.6
"""How much the common motion must exceed the relative one to be a push. One finger that drags
beside one that only holds gives 1, two that push together with strengths 1 and 0.45 give 2.6: this
lies between. So a pinch is a pinch while its second finger still holds on."""
LEVER = 0.7
"""rms distance of a disc's points from its centre, share of its radius."""


@dataclass(frozen=True, slots=True)
class Motion:
    """A similarity of the fingers about their mean position.

    Attributes:
        translation_mm: (x, y) of the mean.
        rotation_rad: clockwise for the user positive.
        scale: 1 at rest.
        parts_mm: what speaks for each GestureKind, as a motion of the fingers in mm; NONE has 0.
    """

    translation_mm: tuple[float, float]
    rotation_rad: float
    scale: float
    parts_mm: Floats


def measure_motion(centres: Floats, radii: Floats, motions: Floats) -> Motion:
    """The motion of k >= 1 fingers.

    Args:
        centres: (k, 2) mm, where they stick to the gel at rest.
        radii: (k,) mm.
        motions: (k, 3): drag x, drag y in mm, sine of the turn.
    """
    parts = np.zeros(len(GestureKind))
    rest = centres @ (1, 1j)
    drag = motions[:, :2] @ (1, 1j)
    common = complex(drag.mean())
    if len(centres) == 1:
        rotation, scale = math.asin(float(motions[0, 2])), 1.0
        turn = abs(rotation) * LEVER * float(radii[0])
        parts[GestureKind.PUSH] = abs(common)
    else:
        arm = rest - rest.mean()
        inertia = float(np.vdot(arm, arm).real)
        similarity = 1.0 + complex(np.vdot(arm, drag)) / inertia
        rotation, scale = cmath.phase(similarity), abs(similarity)
        reach = math.sqrt(inertia / len(arm))
        turn, spread = abs(rotation) * reach, abs(scale - 1.0) * reach
        parts[GestureKind.ZOOM if scale > 1.0 else GestureKind.PINCH] = spread
        parts[GestureKind.PUSH] = abs(common) / COMMON_GAIN
    parts[GestureKind.TWIST_CW if rotation > 0 else GestureKind.TWIST_CCW] = turn
    return Motion((common.real, common.imag), rotation, scale, parts)

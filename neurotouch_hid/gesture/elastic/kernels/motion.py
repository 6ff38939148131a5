"""Computes the common motion of the fingers, its parts, and the contacts that are shown."""

import math

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.gesture.elastic.kernels.field import VIEW_MM
from neurotouch_hid.process.kernel_cache import kernel
from neurotouch_hid.vocabulary import GestureKind

Floats = NDArray[np.float64]

DRAG_X, DRAG_Y, TURN = range(3)
"""The columns of a motion: drag in mm, and sine of the turn."""

COMMON_GAIN = 1.6
"""How much the common motion must exceed the relative one to be a push. One finger that drags
beside a still one gives 1; two that push together with strengths 1 and 0.45 give 2.6. This value
is between, so a pinch is a pinch while its second finger keeps still."""
LEVER = 0.7
"""rms distance of a disc's points from its centre, as a share of its radius."""
TURN_GAIN = 2.0
"""How much more a single finger must turn than drag to be a twist: a tip that drags turns too."""

SEVERAL_MM = 0.05
"""By how much more several fingers must go the same way to be a push: most that land together do
something else, and their trembles leave a common motion."""

LANDING_US = 60_000  # length of a finger's first motions, whose mean is its landing
LANDING_MM = 0.5  # no finger lands with a longer drag; more is the beginning of a quick gesture
LANDING_SHARE = 0.8
"""The share of the landing that is subtracted; the rest counts while there is nothing else."""
SHOWN_MM = 0.34  # people label a contact whose dots go about 0.3 mm where they go farthest
HIDDEN_SHARE = 7 / 8  # a contact is hidden below this share of it, so that noise does not toggle it

_PUSH, _PINCH, _ZOOM = int(GestureKind.PUSH), int(GestureKind.PINCH), int(GestureKind.ZOOM)
_CW, _CCW = int(GestureKind.TWIST_CW), int(GestureKind.TWIST_CCW)


@kernel
def measure_size(motion: Floats, radius: float) -> float:
    """Returns how far a finger moves the gel under it, mm: rms over its patch, without the press.

    Args:
        motion: (3,) float64, drag x, drag y in mm, sine of the turn.
        radius: mm.
    """
    x, y, turn = motion[DRAG_X], motion[DRAG_Y], motion[TURN]
    return math.sqrt(x * x + y * y + 0.5 * (turn * radius) ** 2)


@kernel
def measure_peak(centre: Floats, radius: float, motion: Floats, press: float) -> float:
    """Returns how far dots under a finger seem to go where they go farthest, mm.

    People see a gesture by this peak [NT, "Contact Point Detection"]: on one side of a finger drag
    and turn add up, and a pressed patch looks larger.

    Args:
        centre: (2,) float64 mm, on the gel at rest.
        radius: mm.
        motion: (3,) float64, drag x, drag y in mm, sine of the turn.
        press: mm; its markers seem to move away from the middle of the picture.
    """
    x = motion[DRAG_X] + press / VIEW_MM * centre[0]
    y = motion[DRAG_Y] + press / VIEW_MM * centre[1]
    peak_mm: float = math.hypot(x, y) + LEVER * abs(motion[TURN]) * radius
    return peak_mm


@kernel
def measure_motion(
    centres: Floats, radii: Floats, motions: Floats, parts: Floats
) -> tuple[float, float, float, float]:
    """Returns the similarity of k >= 1 fingers about their mean position.

    Args:
        centres: (k, 2) float64 mm, where they stick to the gel at rest.
        radii: (k,) float64 mm.
        motions: (k, 3) float64: drag x, drag y in mm, sine of the turn.
        parts: (6,) float64 mm, written: the part of the motion that speaks for each GestureKind;
            NONE has 0.

    Returns:
        Translation of the mean, x and y in mm; rotation in rad, clockwise for the user positive;
        scale, 1 at rest.
    """
    parts[:] = 0.0
    n = len(centres)
    x = y = dx = dy = 0.0
    for j in range(n):
        x, y = x + centres[j, 0], y + centres[j, 1]
        dx, dy = dx + motions[j, DRAG_X], dy + motions[j, DRAG_Y]
    x, y, dx, dy = x / n, y / n, dx / n, dy / n
    if n == 1:
        rotation, scale = math.asin(min(max(motions[0, TURN], -1.0), 1.0)), 1.0
        turn = abs(rotation) * LEVER * radii[0] / TURN_GAIN
        parts[_PUSH] = math.hypot(dx, dy)
    else:
        inertia = along = across = 0.0
        for j in range(n):
            ax, ay = centres[j, 0] - x, centres[j, 1] - y
            inertia += ax * ax + ay * ay
            along += ax * motions[j, DRAG_X] + ay * motions[j, DRAG_Y]
            across += ax * motions[j, DRAG_Y] - ay * motions[j, DRAG_X]
        along, across = 1.0 + along / inertia, across / inertia
        rotation, scale = math.atan2(across, along), math.hypot(along, across)
        reach = math.sqrt(inertia / n)
        turn, spread = abs(rotation) * reach, abs(scale - 1.0) * reach
        parts[_ZOOM if scale > 1.0 else _PINCH] = spread
        parts[_PUSH] = max(math.hypot(dx, dy) / COMMON_GAIN - SEVERAL_MM, 0.0)
    parts[_CW if rotation > 0 else _CCW] = turn
    return dx, dy, rotation, scale


@kernel
def subtract_landing(
    motions: Floats, step_us: int, landed: Floats, landed_us: NDArray[np.int64], since: Floats
) -> None:
    """Writes the motions of the fingers since they landed.

    A hand lands with a tremble, so the first motion of a finger is not yet part of the gesture.

    Args:
        motions: (k, 3) float64: drag x, drag y in mm, sine of the turn.
        step_us: time since the previous slice.
        landed: (k, 3) float64, the sum of each finger's first motions times their µs; updated.
        landed_us: (k,) int64, the length of these motions, 0 for a new finger; updated.
        since: (k, 3) float64, written.
    """
    for j in range(len(motions)):
        if landed_us[j] < LANDING_US:
            for p in range(3):
                before = landed[j, p] if landed_us[j] > 0 else 0.0
                landed[j, p] = before + step_us * motions[j, p]
            landed_us[j] += step_us
        us = max(landed_us[j], 1)
        drag_mm = math.hypot(landed[j, 0] / us, landed[j, 1] / us)
        share = LANDING_SHARE * LANDING_MM / max(drag_mm, LANDING_MM)
        for p in range(3):
            since[j, p] = motions[j, p] - share * (landed[j, p] / us)


@kernel
def locate(
    centre: Floats, radius: float, motion: Floats, press: float
) -> tuple[float, float, float]:
    """Returns where a finger deforms the gel, and how far it moves the gel under it.

    The place is the mean of its patch, weighted by the square of the motion. A finger that drags
    moves all of its patch alike. One that turns with the hand moves the outer side more, and there
    people see the deformation [NT, "Contact Point Detection"].

    The motion is the root mean square over its patch, as people see dots and not the finger's
    middle. That of the place would be up to a quarter more in a twist, and that of the middle a
    twelfth less: then a tip that only turns would not move at all.

    Args:
        centre: (2,) float64 mm, on the gel at rest.
        radius: mm.
        motion: (3,) float64, drag x, drag y in mm, sine of the turn.
        press: mm; a pressed patch looks larger, so its markers seem to move outwards as well.

    Returns:
        The present place (x, y) in mm, and the motion in mm.
    """
    cx, cy, turn = centre[0], centre[1], motion[TURN]
    dx, dy = motion[DRAG_X] + press / VIEW_MM * cx, motion[DRAG_Y] + press / VIEW_MM * cy
    square = dx * dx + dy * dy + 0.5 * (turn * radius) ** 2
    shift = 0.5 * turn * radius * radius / max(square, 1e-6)
    sx, sy = shift * dy, -shift * dx
    keep = math.sqrt(1.0 - turn * turn)
    return cx + dx + keep * sx - turn * sy, cy + dy + keep * sy + turn * sx, math.sqrt(square)


@kernel
def choose_shown(
    peak_mm: Floats,
    still_mm: float,
    shown: NDArray[np.int64],
    least: int,
    chosen: NDArray[np.bool_],
) -> int:
    """Chooses the fingers that are contacts: those that move enough, or else those that move most.

    Args:
        peak_mm: (k,) float64, k >= 1, how far dots under them go at most, see ``measure_peak``.
        still_mm: a finger with a smaller motion takes no part in the gesture.
        shown: (k,) int64, 1 for those that moved enough before, else 0; updated.
        least: the least number of contacts, if there are as many fingers.
        chosen: (k,) bool, written.

    Returns:
        The number of contacts.
    """
    n, count = len(peak_mm), 0
    on_mm = max(SHOWN_MM, still_mm)
    for j in range(n):
        shown[j] = peak_mm[j] >= (HIDDEN_SHARE * on_mm if shown[j] else on_mm)
        chosen[j] = shown[j] > 0
        count += shown[j]
    while count < min(least, n):
        most = -1
        for j in range(n):
            if not chosen[j] and (most < 0 or peak_mm[j] > peak_mm[most]):
                most = j
        chosen[most] = True
        count += 1
    return count

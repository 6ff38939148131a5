"""Recognises the gesture of one slice: the fingers first, then the kind of their motion."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.gesture.elastic.kernels.follow import follow
from neurotouch_hid.gesture.elastic.kernels.kind import decide, is_falling, is_forming
from neurotouch_hid.process.kernel_cache import kernel


@kernel
def recognize(
    arrays: Any,
    decision: NDArray[np.void],
    rules: NDArray[np.void],
    moved_px: NDArray[np.float64],
    use: NDArray[np.bool_],
    step_us: int,
    noise_mm: float,
    rest_age_us: int,
) -> tuple[int, float, int, float, float, float, float, float, float]:
    """Takes one slice.

    Args:
        arrays: see ``FingerArrays``; updated.
        decision: (1,) ``DECISION``, updated.
        rules: (1,) ``KindRules``.
        moved_px: (n, 2) float64 px, displacement of each marker.
        use: (n,) bool, True for measured markers.
        step_us: time since the previous slice.
        noise_mm: error of a marker on one axis.
        rest_age_us: how long ago the gel was seen at rest.

    Returns:
        The kind and its confidence; of ``MOTION`` the number of fingers, ``largest_mm``,
        ``peak_mm``, ``x_mm``, ``y_mm``, ``rotation_rad`` and ``scale``.
    """
    d, c, fingers = decision[0], rules[0], arrays.state[0]
    fingers.slice.noise_mm, fingers.slice.step_us = noise_mm, step_us
    fingers.slice.forming, fingers.slice.falling = is_forming(d), is_falling(d, c)
    follow(arrays, moved_px, use)
    m = fingers.motion
    decide(d, c, m, step_us, noise_mm, rest_age_us)
    found = m.n_fingers, m.largest_mm, m.peak_mm
    return d.kind, d.confidence, *found, m.x_mm, m.y_mm, m.rotation_rad, m.scale

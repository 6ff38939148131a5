"""Notices a gel that has not come back all the way from a large motion."""

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.process.kernel_cache import load
from neurotouch_hid.tracker.kernels import matching

PACE_US = 35_000
"""Motion is measured from frame to frame of 25 a second; of a faster camera, over as long a time.
In 8 ms a finger hardly trembles."""
MOST_KEPT_MM = 1.0  # of the motion of any marker; silicone keeps up to a twentieth of 15 mm
FROZEN_PX = 0.3  # a finger trembles by more between two frames; a gel without fingers does not
FROZEN_FRAMES = 5  # that far apart
FAR_SHARE = 0.9  # a large motion moves more than a tenth of the markers beyond recognition
GATE_PX = 2.0
FEW = 3  # markers that may err


class KeptMotion:
    """Watches the frames that do not show the gel as it was."""

    def __init__(self) -> None:
        self._before_px: NDArray[np.float64] = np.empty((0, 2))
        self._before_us = 0
        self._was_large = False
        self._n_frozen = 0
        no_px, match = self._before_px, np.empty(0, np.int32)
        load(matching.measure_largest, no_px, no_px, GATE_PX, FEW, match)

    def forget(self) -> None:
        """Starts again: the gel is at rest as it was."""
        self._was_large, self._n_frozen = False, 0

    def update(self, t_us: int, now_px: NDArray[np.float64], found: float, most_mm: float) -> bool:
        """Returns True if a large motion is over and what is left of it no longer changes.

        Args:
            t_us: the time of a frame.
            now_px: (m, 2) float64 px, its dots.
            found: share of the markers that are seen near their places.
            most_mm: how far these are off, without the few that may err.
        """
        before_px, is_next = self._before_px, not 0 <= t_us - self._before_us < PACE_US
        if is_next:
            self._before_px, self._before_us = now_px.copy(), t_us
        if found < FAR_SHARE:
            self._was_large, self._n_frozen = True, 0
            return False
        if not self._was_large:
            return False
        if most_mm > MOST_KEPT_MM:
            self._n_frozen = 0
            return False
        same = np.empty(len(before_px), np.int32)
        n, moved_px = matching.measure_largest(before_px, now_px, GATE_PX, FEW, same)
        is_frozen = n >= FAR_SHARE * len(now_px) and moved_px <= FROZEN_PX
        self._n_frozen = self._n_frozen + is_next if is_frozen else 0
        return self._n_frozen >= FROZEN_FRAMES

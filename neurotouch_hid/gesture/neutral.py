"""The pose that counts as no gesture: the gel untouched, or a hand that rests on it."""

import math

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

CAPTURE_US = 300_000  # a pose asked for is the mean over this time: tremor passes three times
SETTLE_US_PER_MM = 1_000_000  # the more a hand drags, the less it looks like one that rests
LIFT_US = 300_000  # a gel untouched for so long is no finger on its way through the rest
DRIFT_US = 30_000_000  # time constant of the drift correction of a resting hand
STILL_MM_S = 2.0  # a hand that moves faster does something
SMOOTH_US = 250_000  # twice, before its speed is measured: a tremor of 4 mm at 5 Hz leaves 2 mm/s
TOUCHED_MM = 0.3  # markers of an untouched gel have moved less: noise and what tracking drifts
FEW = 0.02  # share of the markers that may be wrong: a finger moves more


class Neutral:
    """Subtracts the neutral pose from the markers.

    Of a hand that rests, that is how it lies once it has been still for a while: 1 s, or 1 s for
    each mm by which it drags the gel. It is followed slowly while there is no gesture, and
    forgotten when the hand is lifted. A hand so light that the gel looks untouched needs no pose.

    Args:
        is_resting: the neutral pose is the hand's; otherwise it is the gel at rest.
    """

    def __init__(self, *, is_resting: bool) -> None:
        self._is_resting = is_resting
        self._captured: list[Floats] = []
        self._capture_us = 0
        self._slow: tuple[Floats, Floats] | None = None
        self._still_us = self._lifted_us = 0
        self.pose_px: Floats | None = None

    def capture(self) -> None:
        """Take what the hand does now and for 0.3 s for nothing."""
        self._captured, self._capture_us = [], CAPTURE_US

    def anchor(self) -> None:
        """The gel was seen untouched: a captured pose of a lifted hand is out of date."""
        if not self._is_resting:
            self._capture_us, self.pose_px = 0, None

    def subtract(
        self, moved_px: Floats, use: Flags, px_per_mm: float, step_us: int
    ) -> Floats | None:
        """Displacement from the neutral pose, (177, 2) px; None while that is being found.

        Args:
            moved_px: (177, 2) px, displacement since rest.
            use: (177,), measured markers.
            px_per_mm: of the rig.
            step_us: time since the slice before.
        """
        if self._is_resting:
            self._watch(moved_px, use, px_per_mm, step_us)
        if self._capture_us > 0:
            self._captured.append(moved_px)
            self._capture_us -= step_us
            if self._capture_us > 0:
                return None
            self.pose_px = np.mean(self._captured, axis=0)
        if self.pose_px is None:
            return moved_px
        return None if self._lifted_us > 0 else moved_px - self.pose_px

    def follow(self, moved_px: Floats, step_us: int) -> None:
        """Let the pose drift with a resting hand that holds still and makes no gesture.

        Args:
            moved_px: (177, 2) px, displacement from the pose.
            step_us: time since the slice before.
        """
        if self.pose_px is not None and self._still_us > 0:
            self.pose_px += (1.0 - math.exp(-step_us / DRIFT_US)) * moved_px

    def displace(self, points_px: Floats, rest_px: Floats) -> Floats:
        """Where points (k, 2) px of the neutral gel lie in the image: by their nearest markers."""
        if self.pose_px is None or not len(points_px):
            return points_px
        away = ((points_px[:, None] - rest_px) ** 2).sum(axis=2)
        near = np.argsort(away, axis=1)[:, :4]
        moved: Floats = points_px + self.pose_px[near].mean(axis=1)
        return moved

    def _watch(self, moved_px: Floats, use: Flags, px_per_mm: float, step_us: int) -> None:
        """Finds out whether the hand is there, is still, and has been for long enough."""
        if self._slow is None:
            self._slow = moved_px.copy(), moved_px.copy()
        once, twice = self._slow
        share = 1.0 - math.exp(-step_us / SMOOTH_US)
        once[use] += share * (moved_px - once)[use]
        change = once - twice
        twice += share * change
        few = FEW * len(use)
        if _count(moved_px, TOUCHED_MM * px_per_mm) <= few:
            self._still_us, self._lifted_us = 0, self._lifted_us + step_us
            if self._lifted_us >= LIFT_US:
                self.pose_px = None
            return
        self._lifted_us = 0
        is_still = _count(change, STILL_MM_S * px_per_mm * SMOOTH_US * 1e-6) <= few
        self._still_us = self._still_us + step_us if is_still else 0
        if self.pose_px is None and self._still_us >= SETTLE_US_PER_MM:
            drag_px = np.quantile(np.hypot(*twice.T), 1.0 - FEW)
            if self._still_us >= SETTLE_US_PER_MM * drag_px / px_per_mm:
                self.pose_px = twice.copy()


def _count(moved_px: Floats, limit_px: float) -> int:
    """How many have moved further."""
    return int(np.count_nonzero((moved_px**2).sum(axis=1) > limit_px**2))

"""Finds the neutral pose, which counts as no gesture: the gel untouched, or a hand at rest."""

import math

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

CAPTURE_US = 300_000  # a captured pose is the mean over this time, which contains tremor thrice
SETTLE_US_PER_MM = 1_000_000  # the more a hand drags the gel, the later it counts as resting
LIFT_US = 300_000  # if the gel is untouched for this time, the hand was lifted
DRIFT_US = 30_000_000  # time constant of the drift correction of a resting hand
STILL_MM_S = 2.0  # a hand that moves faster makes a gesture
SMOOTH_US = 250_000  # applied twice before the speed: a tremor of 4 mm at 5 Hz leaves 2 mm/s
TOUCHED_MM = 0.3  # markers of an untouched gel move less, by noise and drift of the tracker
FEW = 0.02  # share of the markers that may be wrong; a finger moves more of them


class Neutral:
    """Subtracts the neutral pose from the markers.

    Once a resting hand has been still, its pose becomes the neutral pose. That takes 1 s, or 1 s
    for each mm by which the hand drags the gel. The pose then drifts slowly with the hand while
    there is no gesture, and is forgotten when the hand is lifted. A hand so light that the gel
    looks untouched needs no pose.

    Args:
        is_resting: True if the neutral pose is that of a resting hand; False for the gel at rest.
    """

    def __init__(self, *, is_resting: bool) -> None:
        self._is_resting = is_resting
        self._captured: list[Floats] = []
        self._capture_us = 0
        self._slow: tuple[Floats, Floats] | None = None
        self._still_us = self._lifted_us = 0
        self.pose_px: Floats | None = None

    def capture(self) -> None:
        """Uses the mean of the next 0.3 s as the neutral pose."""
        self._captured, self._capture_us = [], CAPTURE_US

    def anchor(self) -> None:
        """Forgets a captured pose, as the gel was seen untouched; a resting hand keeps its pose."""
        if not self._is_resting:
            self._capture_us, self.pose_px = 0, None

    def subtract(
        self, moved_px: Floats, use: Flags, px_per_mm: float, step_us: int
    ) -> Floats | None:
        """Returns the displacement from the neutral pose.

        Args:
            moved_px: (n, 2) float64 px, displacement since rest.
            use: (n,) bool, measured markers.
            px_per_mm: of the rig.
            step_us: time since the previous slice.

        Returns:
            (n, 2) float64 px, or None while the pose is being captured or the hand is lifted.
        """
        if self._is_resting:
            self._watch(moved_px, use, px_per_mm, step_us)
        if self._capture_us > 0:
            self._captured.append(moved_px.copy())
            self._capture_us -= step_us
            if self._capture_us > 0:
                return None
            self.pose_px = np.mean(self._captured, axis=0)
        if self.pose_px is None:
            return moved_px
        return None if self._lifted_us > 0 else moved_px - self.pose_px

    def follow(self, moved_px: Floats, step_us: int) -> None:
        """Lets the pose drift with a resting hand that is still and makes no gesture.

        Args:
            moved_px: (n, 2) float64 px, displacement from the pose.
            step_us: time since the previous slice.
        """
        if self.pose_px is not None and self._still_us > 0:
            self.pose_px += (1.0 - math.exp(-step_us / DRIFT_US)) * moved_px

    def displace(self, points_px: Floats, rest_px: Floats) -> Floats:
        """Returns where points of the neutral gel are in the image, by their nearest markers.

        Args:
            points_px: (k, 2) float64 px.
            rest_px: (n, 2) float64 px, the markers at rest.

        Returns:
            (k, 2) float64 px.
        """
        if self.pose_px is None or not len(points_px):
            return points_px
        away = ((points_px[:, None] - rest_px) ** 2).sum(axis=2)
        near = np.argsort(away, axis=1)[:, :4]
        moved: Floats = points_px + self.pose_px[near].mean(axis=1)
        return moved

    def _watch(self, moved_px: Floats, use: Flags, px_per_mm: float, step_us: int) -> None:
        """Takes the pose of a hand that has been still for long enough; forgets it when lifted."""
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
    """Returns the number of markers that have moved farther."""
    return int(np.count_nonzero((moved_px**2).sum(axis=1) > limit_px**2))

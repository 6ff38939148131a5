"""The pose that counts as no gesture: the gel untouched, or a hand that rests on it."""

import math

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

CAPTURE_US = 300_000  # a pose is the mean over this time: tremor passes three times
DRIFT_US = 30_000_000  # time constant of the drift correction of a resting hand
STILL_MM_S = 2.0  # a hand that moves faster does something
SMOOTH_US = 500_000  # over which its speed is measured; noise of 0.1 mm gives 0.2 mm/s
STILL_SHARE = 98  # percentile of the markers that must be that slow: a finger holds more


class Neutral:
    """Subtracts the neutral pose from the markers.

    Args:
        is_resting: the neutral pose is the hand's; otherwise it is the gel at rest.
    """

    def __init__(self, *, is_resting: bool) -> None:
        self._is_resting = is_resting
        self._sum: Floats | None = None
        self._us = 0.0
        self._slow: Floats | None = None
        self.pose_px: Floats | None = None
        if is_resting:
            self.capture()

    @property
    def is_capturing(self) -> bool:
        """A pose is being measured; until it is known there is no gesture."""
        return self._sum is not None

    def capture(self) -> None:
        """Take what the hand does now for nothing."""
        self._sum, self._us, self._slow = np.zeros(0), 0.0, None

    def anchor(self) -> None:
        """The gel was seen untouched: a captured pose of a lifted hand is out of date."""
        if not self._is_resting:
            self._sum = self.pose_px = None

    def subtract(self, moved_px: Floats, step_us: int) -> Floats:
        """Displacement from the neutral pose.

        Args:
            moved_px: (177, 2) px, displacement since rest.
            step_us: time since the slice before.
        """
        if self._sum is not None:
            self._sum = moved_px * step_us + (self._sum if len(self._sum) else 0.0)
            self._us += step_us
            if self._us >= CAPTURE_US:
                self.pose_px, self._sum = self._sum / self._us, None
        return moved_px if self.pose_px is None else moved_px - self.pose_px

    def follow(self, moved_px: Floats, px_per_mm: float, step_us: int, *, is_quiet: bool) -> None:
        """Let the pose drift with a hand that holds still.

        Args:
            moved_px: (177, 2) px, displacement from the pose.
            px_per_mm: of the rig.
            step_us: time since the slice before.
            is_quiet: there is no gesture.
        """
        if not self._is_resting or self.pose_px is None:
            return
        if self._slow is None:
            self._slow = moved_px.copy()
        change = moved_px - self._slow
        self._slow += (1.0 - math.exp(-step_us / SMOOTH_US)) * change
        speed = float(np.percentile(np.hypot(*change.T), STILL_SHARE)) / px_per_mm / SMOOTH_US * 1e6
        if is_quiet and speed < STILL_MM_S:
            self.pose_px += (1.0 - math.exp(-step_us / DRIFT_US)) * moved_px

    def displace(self, points_px: Floats, rest_px: Floats) -> Floats:
        """Where points (k, 2) px of the neutral gel lie in the image: by their nearest markers."""
        if self.pose_px is None or not len(points_px):
            return points_px
        away = ((points_px[:, None] - rest_px) ** 2).sum(axis=2)
        near = np.argsort(away, axis=1)[:, :4]
        moved: Floats = points_px + self.pose_px[near].mean(axis=1)
        return moved

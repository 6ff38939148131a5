"""Rest for a hand that stays on the gel: movements count from how it lies."""

import math
from typing import Final

from neurotouch_hid.messages import GestureKind

SETTLE_US: Final = 1_000_000
LIFT_US: Final = 2_000_000
STILL_MM_S: Final = 2.0
DRIFT_BELOW_MM: Final = 1.5
DRIFT_US: Final = 30_000_000


class RestingHand:
    """Subtracts how the hand lies.

    That is found once the hand has been still for 1 s, and forgotten 2 s after it was lifted. It
    follows a slow drift (30 s) while the hand is still and near its rest.
    """

    def __init__(self) -> None:
        self._pose: tuple[float, float, float] | None = None
        self._last = (0.0, 0.0, 0.0)
        self._still_us = 0
        self._lifted_us = 0

    def lift(self, step_us: int) -> None:
        """The hand is not on the gel."""
        self._still_us = 0
        self._lifted_us += step_us
        if self._lifted_us >= LIFT_US:
            self._pose = None

    def rezero(self) -> None:
        """How the hand lies now is rest."""
        self._pose = self._last

    def subtract(
        self, kind: GestureKind, mm: float, x_mm: float, y_mm: float, step_us: int
    ) -> tuple[float, float, float] | None:
        """Intensity and translation from rest, in mm; None until rest is known."""
        moved_mm = math.dist((mm, x_mm, y_mm), self._last)
        still = moved_mm <= STILL_MM_S * max(step_us, 1) * 1e-6
        self._last = (mm, x_mm, y_mm)
        self._lifted_us = 0
        self._still_us = self._still_us + step_us if still else 0
        if self._pose is None:
            if self._still_us < SETTLE_US:
                return None
            self._pose = self._last
        pose_mm, pose_x, pose_y = self._pose
        x, y = x_mm - pose_x, y_mm - pose_y
        left_mm = math.hypot(x, y) if kind == GestureKind.PUSH else max(0.0, mm - pose_mm)
        if still and left_mm < DRIFT_BELOW_MM:
            share = min(1.0, step_us / DRIFT_US)
            self._pose = (
                pose_mm + share * (mm - pose_mm),
                pose_x + share * x,
                pose_y + share * y,
            )
        return left_mm, x, y

"""From displacements to a gesture by fitting the fingers that cause them."""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import Rig
from neurotouch_hid.gesture.config import GestureConfig
from neurotouch_hid.gesture.elastic.decision import KindDecider, KindDeciderConfig
from neurotouch_hid.gesture.elastic.fingers import FingerConfig, FingerTracker
from neurotouch_hid.messages import Gesture, GestureKind, no_gesture

Floats = NDArray[np.float64]

NOISE_US = 500_000  # time constant of the noise of the markers, measured at rest
RESTING = KindDeciderConfig(on_mm=0.8, off_mm=0.5, least_off_mm=0.5)
"""A resting hand trembles by up to half a mm."""
RESTING_HAND = FingerConfig(still_share=0.2)


class ElasticMethod:
    """Remembers the hand and the gesture from slice to slice."""

    def __init__(self, config: GestureConfig) -> None:
        is_resting = config.neutral == "resting"
        self._hand = FingerTracker(RESTING_HAND if is_resting else FingerConfig())
        self._decision = KindDecider(RESTING if is_resting else KindDeciderConfig())
        self._rest_px: NDArray[np.float32] | None = None
        self._noise_mm = 0.08
        self._unheard_us = 0
        self._remembers = False

    def reset(self) -> None:
        """Forget the gesture."""
        self._hand.reset()
        self._decision.reset()
        self._remembers = False

    def update(
        self,
        t_us: int,
        step_us: int,
        rest_px: NDArray[np.float32],
        moved_px: Floats,
        use: NDArray[np.bool_],
        rig: Rig,
    ) -> Gesture:
        """The gesture at the end of a slice.

        Args:
            t_us: the moment.
            step_us: time since the slice before.
            rest_px: (177, 2) px; a new array object when it changed.
            moved_px: (177, 2) px, displacements from the neutral pose.
            use: (177,), measured markers.
            rig: of ``rest_px``.
        """
        hand, decision = self._hand, self._decision
        if rest_px is not self._rest_px:
            self._rest_px = rest_px
            hand.place(rest_px, rig)
        motion = hand.update(
            moved_px,
            use,
            self._noise_mm,
            step_us=step_us,
            forming=decision.is_forming,
            falling=decision.is_falling,
        )
        decision.update(
            step_us,
            motion.largest_mm,
            motion.parts_mm,
            motion.n_fingers,
            self._noise_mm,
            sway_mm=motion.sway_mm,
            error_mm=motion.error_mm,
        )
        if not motion.n_fingers:
            self._listen(step_us)
            if decision.kind is GestureKind.NONE and self._remembers:
                self.reset()
            return no_gesture(t_us)
        self._remembers = True
        if decision.kind is GestureKind.NONE:
            if motion.largest_mm < hand.config.least_mm:
                self.reset()
            return replace(no_gesture(t_us), confidence=decision.confidence)
        # It takes two to pinch, zoom or twist, though one of them may hold still.
        contacts = hand.show(1 if decision.kind is GestureKind.PUSH else 2)
        return Gesture(
            t_us=t_us,
            kind=decision.kind,
            contacts_mm=contacts.mm,
            contacts_px=contacts.px,
            intensity_mm=contacts.intensity_mm,
            translation_mm=(motion.x_mm, motion.y_mm),
            rotation_rad=motion.rotation_rad,
            scale=motion.scale,
            confidence=decision.confidence,
        )

    def _listen(self, step_us: int) -> None:
        """Measures the noise of the markers while nothing moves, a few times in ``NOISE_US``."""
        self._unheard_us += step_us
        if self._unheard_us < NOISE_US // 10:
            return
        share = 1.0 - math.exp(-self._unheard_us / NOISE_US)
        self._noise_mm += share * (self._hand.measure_noise() - self._noise_mm)
        self._unheard_us = 0

"""Recognises a gesture by fitting the fingers that cause the displacements."""

import math

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import Gel, Rig
from neurotouch_hid.gesture.config import GestureConfig
from neurotouch_hid.gesture.elastic.fingers import FingerConfig, FingerTracker
from neurotouch_hid.gesture.elastic.kernels.kind import DECISION, forget
from neurotouch_hid.gesture.elastic.kernels.recognize import recognize
from neurotouch_hid.gesture.elastic.kind_rules import KindRules
from neurotouch_hid.messages import Gesture, GestureKind, no_gesture
from neurotouch_hid.process.kernel_cache import bind

Floats = NDArray[np.float64]

NOISE_US = 500_000  # time constant of the noise of the markers, which is measured at rest
RESTING_KIND = KindRules(on_mm=0.8, off_mm=0.5, least_off_mm=0.5)
"""Higher thresholds, because a resting hand trembles by up to half a mm."""
PAIR_MM = 0.8
"""In a smaller pinch, zoom or twist only fingers whose dots have moved are contacts: a hand lands
and leaves finger by finger."""
RESTING_FINGERS = FingerConfig(still_share=0.2)
_KINDS = tuple(GestureKind)
_NEVER_US = -(1 << 60)  # long before any slice


class ElasticMethod:
    """Remembers the fingers and the gesture from slice to slice."""

    def __init__(self, config: GestureConfig, gel: Gel) -> None:
        is_resting = config.neutral == "resting"
        self._fingers = FingerTracker(RESTING_FINGERS if is_resting else FingerConfig(), gel)
        rules = RESTING_KIND if is_resting else KindRules()
        self._decision = np.zeros(1, DECISION)
        self._recognize = bind(recognize, self._fingers.arrays, self._decision, rules.as_record())
        self._rest_px: NDArray[np.float32] | None = None
        self._noise_mm = 0.08
        self._unmeasured_us = 0
        self._remembers = False
        self._seen_rest_us = _NEVER_US
        self.reset()

    def note_rest(self, t_us: int) -> None:
        """Takes that a frame shows the gel at rest: a gesture whose fingers leave is over."""
        self._seen_rest_us = t_us

    def reset(self) -> None:
        """Forgets the gesture."""
        self._fingers.reset()
        forget(self._decision)
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
        """Returns the gesture at the end of a slice; see ``GestureMethod.update``."""
        fingers = self._fingers
        if rest_px is not self._rest_px:
            self._rest_px = rest_px
            fingers.place(rest_px, rig)
        # The noise at rest can be much less than the errors of dots that have moved.
        noise_mm = max(self._noise_mm, fingers.config.least_noise_mm)
        rest_age_us = t_us - self._seen_rest_us
        self._seen_rest_us = _NEVER_US
        kind, confidence, n_fingers, largest_mm, peak_mm, x_mm, y_mm, rotation_rad, scale = (
            self._recognize(moved_px, use, step_us, noise_mm, rest_age_us)
        )
        if not n_fingers:
            self._measure_noise(step_us)
            if not kind and self._remembers:
                self.reset()
            return no_gesture(t_us)
        self._remembers = True
        if not kind:
            if largest_mm < fingers.config.least_mm:
                self.reset()
                return no_gesture(t_us)
            return no_gesture(t_us, confidence)
        # A pinch, zoom or twist needs two fingers, though one of them may keep still.
        takes_one = kind == GestureKind.PUSH or peak_mm < PAIR_MM
        mm, px, intensity_mm = fingers.locate_shown(1 if takes_one else 2)
        return Gesture(
            t_us,
            _KINDS[kind],
            mm,
            px,
            intensity_mm,
            (x_mm, y_mm),
            rotation_rad,
            scale,
            confidence,
        )

    def _measure_noise(self, step_us: int) -> None:
        """Measures the noise of the markers while nothing moves, a few times in ``NOISE_US``."""
        self._unmeasured_us += step_us
        if self._unmeasured_us < NOISE_US // 10:
            return
        share = 1.0 - math.exp(-self._unmeasured_us / NOISE_US)
        self._noise_mm += share * (self._fingers.measure_noise() - self._noise_mm)
        self._unmeasured_us = 0

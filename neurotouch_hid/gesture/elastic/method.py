"""From displacements to a gesture by fitting the fingers that cause them."""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import Rig
from neurotouch_hid.gesture.config import GestureConfig
from neurotouch_hid.gesture.elastic.decision import Decision, DecisionConfig
from neurotouch_hid.gesture.elastic.hand import Hand
from neurotouch_hid.gesture.elastic.motion import measure_motion
from neurotouch_hid.messages import Gesture, GestureKind, no_gesture

Floats = NDArray[np.float64]

SHOWN_MM = 0.3  # people label a contact from about this motion on
NOISE_US = 500_000  # time constant of the noise of the markers, measured at rest
RESTING = DecisionConfig(on_mm=0.8, off_mm=0.5)  # a resting hand trembles by up to half a mm


class ElasticMethod:
    """Remembers the hand and the gesture from slice to slice."""

    def __init__(self, config: GestureConfig) -> None:
        self._hand = Hand()
        self._decision = Decision(RESTING if config.neutral == "resting" else DecisionConfig())
        self._rest_px: NDArray[np.float32] | None = None
        self._noise_mm = 0.08
        self._unheard_us = 0
        self._shown: set[int] = set()

    def reset(self) -> None:
        """Forget the gesture."""
        self._hand.reset()
        self._decision.reset()
        self._shown.clear()

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
        if rest_px is not self._rest_px:
            self._rest_px = rest_px
            self._hand.place(rig.to_mm(rest_px))
        moved = rig.vector_to_mm(moved_px)
        hand, decision = self._hand, self._decision
        hand.update(moved, use.astype(np.float64), self._noise_mm, forming=decision.is_forming)
        fit = hand.fit
        if fit is None:
            self._listen(moved[use], step_us)
            decision.update(step_us, 0.0, np.zeros(len(GestureKind)), 0, self._noise_mm)
            if decision.kind is GestureKind.NONE:
                self.reset()
            return no_gesture(t_us)
        motion = measure_motion(fit.centres, fit.radii, fit.motions)
        places, drags = fit.locate()
        lengths = fit.measure()
        decision.update(step_us, fit.largest_mm, motion.parts_mm, len(lengths), self._noise_mm)
        if decision.kind is GestureKind.NONE:
            if fit.largest_mm < hand.config.least_mm:
                self.reset()
            return replace(no_gesture(t_us), confidence=decision.confidence)
        self._shown |= {k for k, mm in zip(hand.ids, lengths, strict=True) if mm >= SHOWN_MM}
        shown = np.array([k in self._shown for k in hand.ids])
        if not shown.any():
            shown[int(lengths.argmax())] = True
        contacts = (places + drags)[shown]
        return Gesture(
            t_us=t_us,
            kind=decision.kind,
            contacts_mm=contacts,
            contacts_px=rig.to_px(contacts),
            intensity_mm=float(lengths[shown].mean()),
            translation_mm=motion.translation_mm,
            rotation_rad=motion.rotation_rad,
            scale=motion.scale,
            confidence=decision.confidence,
            phase=decision.phase,
            speed_mm_s=decision.speed_mm_s,
            finger_ids=tuple(k for k, seen in zip(hand.ids, shown, strict=True) if seen),
            motion_mm=drags[shown],
        )

    def _listen(self, moved: Floats, step_us: int) -> None:
        """Measures the noise of the markers while nothing moves, a few times in ``NOISE_US``."""
        self._unheard_us += step_us
        if self._unheard_us < NOISE_US // 10:
            return
        spread = 1.4826 * float(np.median(np.abs(moved - np.median(moved, axis=0))))
        share = 1.0 - math.exp(-self._unheard_us / NOISE_US)
        self._noise_mm += share * (spread - self._noise_mm)
        self._unheard_us = 0

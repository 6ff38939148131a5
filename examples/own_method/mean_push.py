"""A short method: every gesture is a push by the strongest tenth of the markers.

Install it with ``pip install -e .``; then ``neurotouch run --method mean_push --source sim:push
--device memory`` (``memory`` needs no right to make a gamepad).
"""

import numpy as np

from neurotouch_hid.messages import Gesture, GestureKind, no_gesture

LEAST_MM = 0.5
"""Smaller motion is noise."""


class MeanPush:
    """Recognises pushes only."""

    def __init__(self, config):
        self._least_mm = LEAST_MM

    def reset(self):
        """Does nothing: this method has no memory."""

    def update(self, t_us, step_us, rest_px, moved_px, use, rig):
        """Returns a push if the fastest tenth of the markers has moved far enough."""
        moved_mm = rig.vector_to_mm(moved_px[use])
        far_mm = np.hypot(*moved_mm.T)
        strongest = far_mm >= np.quantile(far_mm, 0.9)
        intensity_mm = float(far_mm[strongest].mean())
        if intensity_mm < self._least_mm:
            return no_gesture(t_us)
        contact_px = (rest_px[use] + moved_px[use])[strongest].mean(axis=0, keepdims=True)
        x_mm, y_mm = moved_mm[strongest].mean(axis=0)
        return Gesture(
            t_us,
            GestureKind.PUSH,
            contacts_mm=rig.to_mm(contact_px),
            contacts_px=contact_px,
            intensity_mm=intensity_mm,
            translation_mm=(float(x_mm), float(y_mm)),
        )

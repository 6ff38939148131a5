"""From marker displacements to a gesture, one slice at a time."""

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import Rig, fit_rig
from neurotouch_hid.gesture.config import GestureConfig
from neurotouch_hid.gesture.elastic import ElasticMethod
from neurotouch_hid.gesture.paper import PaperMethod
from neurotouch_hid.messages import Gesture, MarkerField, no_gesture

FIRST_STEP_US = 10_000  # the length of a slice [NT, "Results"], until two have been seen


class GestureRecognizer:
    """What the hand does, told from MarkerFields in order of time."""

    def __init__(self, config: GestureConfig | None = None) -> None:
        self._config = config or GestureConfig()
        self._method = (
            PaperMethod(self._config) if self._config.method == "paper" else ElasticMethod()
        )
        self._rest_px: NDArray[np.float32] | None = None
        self._rig: Rig | None = None
        self._t_us: int | None = None

    def update(self, markers: MarkerField) -> Gesture:
        """The gesture at the end of a slice; NONE at rest and before the gel is found."""
        if markers.rest_px is not self._rest_px:
            self._rest_px = markers.rest_px
            known = np.isfinite(markers.rest_px).all(axis=1).sum() >= 2
            self._rig = fit_rig(markers.rest_px) if known else None
        step_us = FIRST_STEP_US if self._t_us is None else markers.t_us - self._t_us
        self._t_us = markers.t_us
        use = markers.valid & np.isfinite(markers.position_px).all(axis=1)
        if self._rig is None or int(use.sum()) < self._config.min_tracked:
            self._method.reset()
            return no_gesture(markers.t_us)
        return self._method.update(
            markers.t_us, step_us, markers.rest_px, markers.position_px, use, self._rig
        )

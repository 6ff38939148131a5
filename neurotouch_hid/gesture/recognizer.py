"""Turns marker positions into a gesture, one slice at a time."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import PAPER_GEL, Gel, Rig, fit_rig
from neurotouch_hid.gesture.config import GestureConfig, NeutralPose
from neurotouch_hid.gesture.kernels.displacement import displace
from neurotouch_hid.gesture.method import make_method
from neurotouch_hid.gesture.neutral import Neutral
from neurotouch_hid.messages import Gesture, GestureKind, MarkerField, no_gesture

FIRST_STEP_US = 10_000  # assumed for the first slice: the length of a slice [NT, "Results"]


class GestureRecognizer:
    """Recognises the gesture from MarkerFields in order of time."""

    def __init__(self, config: GestureConfig | None = None, gel: Gel = PAPER_GEL) -> None:
        self._config, self._gel = config or GestureConfig(), gel
        self._rest_px: NDArray[np.float32] | None = None
        self._rig: Rig | None = None
        self._t_us: int | None = None
        # Of one slice only: new arrays of this size take longer than the kernel that fills them.
        self._moved_px = np.empty((gel.n_markers, 2))
        self._use = np.empty(gel.n_markers, np.bool_)
        self.choose_neutral(self._config.neutral)

    @property
    def neutral(self) -> NeutralPose:
        """The pose from which gestures count."""
        return self._config.neutral

    def choose_neutral(self, pose: NeutralPose) -> None:
        """Switches to another neutral pose; a gesture in progress ends."""
        self._config = replace(self._config, neutral=pose)
        self._method = make_method(self._config, self._gel)
        self._neutral = Neutral(is_resting=pose == "resting")

    def rezero(self) -> None:
        """Uses the mean of the next 0.3 s as the neutral pose, until the gel is seen untouched."""
        self._method.reset()
        self._neutral.capture()

    def note_rest(self, t_us: int) -> None:
        """Takes that a frame, exposed about ``t_us``, shows the gel at rest, for ``update``."""
        self._method.note_rest(t_us)

    def update(self, markers: MarkerField) -> Gesture:
        """Returns the gesture at the end of a slice; NONE at rest and before the gel is found."""
        t_us, rest_px = markers.t_us, markers.rest_px
        if rest_px is not self._rest_px:
            self._rest_px = rest_px
            known = np.isfinite(rest_px).all(axis=1).sum() >= 2
            self._rig = fit_rig(rest_px, self._gel) if known else None
            self._neutral.anchor()
        step_us = FIRST_STEP_US if self._t_us is None else t_us - self._t_us
        self._t_us = t_us
        moved_px, use = self._moved_px, self._use
        n_used = displace(rest_px, markers.position_px, markers.valid, moved_px, use)
        if self._rig is None or n_used < self._config.min_tracked * len(rest_px):
            self._method.reset()
            return no_gesture(t_us)
        from_pose_px = self._neutral.subtract(moved_px, use, self._rig.px_per_mm, step_us)
        if from_pose_px is None:
            self._method.reset()
            return no_gesture(t_us)
        gesture = self._method.update(t_us, step_us, rest_px, from_pose_px, use, self._rig)
        if gesture.kind is GestureKind.NONE:
            self._neutral.follow(from_pose_px, step_us)
            return gesture
        if self._neutral.pose_px is None:
            return gesture
        contacts_px = self._neutral.displace(gesture.contacts_px, rest_px.astype(np.float64))
        contacts_mm = self._rig.to_mm(contacts_px)
        return replace(gesture, contacts_px=contacts_px, contacts_mm=contacts_mm)

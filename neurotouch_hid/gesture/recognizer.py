"""From marker displacements to a gesture, one slice at a time."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import Rig, fit_rig
from neurotouch_hid.gesture.classify import classify, fit_similarity, measure_reach
from neurotouch_hid.gesture.contacts import find_contacts
from neurotouch_hid.gesture.intensity import measure_intensity
from neurotouch_hid.gesture.kernels import find_near, smooth_displacement
from neurotouch_hid.messages import Gesture, GestureKind, MarkerField


@dataclass(frozen=True, slots=True)
class GestureConfig:
    """Hyper-parameters of the gesture stage.

    Attributes:
        method: how a gesture is found; ``paper`` is [NT, "Methodology"].
        radius_px: r, 30 px or about 12 mm, the radius of a fingertip [NT, "Results"].
        threshold_ratio: a, reprojection threshold over mean displacement [NT, "Results"].
        min_neighbours: N_min, outliers a local maximum must have around it [NT, "Results"].
        threshold_floor_px: least reprojection threshold: 3 sigma of a tracking error of 0.2 px an
            axis.
        rest_gate_px: mean displacement within r that ends rest, 0.2 mm. The ten markers that r
            holds at the gel's rim leave 0.1 px an axis of an error of 0.3 px; the largest of all
            such means stays below 0.4 px.
        min_tracked: measured markers, about half, without which nothing is recognised: a lost gel
            presses no buttons.
    """

    method: Literal["paper"] = "paper"
    radius_px: float = 30.0
    threshold_ratio: float = 0.6
    min_neighbours: int = 4
    threshold_floor_px: float = 0.6
    rest_gate_px: float = 0.5
    min_tracked: int = 90


class GestureRecognizer:
    """What the hand does, told from one MarkerField; frame-wise, without memory, as the paper."""

    def __init__(self, config: GestureConfig | None = None) -> None:
        self._config = config or GestureConfig()
        self._recognize = _METHODS[self._config.method]
        self._rest_px: NDArray[np.float32] | None = None
        self._rig: Rig | None = None

    def update(self, markers: MarkerField) -> Gesture:
        """The gesture at the end of a slice; NONE at rest and before the gel is found."""
        if markers.rest_px is not self._rest_px:
            self._rest_px = markers.rest_px
            known = np.isfinite(markers.rest_px).all(axis=1).sum() >= 2
            self._rig = fit_rig(markers.rest_px) if known else None
        if self._rig is None:
            return _no_gesture(markers.t_us)
        use = markers.valid & np.isfinite(markers.position_px).all(axis=1)
        if int(use.sum()) < self._config.min_tracked:
            return _no_gesture(markers.t_us)
        rest_px = markers.rest_px[use].astype(np.float64)
        position_px = markers.position_px[use].astype(np.float64)
        if _at_rest(rest_px, position_px, self._config):
            return _no_gesture(markers.t_us)
        return self._recognize(markers.t_us, rest_px, position_px, self._rig, self._config)


def _at_rest(
    rest_px: NDArray[np.float64], position_px: NDArray[np.float64], config: GestureConfig
) -> bool:
    """True while no region of a fingertip's size has moved as a whole.

    Differs: the paper has no such gate, but at rest its outliers are noise alone. The gel moves
    neighbours together while tracking errors are independent, so the mean over the markers within
    r shows a motion far below the error of a single marker.
    """
    moved_px = smooth_displacement(rest_px, position_px - rest_px, config.radius_px)
    return bool((np.linalg.norm(moved_px, axis=1) < config.rest_gate_px).all())


def _recognize_paper(
    t_us: int,
    rest_px: NDArray[np.float64],
    position_px: NDArray[np.float64],
    rig: Rig,
    config: GestureConfig,
) -> Gesture:
    contacts = find_contacts(
        rest_px,
        position_px,
        threshold_ratio=config.threshold_ratio,
        threshold_floor_px=config.threshold_floor_px,
        radius_px=config.radius_px,
        min_neighbours=config.min_neighbours,
    )
    if not len(contacts):
        return _no_gesture(t_us)
    around = find_near(position_px, contacts, config.radius_px)
    rest_px, position_px = rest_px[around], position_px[around]
    origin = contacts.mean(axis=0)
    motion = fit_similarity(rest_px, position_px, origin, config.radius_px)
    if motion is None:
        return _no_gesture(t_us)
    kind, confidence = classify(motion, measure_reach(rest_px, origin))
    translation = rig.vector_to_mm(np.array(motion.translation_px))
    return Gesture(
        t_us=t_us,
        kind=kind,
        contacts_mm=rig.to_mm(contacts),
        contacts_px=contacts,
        intensity_mm=measure_intensity(rig.vector_to_mm(position_px - rest_px)),
        translation_mm=(float(translation[0]), float(translation[1])),
        rotation_rad=motion.rotation_rad,
        scale=motion.scale,
        confidence=confidence,
    )


def _no_gesture(t_us: int) -> Gesture:
    return Gesture(t_us, GestureKind.NONE, np.zeros((0, 2)), np.zeros((0, 2)), 0.0)


_METHODS = {"paper": _recognize_paper}

"""From marker displacements to a gesture, one slice at a time."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import GEL_RADIUS_MM, Rig, fit_rig
from neurotouch_hid.gesture.classify import classify, fit_similarity
from neurotouch_hid.gesture.contacts import find_contacts
from neurotouch_hid.gesture.intensity import measure_intensity
from neurotouch_hid.gesture.kernels import find_near
from neurotouch_hid.messages import Gesture, GestureKind, MarkerField


@dataclass(frozen=True, slots=True)
class GestureConfig:
    """Hyper-parameters of the gesture stage.

    Attributes:
        method: how a gesture is found; ``paper`` is [NT, "Methodology"].
        radius_px: r, 30 px or about 12 mm, the radius of a fingertip [NT, "Results"].
        threshold_ratio: a, reprojection threshold over mean displacement [NT, "Results"].
        min_neighbours: N_min, outliers a local maximum must have around it [NT, "Results"].
        threshold_floor_px: least reprojection threshold: 3 sigma of tracking noise of 0.3 px.
        rest_gate_mm: displacement that ``min_neighbours`` markers must exceed to leave rest.
    """

    method: Literal["paper"] = "paper"
    radius_px: float = 30.0
    threshold_ratio: float = 0.6
    min_neighbours: int = 4
    threshold_floor_px: float = 0.9
    rest_gate_mm: float = 0.5


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
        rest_px = markers.rest_px[use].astype(np.float64)
        position_px = markers.position_px[use].astype(np.float64)
        if _at_rest(rest_px, position_px, self._rig, self._config):
            return _no_gesture(markers.t_us)
        return self._recognize(markers.t_us, rest_px, position_px, self._rig, self._config)


def _at_rest(
    rest_px: NDArray[np.float64],
    position_px: NDArray[np.float64],
    rig: Rig,
    config: GestureConfig,
) -> bool:
    """True while fewer than N_min markers have moved.

    Differs: the paper has no such gate, but its outliers at rest are noise alone.
    """
    moved_px = np.linalg.norm(position_px - rest_px, axis=1)
    moved = moved_px > config.rest_gate_mm * rig.px_per_mm
    return int(moved.sum()) < config.min_neighbours


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
    motion = fit_similarity(rest_px, position_px, contacts.mean(axis=0), config.radius_px)
    if motion is None:
        return _no_gesture(t_us)
    kind, confidence = classify(motion, GEL_RADIUS_MM * rig.px_per_mm)
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

"""Recognises a gesture as the paper does: outliers, local maxima, a similarity."""

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import Rig
from neurotouch_hid.gesture.config import GestureConfig
from neurotouch_hid.gesture.paper.classify import classify, fit_similarity, measure_reach
from neurotouch_hid.gesture.paper.contacts import find_contacts
from neurotouch_hid.gesture.paper.kernels.neighbourhoods import find_near, smooth_displacement
from neurotouch_hid.messages import Gesture, no_gesture


class PaperMethod:
    """Recognises each slice by itself, without memory [NT, "Methodology"]."""

    def __init__(self, config: GestureConfig) -> None:
        self._config = config

    def note_rest(self, t_us: int) -> None:
        """Does nothing: each slice is recognised for itself."""

    def reset(self) -> None:
        """Does nothing: there is no memory."""

    def update(
        self,
        t_us: int,
        step_us: int,  # noqa: ARG002  # no memory, no time
        rest_px: NDArray[np.float32],
        moved_px: NDArray[np.float64],
        use: NDArray[np.bool_],
        rig: Rig,
    ) -> Gesture:
        """Returns the gesture at the end of a slice; see ``GestureMethod.update``."""
        config = self._config
        rest = rest_px[use].astype(np.float64)
        position = rest + moved_px[use]
        if _at_rest(rest, position, config):
            return no_gesture(t_us)
        contacts = find_contacts(
            rest,
            position,
            threshold_ratio=config.threshold_ratio,
            threshold_floor_px=config.threshold_floor_px,
            radius_px=config.radius_px,
            min_neighbours=config.min_neighbours,
        )
        if not len(contacts):
            return no_gesture(t_us)
        around = find_near(position, contacts, config.radius_px)
        rest, position = rest[around], position[around]
        origin = contacts.mean(axis=0)
        motion = fit_similarity(rest, position, origin, config.radius_px)
        if motion is None:
            return no_gesture(t_us)
        kind, confidence = classify(motion, measure_reach(rest, origin))
        translation = rig.vector_to_mm(np.array(motion.translation_px))
        return Gesture(
            t_us=t_us,
            kind=kind,
            contacts_mm=rig.to_mm(contacts),
            contacts_px=contacts,
            intensity_mm=_measure_intensity(rig.vector_to_mm(position - rest)),
            translation_mm=(float(translation[0]), float(translation[1])),
            rotation_rad=motion.rotation_rad,
            scale=motion.scale,
            confidence=confidence,
        )


def _measure_intensity(displacement_mm: NDArray[np.float64]) -> float:
    """Returns the mean displacement of the markers around the contacts, mm.

    [NT, "Gesture Classification and Intensity Prediction"], in millimetres of the gel.

    Args:
        displacement_mm: (n, 2) float64 mm, the markers of A(t_k). Without markers the result is 0.
    """
    if not len(displacement_mm):
        return 0.0
    return float(np.linalg.norm(displacement_mm, axis=1).mean())


def _at_rest(
    rest_px: NDArray[np.float64], position_px: NDArray[np.float64], config: GestureConfig
) -> bool:
    """Returns True while no region of a fingertip's size has moved as a whole.

    Differs: the paper has no such gate, but at rest its outliers are only noise. The gel moves
    neighbours together, and tracking errors are independent. So the mean over the markers within r
    shows a motion far below the error of a single marker.
    """
    moved_px = smooth_displacement(rest_px, position_px - rest_px, config.radius_px)
    return bool((np.linalg.norm(moved_px, axis=1) < config.rest_gate_px).all())

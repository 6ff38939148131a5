"""The tap: reads Steps beside the labels of their recording."""

import numpy as np

from neurotouch_hid.evaluation.labels import LabelTrack
from neurotouch_hid.evaluation.tally import Tally
from neurotouch_hid.geometry import Rig, fit_rig
from neurotouch_hid.messages import GestureKind, MarkerField, Step


class Comparison:
    """Counts every Step of one recording against its labels.

    Open in the paper: the moments that are compared. The labels are brought to the predictions'
    moments, so every slice between the first and the last label is an observation.

    Args:
        labels: of the same recording.
    """

    def __init__(self, labels: LabelTrack) -> None:
        self.tally = Tally()
        self._labels = labels
        self._fitted: MarkerField | None = None
        self._rig: Rig | None = None

    def __call__(self, step: Step) -> None:
        """Counts one Step."""
        packet = step.packet
        self.tally.events += len(packet.events)
        self.tally.frames += len(packet.frames)
        self.tally.sensor_s += (packet.t_end_us - packet.t_begin_us) / 1e6
        truth = self._labels.at(step.gesture.t_us)
        if truth is not None:
            self.tally.add_gesture(step.gesture, truth, self._find_rig(step.markers))
        for frame in packet.frames:
            label = self._labels.nearest(frame.t_us)
            if label is not None:
                detected = step.rest is not None and step.rest.t_us == frame.t_us
                self.tally.add_rest(labelled=label.kind is GestureKind.NONE, detected=detected)

    def _find_rig(self, markers: MarkerField) -> Rig | None:
        if self._fitted is None or markers.rest_px is not self._fitted.rest_px:
            self._fitted = markers
            known = np.isfinite(markers.rest_px).all(axis=1).sum() >= 2
            self._rig = fit_rig(markers.rest_px) if known else None
        return self._rig

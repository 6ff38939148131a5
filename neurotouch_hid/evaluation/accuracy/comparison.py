"""A tap that compares steps with the labels of their recording."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.evaluation.accuracy.label_track import LabelTrack
from neurotouch_hid.evaluation.accuracy.moments import WorstMoments
from neurotouch_hid.evaluation.accuracy.tally import Tally
from neurotouch_hid.evaluation.accuracy.type_timing import Stopwatch
from neurotouch_hid.geometry import Rig, fit_rig
from neurotouch_hid.messages import GestureKind, MarkerField, Step, Truth
from neurotouch_hid.source.view import View


class Comparison:
    """Compares every step of one recording with its labels, and counts.

    Open in the paper: the moments that are compared. Here the labels are interpolated to the
    predictions' times, so every slice between the first and the last label is an observation.

    Args:
        labels: of the same recording.

    Attributes:
        tally: the counts so far.
        worst: the worst moments so far.
        rig: the present view of the sensor, None before the gel is found.
    """

    def __init__(self, labels: LabelTrack) -> None:
        self.worst = WorstMoments()
        self.rig: Rig | None = None
        self._stopwatch = Stopwatch(labels)
        self.tally = Tally(timing=self._stopwatch.timing)
        self._labels = labels
        self._rest_px: NDArray[np.float32] | None = None

    def __call__(self, step: Step, view: View | None = None) -> None:
        """Counts one step.

        Args:
            step: the step.
            view: that of a video in this step; the labels are pixels of its own pictures.
        """
        packet = step.packet
        self.tally.events += len(packet.events)
        self.tally.frames += len(packet.frames)
        self.tally.sensor_s += (packet.t_end_us - packet.t_begin_us) / 1e6
        self._find_rig(step.markers)
        truth = self._labels.at(step.gesture.t_us)
        if truth is not None:
            self._add_gesture(step, map_truth(truth, view))
        for frame in packet.frames[-1:]:  # a step says nothing of the others of a fast camera
            label = self._labels.nearest(frame.t_us)
            if label is not None:
                detected = step.rest is not None and step.rest.t_us == frame.t_us
                self.tally.add_rest(labelled=label.kind is GestureKind.NONE, detected=detected)

    def _add_gesture(self, step: Step, truth: Truth) -> None:
        packet, gesture = step.packet, step.gesture
        slice_us = packet.t_end_us - packet.t_begin_us
        self.tally.add_gesture(gesture, truth, self.rig)
        self._stopwatch.add(gesture.t_us, slice_us, truth, gesture.kind)
        if self.rig is not None:
            since_s = self.tally.sensor_s  # slices leave nothing out
            self.worst.add(since_s, step.markers, gesture, truth, self.rig)

    def _find_rig(self, markers: MarkerField) -> None:
        if markers.rest_px is not self._rest_px:
            self._rest_px = markers.rest_px
            known = np.isfinite(markers.rest_px).all(axis=1).sum() >= 2
            self.rig = fit_rig(markers.rest_px, markers.gel) if known else None


def map_truth(truth: Truth, view: View | None) -> Truth:
    """Returns a label with its contacts in the canonical picture.

    Args:
        truth: the label; its contacts are pixels of the sensor's own picture.
        view: of that sensor; None if its picture is the canonical one.
    """
    if view is None or not len(truth.contacts_px):
        return truth
    return replace(truth, contacts_px=view.to_canonical(truth.contacts_px))

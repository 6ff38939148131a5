"""The file of a person's labels: it is read once, and written after every change."""

from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.files.stamps import read_stamps
from neurotouch_hid.labelling.look_through import WITHOUT_FRAME_US, Moments
from neurotouch_hid.labelling.track import UNLABELLED, Track
from neurotouch_hid.messages import GestureKind, Truth
from neurotouch_hid.recording import labels_path, read_labels, write_labels

_NEAR_US: Final = WITHOUT_FRAME_US // 3
"""A label this near belongs to a moment: it may be stamped with the start of the exposure."""


def find_label_file(recording: Path, labeller: str | None) -> Path:
    """Returns ``NAME.labels.csv`` beside a recording, or ``NAME.LABELLER.labels.csv``."""
    path = labels_path(recording)
    if labeller is None:
        return path
    return path.with_name(f"{recording.stem}.{labeller}.labels.csv")


class LabelFile:
    """Labels of a recording on disk.

    A label keeps its time stamp. One that belongs to no moment of the recording stays in the file
    as it is.

    Args:
        path: the file; it need not exist.
        moments: the recording.
    """

    def __init__(self, path: Path, moments: Moments) -> None:
        self.path = path
        self._moments = moments
        self._stamp = read_stamps([self.path])
        self._stamps_us = moments.t_us.copy()
        self._others: list[Truth] = []

    def read(self) -> Track:
        """Returns the labels in the file; none if there is no file.

        Raises:
            RecordingError: the file is wrong.
        """
        track = Track.of_size(len(self._moments))
        if not self._stamp:
            return track
        view = self._moments.view
        size_px = None if view is None else (view.width_px, view.height_px)
        times = self._moments.t_us
        for truth in read_labels(self.path, size_px):
            k = int(np.argmin(np.abs(times - truth.t_us)))
            if abs(int(times[k]) - truth.t_us) > _NEAR_US or track.kind[k] != UNLABELLED:
                self._others.append(truth)
                continue
            points = truth.contacts_px
            if view is not None and len(points):
                points = view.to_canonical(points)
            track.set(k, truth.kind, truth.intensity_mm, points)
            self._stamps_us[k] = truth.t_us
        return track

    def write(self, track: Track) -> None:
        """Writes all labels, completely or not at all.

        Raises:
            RecordingError: it cannot be written, or another program has changed it.
        """
        if read_stamps([self.path]) != self._stamp:
            raise RecordingError(
                f"Another program has changed '{self.path}', so it was not written.",
                hint="End this one, and label again: both sets of labels stay as they are.",
            )
        truths = [self._make_truth(track, int(k)) for k in np.flatnonzero(track.kind != UNLABELLED)]
        write_labels(self.path, sorted([*truths, *self._others], key=lambda each: each.t_us))
        self._stamp = read_stamps([self.path])

    def _make_truth(self, track: Track, k: int) -> Truth:
        points = track.points(k)
        view = self._moments.view
        if view is not None and len(points):
            points = view.to_sensor(points)
        kind = GestureKind(int(track.kind[k]))
        truth = Truth(int(self._stamps_us[k]), kind, points, float(track.intensity_mm[k]))
        return truth if kind is not GestureKind.NONE else replace(truth, contacts_px=points[:0])

"""Reads and writes AEDAT4 recordings, video clips and the labels beside them.

A name loads its module when it is first asked for: most starts need no recording.
"""

from typing import TYPE_CHECKING

from neurotouch_hid.lazy import load_lazily

if TYPE_CHECKING:
    from neurotouch_hid.recording.check import find_simulation
    from neurotouch_hid.recording.clip import Clip, Picture
    from neurotouch_hid.recording.clip_writer import ClipWriter
    from neurotouch_hid.recording.gel_file import gel_path, write_beside, write_gel
    from neurotouch_hid.recording.labels import (
        check_labelled,
        labels_path,
        read_labels,
        write_labels,
    )
    from neurotouch_hid.recording.reader import Batch, Recording
    from neurotouch_hid.recording.recorder import Recorder, RecorderStats
    from neurotouch_hid.recording.sensor import DAVIS346, Sensor
    from neurotouch_hid.recording.simulation import Simulation
    from neurotouch_hid.recording.writer import RecordingWriter
else:
    __getattr__ = load_lazily(
        __name__,
        {
            "check": "find_simulation",
            "clip": "Clip Picture",
            "clip_writer": "ClipWriter",
            "gel_file": "gel_path write_beside write_gel",
            "labels": "check_labelled labels_path read_labels write_labels",
            "reader": "Batch Recording",
            "recorder": "Recorder RecorderStats",
            "sensor": "DAVIS346 Sensor",
            "simulation": "Simulation",
            "writer": "RecordingWriter",
        },
    )

__all__ = [
    "DAVIS346",
    "Batch",
    "Clip",
    "ClipWriter",
    "Picture",
    "Recorder",
    "RecorderStats",
    "Recording",
    "RecordingWriter",
    "Sensor",
    "Simulation",
    "check_labelled",
    "find_simulation",
    "gel_path",
    "labels_path",
    "read_labels",
    "write_beside",
    "write_gel",
    "write_labels",
]

"""Reads and writes AEDAT4 recordings and the labels beside them."""

from neurotouch_hid.recording.gel_file import gel_path, write_gel
from neurotouch_hid.recording.labels import check_labelled, labels_path, read_labels, write_labels
from neurotouch_hid.recording.reader import Batch, Recording
from neurotouch_hid.recording.recorder import Recorder, RecorderStats
from neurotouch_hid.recording.simulation import Simulation
from neurotouch_hid.recording.writer import RecordingWriter

__all__ = [
    "Batch",
    "Recorder",
    "RecorderStats",
    "Recording",
    "RecordingWriter",
    "Simulation",
    "check_labelled",
    "gel_path",
    "labels_path",
    "read_labels",
    "write_gel",
    "write_labels",
]

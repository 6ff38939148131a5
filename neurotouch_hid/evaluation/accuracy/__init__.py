"""Compares Steps with the labels of recordings, by the metrics of the paper."""

from neurotouch_hid.evaluation.accuracy.comparison import Comparison
from neurotouch_hid.evaluation.accuracy.files import Evaluation, combine_reports, evaluate_files
from neurotouch_hid.evaluation.accuracy.label_track import LabelTrack
from neurotouch_hid.evaluation.accuracy.metrics import summarise
from neurotouch_hid.evaluation.accuracy.origin import Origin, trace_origin
from neurotouch_hid.evaluation.accuracy.table import format_table
from neurotouch_hid.evaluation.accuracy.tally import Tally

__all__ = [
    "Comparison",
    "Evaluation",
    "LabelTrack",
    "Origin",
    "Tally",
    "combine_reports",
    "evaluate_files",
    "format_table",
    "summarise",
    "trace_origin",
]

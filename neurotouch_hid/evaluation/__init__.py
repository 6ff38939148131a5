"""A tap: the line's answers against the labels of a recording, by the paper's metrics."""

from neurotouch_hid.evaluation.comparison import Comparison
from neurotouch_hid.evaluation.files import Evaluation, combine_reports, evaluate_files
from neurotouch_hid.evaluation.labels import LabelTrack
from neurotouch_hid.evaluation.metrics import summarise
from neurotouch_hid.evaluation.table import format_table
from neurotouch_hid.evaluation.tally import Tally

__all__ = [
    "Comparison",
    "Evaluation",
    "LabelTrack",
    "Tally",
    "combine_reports",
    "evaluate_files",
    "format_table",
    "summarise",
]

"""A tap: the line's answers against the labels of a recording, by the paper's metrics."""

from neurotouch_hid.evaluation.comparison import Comparison
from neurotouch_hid.evaluation.labels import LabelTrack
from neurotouch_hid.evaluation.metrics import summarise
from neurotouch_hid.evaluation.table import format_table
from neurotouch_hid.evaluation.tally import Tally

__all__ = ["Comparison", "LabelTrack", "Tally", "format_table", "summarise"]

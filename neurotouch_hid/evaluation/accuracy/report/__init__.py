"""A report of one or more methods: an HTML page, every figure as an image, all numbers."""

from neurotouch_hid.evaluation.accuracy.report.folder import check_folder
from neurotouch_hid.evaluation.accuracy.report.write import write_report

__all__ = ["check_folder", "write_report"]

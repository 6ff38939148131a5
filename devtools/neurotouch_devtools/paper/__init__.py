"""Makes tables and figures of the documents again: ``python -m neurotouch_devtools.paper``."""

from neurotouch_devtools.paper.comparison import compare_pictures, compare_results
from neurotouch_devtools.paper.results import Result, format_results, list_results, read_results

__all__ = [
    "Result",
    "compare_pictures",
    "compare_results",
    "format_results",
    "list_results",
    "read_results",
]

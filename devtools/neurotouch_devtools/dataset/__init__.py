"""Makes the public data set: ``python -m neurotouch_devtools.dataset OUT``."""

from neurotouch_devtools.dataset.checksums import (
    compare_checksums,
    list_checksums,
    read_checksums,
)
from neurotouch_devtools.dataset.edition import EDITION, SPLITS, Part, list_parts
from neurotouch_devtools.dataset.writing import make_parts, write_edition

__all__ = [
    "EDITION",
    "SPLITS",
    "Part",
    "compare_checksums",
    "list_checksums",
    "list_parts",
    "make_parts",
    "read_checksums",
    "write_edition",
]

"""Finds what is wrong or risky in a profile, and says it in words.

A name loads its module when it is first asked for: the codes need no model.
"""

from typing import TYPE_CHECKING

from neurotouch_hid.lazy import load_lazily

if TYPE_CHECKING:
    from neurotouch_hid.profile.diagnostics.codes import CODES, explain
    from neurotouch_hid.profile.diagnostics.description import (
        describe_condition,
        describe_target,
        describe_when,
    )
else:
    __getattr__ = load_lazily(
        __name__,
        {
            "codes": "CODES explain",
            "description": "describe_condition describe_target describe_when",
        },
    )

__all__ = [
    "CODES",
    "describe_condition",
    "describe_target",
    "describe_when",
    "explain",
]

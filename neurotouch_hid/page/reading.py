"""Reads the values of a browser's message: each has a type and a bound, or is refused."""

import math
from collections.abc import Mapping
from typing import Any, Final

from neurotouch_hid.errors import PageError

LONGEST: Final = 100
"""Characters of a word: a name, a way to a binding, an answer to a question."""

LARGEST: Final = 1e6
"""Nothing that is measured in mm, px or s on a page is larger."""


def read_word(request: Mapping[str, Any], key: str, default: str | None = None) -> str:
    """Returns a text of a message.

    Args:
        request: the message.
        key: which text.
        default: what counts where it is missing; None: it must be there.

    Raises:
        PageError: it is missing, too long, or not text.
    """
    word = request.get(key)
    if word is None and default is not None:
        return default
    if not isinstance(word, str) or len(word) > LONGEST:
        raise PageError(f"'{key}' must be a text of at most {LONGEST} characters.")
    return word


def read_number(value: object) -> float:
    """Returns a number of a message.

    Raises:
        PageError: it is none, or too large to mean anything.
    """
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise PageError("That needs a number.")
    if not math.isfinite(value) or abs(value) > LARGEST:
        raise PageError(f"That needs a number of at most {LARGEST:,.0f}.")
    return float(value)

"""Plain values written as YAML that stays what it is, for every reader."""

import math
import re
from collections.abc import Mapping, Sequence
from typing import Any, Final

from neurotouch_hid.errors import ProfileError
from neurotouch_hid.files.yaml_document import parse_document
from neurotouch_hid.printable import make_printable

_PLAIN: Final = re.compile(r"[A-Za-z][A-Za-z0-9_+]*( [A-Za-z0-9_+]+)*|[A-Za-z0-9_-]*[A-Za-z]")
_TREACHEROUS: Final = frozenset(
    ("y", "n", "yes", "no", "on", "off", "true", "false", "null", "none", "nan", "inf")
)
"""Words that YAML 1.1, YAML 1.2 or a person takes for something else."""


def format_value(value: Any, quote: str = '"') -> str:
    """Returns the value in one line, lists and mappings in brackets.

    Args:
        value: a word, a number, true or false, a list or a mapping with words as keys.
        quote: the quotes of a word that needs some.
    """
    if isinstance(value, Mapping):
        inner = ", ".join(f"{format_value(k)}: {format_value(v)}" for k, v in value.items())
        return f"{{{inner}}}"
    if isinstance(value, str):
        return _format_word(value, quote)
    if isinstance(value, Sequence):
        return f"[{', '.join(format_value(item) for item in value)}]"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float) and not math.isfinite(value):
        return {math.inf: ".inf", -math.inf: "-.inf"}.get(value, ".nan")
    return str(value)


def _format_word(word: str, quote: str) -> str:
    if _PLAIN.fullmatch(word) and word.lower() not in _TREACHEROUS and "--" not in word:
        return word
    if quote == "'" and word.isprintable():
        return "'" + word.replace("'", "''") + "'"
    escaped = "".join(
        char if char.isprintable() and char not in '"\\' else _escape(char) for char in word
    )
    return f'"{escaped}"'


def _escape(char: str) -> str:
    return f"\\{char}" if char in '"\\' else f"\\U{ord(char):08x}"


def parse_value(text: str) -> Any:
    """Returns the value of a word on the command line: ``0.4``, ``[1, 6]``, ``-``, ``a``.

    Text that is no YAML, such as ``-`` or ``{``, is taken as the word it is.

    Raises:
        ProfileError: there is nothing, or YAML that profiles do not use.
    """
    if not text.strip():
        raise ProfileError("The value is empty.", hint="To go back to a default, use --default.")
    if len(text.strip()) == 1 and not text.strip().isalnum():
        return text.strip()  # a sign, which in YAML would begin something
    root, faults = parse_document(text)
    if root is not None and not faults:
        return root.value
    refused = next((fault for fault in faults if fault.code in ("NT103", "NT105")), None)
    if refused is not None or any(char in text for char in "{[\n"):
        raise ProfileError(f"'{make_printable(text[:80])}' is no value: {faults[0].sentence}.")
    return text.strip()
